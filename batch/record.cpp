#include "batch/record.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "formats/files.h"
#include "geometry/error.h"

namespace fascia::batch {

namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

Record record_of(const OrderedJson& json) {
  Record record;
  json.at("id").get_to(record.id);
  json.at("head").get_to(record.head);
  json.at("key").get_to(record.key);
  json.at("done").get_to(record.is_done);
  json.at("cause").get_to(record.cause);
  json.at("message").get_to(record.message);
  record.is_lasting = json.value("lasting", true);
  json.at("attempts").get_to(record.attempts);
  json.at("seconds").get_to(record.seconds);
  json.at("cpu_seconds").get_to(record.cpu_seconds);
  json.at("megabytes").get_to(record.megabytes);
  json.at("rig_bytes").get_to(record.rig_bytes);
  json.at("failed_checks").get_to(record.failed_checks);
  json.at("checks").get_to(record.checks);
  json.at("warnings").get_to(record.warnings);
  return record;
}

}  // namespace

bool read_record(const fs::path& folder, Record& record) {
  std::error_code status;
  if (!fs::exists(folder / record_name, status)) return false;
  try {
    const std::vector<uint8_t> bytes = formats::read_bytes(folder / record_name);
    record = record_of(OrderedJson::parse(bytes));
    return true;
  } catch (const std::exception&) {  // whatever is wrong with it, the head is built again
    return false;
  }
}

void write_record(const fs::path& folder, const Record& record) {
  const OrderedJson json = {{"id", record.id},
                            {"head", record.head},
                            {"key", record.key},
                            {"done", record.is_done},
                            {"cause", record.cause},
                            {"message", record.message},
                            {"lasting", record.is_lasting},
                            {"attempts", record.attempts},
                            {"seconds", record.seconds},
                            {"cpu_seconds", record.cpu_seconds},
                            {"megabytes", record.megabytes},
                            {"rig_bytes", record.rig_bytes},
                            {"failed_checks", record.failed_checks},
                            {"checks", record.checks},
                            {"warnings", record.warnings}};
  formats::write_text(folder / record_name,
                      json.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
}

std::vector<Record> all_records(const fs::path& output) {
  std::vector<Record> records;
  std::error_code status;
  for (const auto& entry : fs::directory_iterator(output, status)) {
    Record record;
    if (entry.is_directory(status) && entry.path().filename().string()[0] != '.' &&
        read_record(entry.path(), record))
      records.push_back(record);
  }
  if (status) throw Error("'" + output.string() + "' cannot be read: " + status.message());
  std::sort(records.begin(), records.end(), [](const Record& a, const Record& b) { return a.id < b.id; });
  return records;
}

}  // namespace fascia::batch

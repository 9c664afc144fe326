#include "batch/places.h"

#include <chrono>
#include <set>
#include <thread>

#include "batch/process.h"
#include "batch/record.h"
#include "geometry/error.h"

namespace fascia::batch {

namespace {

/// A path without links, and without those of its last part: a link and what it leads to are both lost when
/// their folders are.
std::vector<std::filesystem::path> places_of(const std::filesystem::path& file) {
  std::error_code status;
  const std::filesystem::path whole = std::filesystem::absolute(file, status).lexically_normal();
  return {std::filesystem::weakly_canonical(whole, status),
          std::filesystem::weakly_canonical(whole.parent_path(), status) / whole.filename()};
}

void check_input(const Head& head, const std::filesystem::path& file,
                 const std::set<std::filesystem::path>& results) {
  if (file.empty()) return;
  for (std::filesystem::path place : places_of(file))
    for (; place != place.parent_path(); place = place.parent_path())
      if (results.count(place))
        throw Error("'" + file.string() + "', which head '" + head.id + "' is built from, lies in '" +
                    place.string() +
                    "', which the batch replaces: name another folder with -o, or another id");
}

/// True for the name of a head's result, and of what a step that was killed may leave of it.
bool is_own_name(const std::string& name) {
  if (name == output_name || name == errors_name) return true;
  for (const char* result : {record_name, rig_name, build_name, check_name, thumbnail_name})
    if (name == result || (name.starts_with(std::string(result) + ".") && name.ends_with(".part")))
      return true;
  return false;
}

}  // namespace

bool is_result(const std::filesystem::path& folder) {
  Record record;
  return read_record(folder, record);
}

std::string why_not_replaced(const std::filesystem::path& result) {
  std::error_code status;
  const std::filesystem::file_status there = std::filesystem::symlink_status(result, status);
  if (there.type() == std::filesystem::file_type::not_found) return "";
  const std::string name = "'" + result.string() + "' ",
                    remedy = ": move it elsewhere, or name another folder with -o";
  if (!std::filesystem::is_directory(there) || !is_result(result))
    return name + "is there and is no result of a batch" + remedy;
  for (const auto& entry : std::filesystem::directory_iterator(result, status))
    if (!is_own_name(entry.path().filename().string()))
      return "'" + entry.path().string() + "' is no result of a batch and would be lost" + remedy;
  return status ? name + "cannot be read: " + status.message() : "";
}

void check_results(const std::vector<Head>& heads, const std::filesystem::path& output) {
  for (const Head& head : heads) {
    std::string why = why_not_replaced(output / head.id);
    if (why.empty()) continue;
    // Another process may be replacing the results just now.
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    why = why_not_replaced(output / head.id);
    if (!why.empty()) throw Error(why);
  }
}

void check_inputs(const std::vector<Head>& heads, const std::filesystem::path& output) {
  std::error_code status;
  const std::filesystem::path folder =
      std::filesystem::weakly_canonical(std::filesystem::absolute(output, status), status);
  std::set<std::filesystem::path> results = {folder / work_folder, folder / lock_folder};
  for (const Head& head : heads)
    results.insert(folder / head.id);
  for (const Head& head : heads)
    for (const std::filesystem::path& file : {head.file, head.landmarks, head.edits})
      check_input(head, file, results);
}

}  // namespace fascia::batch

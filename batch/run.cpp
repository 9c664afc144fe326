#include "batch/run.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <new>
#include <nlohmann/json.hpp>
#include <thread>

#include "batch/cause.h"
#include "batch/places.h"
#include "formats/file_lock.h"
#include "formats/files.h"
#include "geometry/error.h"

namespace fascia::batch {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int exit_check = 4;

/// The lock of a head, which one process at a time may work at.
formats::FileLock lock_of(const fs::path& folder, const std::string& id) {
  const fs::path path = folder / (id + ".lock");
  formats::FileLock lock(path, formats::FileLock::Wait::no, formats::FileLock::everyone);
  if (!lock.is_open()) throw Error("'" + path.string() + "' cannot be written: " + std::strerror(errno));
  return lock;
}

/// Lets two folders that are there change places. False, and nothing done, where that cannot be.
bool exchange(const fs::path& a, const fs::path& b) {
#ifdef RENAME_EXCHANGE
  return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
#else
  (void)a, (void)b;
  return false;
#endif
}

/// One head's way from mesh to results.
class Worker {
 public:
  Worker(const Head& head, const Options& options, const std::atomic<bool>& stop)
      : head_(head),
        options_(options),
        stop_(stop),
        work_(options.output / work_folder / head.id),
        result_(options.output / head.id) {}

  /// True when what is there will do.
  bool is_settled(const std::string& key, Record& record) const {
    if (!read_record(result_, record) || record.key != key || !record.is_lasting) return false;
    if (!record.is_done) return !options_.retries_failed;
    std::error_code status;
    return fs::file_size(result_ / rig_name, status) == record.rig_bytes && !status;
  }

  Record build(const std::string& key) {
    Record record;
    record.id = head_.id;
    record.head = head_.file.string();
    record.key = key;
    for (bool again = true; again && !stop_;) {
      make_work_folder();
      ++record.attempts;
      again = attempt(record) && record.attempts < options_.attempts;
    }
    return record;
  }

  /// Throws when what is in the results' place may not be lost.
  void check_replaceable() const {
    if (const std::string why = why_not_replaced(result_); !why.empty()) throw Error(why);
  }

  /// An empty one.
  void make_work_folder() const {
    clear(work_);
    std::error_code status;
    fs::create_directories(work_, status);
    if (status) throw Error("'" + work_.string() + "' cannot be made: " + status.message());
  }

  /// Puts the results in place of those that were there, in one step where the system can do that.
  void publish(const Record& record) {
    write_record(work_, record);
    check_replaceable();
    if (exchange(work_, result_)) return clear(work_);
    const fs::path old = work_.string() + ".old";
    clear(old);
    std::error_code status;
    fs::rename(result_, old, status);  // there may be none
    fs::rename(work_, result_, status);
    if (status) {
      std::error_code ignored;
      fs::rename(old, result_, ignored);
      throw Error("'" + result_.string() + "' cannot be made: " + status.message());
    }
    clear(old);
  }

  void abandon() { clear(work_); }

 private:
  static void clear(const fs::path& folder) {
    std::error_code status;
    fs::remove_all(folder, status);
  }

  Outcome step(const std::vector<std::string>& words, Record& record) {
    std::vector<std::string> command = {options_.tool.string()};
    command.insert(command.end(), words.begin(), words.end());
    command.insert(command.end(), {"--threads", std::to_string(options_.threads)});
    const Outcome outcome = run(command, options_.limits, work_, stop_);
    record.seconds += outcome.seconds;
    record.cpu_seconds += outcome.cpu_seconds;
    record.megabytes = std::max(record.megabytes, outcome.megabytes);
    return outcome;
  }

  /// Builds, checks and draws once. True when it failed in a way that another attempt may not.
  bool attempt(Record& record) {
    record.seconds = record.cpu_seconds = record.megabytes = 0.0;
    record.is_lasting = true;
    const std::string rig = (work_ / rig_name).string();
    std::vector<std::string> words = {"build", head_.file.string(), "-o", rig, "--json", "--quiet"};
    if (!head_.landmarks.empty()) words.insert(words.end(), {"--landmarks", head_.landmarks.string()});
    if (!head_.edits.empty()) words.insert(words.end(), {"--edits", head_.edits.string()});
    words.insert(words.end(), head_.options.begin(), head_.options.end());
    const Outcome built = step(words, record);
    std::error_code status;
    record.rig_bytes = static_cast<size_t>(fs::file_size(rig, status));
    if (built.exit_code == 0 && (status || record.rig_bytes == 0)) {
      record.cause = "no rig was written";
      record.rig_bytes = 0;
      return true;
    }
    record.cause = cause_of(built);
    record.message = record.cause.empty() ? "" : words_of(built);
    if (!record.cause.empty()) {
      record.is_lasting = !is_of_the_machine(built);
      record.rig_bytes = 0;
      fs::remove(rig, status);
      return built.signal != 0 || built.exit_code == exit_of_a_fault ? !built.is_late : false;
    }
    record.is_done = true;
    formats::write_text(work_ / build_name, built.out);
    if (const Json json = json_of(built.out); json.is_object() && json.contains("warnings"))
      for (const Json& warning : json["warnings"])
        if (warning.is_string()) record.warnings.push_back(warning);
    if (options_.has_checks) check(rig, record);
    if (options_.has_thumbnails) draw(rig, record);
    return false;
  }

  /// The rig's proof of itself; a rig that cannot be played says so among its checks.
  void check(const std::string& rig, Record& record) {
    const Outcome outcome = step({"check", rig, "--level", "low", "--json", "--quiet"}, record);
    if (outcome.exit_code != 0 && outcome.exit_code != exit_check) {
      record.failed_checks.push_back("not played: " + cause_of(outcome));
      if (is_of_the_machine(outcome)) record.is_lasting = false;
      return;
    }
    formats::write_text(work_ / check_name, outcome.out);
    const Json json = json_of(outcome.out);
    if (!json.is_object() || !json.contains("rows") || !json["rows"].is_array()) return;
    record.checks = static_cast<int>(json["rows"].size());
    for (const Json& row : json["rows"])
      if (row.is_object() && !row.value("ok", true)) record.failed_checks.push_back(row.value("name", "?"));
  }

  void draw(const std::string& rig, Record& record) {
    const Outcome outcome =
        step({"render", rig, "--set", "arkit:mouthSmileLeft=0.8", "--set", "arkit:mouthSmileRight=0.8",
              "--level", "low", "--size", "240", "-o", (work_ / thumbnail_name).string(), "--quiet"},
             record);
    if (outcome.exit_code == 0) return;
    record.warnings.push_back("no thumbnail: " + cause_of(outcome));
    if (is_of_the_machine(outcome)) record.is_lasting = false;
  }

  const Head& head_;
  const Options& options_;
  const std::atomic<bool>& stop_;
  const fs::path work_, result_;
};

/// One head from beginning to end.
Fate settle(const Head& head, const Options& options, const std::atomic<bool>& stop, Record& record) {
  record.id = head.id;
  record.head = head.file.string();
  const formats::FileLock lock = lock_of(options.output / lock_folder, head.id);
  if (!lock.holds()) return Fate::elsewhere;
  Worker worker(head, options, stop);
  worker.check_replaceable();
  const auto fail = [&](const std::string& message) {
    record.attempts = 1;
    record.message = message;
    record.cause = common_part(message);
    worker.make_work_folder();
    worker.publish(record);
    return Fate::failed;
  };
  std::string key;
  try {
    key = key_of(head, options.version);
  } catch (const Error& error) {  // a file that is not there is this head's trouble, not the batch's
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("out of memory: the input is too large for this machine");
  }
  if (worker.is_settled(key, record)) return Fate::kept;
  record = worker.build(key);
  if (stop) {
    worker.abandon();
    return Fate::elsewhere;
  }
  worker.publish(record);
  return record.is_done ? Fate::done : Fate::failed;
}

}  // namespace

Report run_all(const std::vector<Head>& heads, const Options& options, const std::atomic<bool>& stop,
               const std::function<void(size_t, const Record&, Fate)>& told) {
  for (const char* folder : {work_folder, lock_folder}) {
    std::error_code status;
    fs::create_directories(options.output / folder, status);
    if (status)
      throw Error("'" + (options.output / folder).string() + "' cannot be made: " + status.message());
  }
  Report report;
  report.records.resize(heads.size());
  report.fates.resize(heads.size(), Fate::elsewhere);
  std::atomic<size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (size_t h = next++; h < heads.size() && !stop; h = next++) {
        report.fates[h] = settle(heads[h], options, stop, report.records[h]);
        const std::lock_guard lock(mutex);
        if (told && !stop) told(h, report.records[h], report.fates[h]);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      next = heads.size();
    }
  };
  std::vector<std::thread> threads;
  for (size_t t = 0; t < std::min(std::max<size_t>(options.jobs, 1), heads.size()); ++t)
    threads.emplace_back(work);
  for (std::thread& thread : threads)
    thread.join();
  if (failure) std::rethrow_exception(failure);
  return report;
}

}  // namespace fascia::batch

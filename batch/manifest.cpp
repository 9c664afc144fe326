#include "batch/manifest.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "batch/places.h"
#include "formats/content_hash.h"
#include "formats/files.h"
#include "formats/named_files.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::batch {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A name that any file system and any shell takes.
std::string plain(const std::string& name) {
  std::string text;
  for (const char c : name)
    text += std::isalnum(static_cast<unsigned char>(c)) || std::strchr("._-", c) ? c : '_';
  // Names that begin with a dot are the batch's own.
  if (text.empty() || text[0] == '.') text.insert(0, "_");
  constexpr size_t longest = 120;
  return text.size() <= longest ? text : text.substr(0, longest);
}

/// Gives every head without an id one of its own, made of its path from `folder`.
void name(std::vector<Head>& heads, const fs::path& folder) {
  std::set<std::string> used;
  for (const Head& head : heads)
    if (!head.id.empty()) used.insert(head.id);
  for (Head& head : heads) {
    if (!head.id.empty()) continue;
    fs::path path = head.file.lexically_relative(folder);
    if (path.empty()) path = head.file.filename();
    const std::string whole = path.generic_string();
    std::string id = plain(path.replace_extension().generic_string());
    if (!used.insert(id).second) {
      id = plain(whole);
      for (int k = 2; !used.insert(id).second; ++k)
        id = plain(whole) + "-" + std::to_string(k);
    }
    head.id = id;
  }
}

/// True for folders of results, finished or not.
bool is_of_a_batch(const fs::path& folder) {
  std::error_code status;
  return is_result(folder) ||
         (folder.filename() == work_folder && fs::is_directory(folder.parent_path() / lock_folder, status));
}

std::vector<Head> heads_in(const fs::path& folder) {
  static const std::set<std::string> kinds = {".glb", ".gltf", ".obj", ".ply", ".stl"};
  std::vector<Head> heads;
  const auto skip_denied = fs::directory_options::skip_permission_denied;
  for (auto entry = fs::recursive_directory_iterator(folder, skip_denied); entry != end(entry); ++entry) {
    std::error_code status;
    if (entry->is_directory(status)) {
      if (is_of_a_batch(entry->path())) entry.disable_recursion_pending();
    } else if (entry->is_regular_file(status) && kinds.count(extension_of(entry->path()))) {
      heads.push_back({"", entry->path(), "", "", {}});
    }
  }
  std::sort(heads.begin(), heads.end(), [](const Head& a, const Head& b) { return a.file < b.file; });
  if (heads.empty())
    throw Error("'" + folder.string() +
                "' holds no head: a folder of .glb, .gltf, .obj, .ply or .stl files is wanted");
  return heads;
}

std::string word_of(const Json& value, const std::string& key) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number()) return value.dump();
  throw Error("\"" + key + "\" is neither text nor a number");
}

Head head_of(const std::string& line, const fs::path& folder) {
  static const std::map<std::string, std::string> options = {
      {"units", "--units"},   {"up", "--up"},     {"skin", "--skin"}, {"tissue_scale", "--tissue-scale"},
      {"detail", "--detail"}, {"open", "--open"}, {"add", "--add"}};
  constexpr int deepest = 4;
  const auto shallow = [](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest) throw Error("it is nested more than " + std::to_string(deepest) + " deep");
    return true;
  };
  const Json json = Json::parse(line, shallow, false);
  if (!json.is_object()) throw Error("it is not a JSON object such as {\"head\": \"heads/anna.obj\"}");
  Head head;
  for (const auto& [key, value] : json.items()) {
    const std::string word = word_of(value, key);
    if (key == "head")
      head.file = folder / word;
    else if (key == "landmarks")
      head.landmarks = folder / word;
    else if (key == "edits")
      head.edits = folder / word;
    else if (key == "id")
      head.id = word;
    else if (const auto found = options.find(key); found != options.end())
      head.options.insert(head.options.end(), {found->second, word});
    else
      throw Error("\"" + key +
                  "\" is no key of a manifest; there are head, id, landmarks, edits, units, up, skin, "
                  "tissue_scale, detail, open and add");
  }
  if (head.file.empty()) throw Error("it names no \"head\"");
  if (!head.id.empty() && plain(head.id) != head.id)
    throw Error("the id '" + head.id +
                "' becomes a folder: use letters, digits, '.', '_' and '-', not '.' first");
  return head;
}

std::vector<Head> heads_of(const fs::path& manifest) {
  const std::vector<uint8_t> bytes = formats::read_bytes(manifest);
  const fs::path folder = manifest.parent_path();
  std::vector<Head> heads;
  std::map<std::string, size_t> lines;
  size_t number = 0;
  for (auto at = bytes.begin(); at != bytes.end();) {
    const auto end = std::find(at, bytes.end(), '\n');
    std::string line(at, end);
    at = end == bytes.end() ? end : end + 1;
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    try {
      heads.push_back(head_of(line, folder));
      const std::string& id = heads.back().id;
      if (!id.empty() && !lines.emplace(id, number).second)
        throw Error("the id '" + id + "' is that of line " + std::to_string(lines[id]) + " too");
    } catch (const Error& error) {
      throw Error("'" + manifest.string() + "', line " + std::to_string(number) + ": " + error.what());
    }
  }
  if (heads.empty()) throw Error("'" + manifest.string() + "' names no head");
  return heads;
}

/// A whole number of the environment, or nothing when the variable is not set.
std::optional<size_t> variable(const char* name) {
  const char* text = std::getenv(name);
  if (!text || !*text) return {};
  size_t value = 0;
  const auto [end, error] = std::from_chars(text, text + std::strlen(text), value);
  if (error != std::errc() || *end != 0)
    throw Error("the variable " + std::string(name) + " is '" + text +
                "', which is no number; give --task-index and --task-count");
  return value;
}

Task checked(const Task& task, const std::string& where) {
  if (task.count == 0 || task.index >= task.count)
    throw Error(where + ": task " + std::to_string(task.index) + " of " + std::to_string(task.count) +
                " does not exist; tasks count from 0");
  return task;
}

}  // namespace

std::vector<Head> read_heads(const fs::path& source) {
  std::error_code status;
  const bool is_folder = fs::is_directory(source, status);
  std::vector<Head> heads = is_folder ? heads_in(source) : heads_of(source);
  name(heads, is_folder ? source : source.parent_path());
  return heads;
}

std::vector<Head> share(const std::vector<Head>& heads, size_t index, size_t count) {
  std::vector<Head> mine;
  for (size_t i = index; i < heads.size(); i += count)
    mine.push_back(heads[i]);
  return mine;
}

Task task_of_environment(size_t count) {
  if (const auto id = variable("SLURM_ARRAY_TASK_ID")) {
    const size_t first = variable("SLURM_ARRAY_TASK_MIN").value_or(0);
    const size_t step = std::max<size_t>(variable("SLURM_ARRAY_TASK_STEP").value_or(1), 1);
    const size_t all = count > 0 ? count : variable("SLURM_ARRAY_TASK_COUNT").value_or(0);
    if (*id < first)
      throw Error("SLURM_ARRAY_TASK_ID is below SLURM_ARRAY_TASK_MIN; give --task-index and --task-count");
    // With a given count the ids are the indices themselves: a part of an array may be run again.
    return checked({count > 0 ? *id : (*id - first) / step, all}, "Slurm's array");
  }
  if (const auto index = variable("AWS_BATCH_JOB_ARRAY_INDEX"))
    return checked({*index, count > 0 ? count : variable("AWS_BATCH_JOB_ARRAY_SIZE").value_or(0)},
                   "AWS Batch's array (give --task-count)");
  if (const auto index = variable("SLURM_PROCID"))
    return checked({*index, count > 0 ? count : variable("SLURM_NTASKS").value_or(0)}, "Slurm's tasks");
  if (const auto number = variable("PARALLEL_SEQ"); number && count > 0)
    return checked({*number - 1, count}, "GNU parallel's sequence");
  if (count > 1)
    throw Error("--task-count says " + std::to_string(count) +
                " tasks, but no --task-index says which this is");
  return {};
}

std::string key_of(const Head& head, const std::string& version) {
  std::string text = version + "\n" + formats::content_hash(head.file);
  // One that is missing is for the builder to complain of.
  const bool is_allowed =
      std::find(head.options.begin(), head.options.end(), "--allow-outside") != head.options.end();
  const auto outside = is_allowed ? formats::Outside::allowed : formats::Outside::refused;
  for (const formats::NamedFile& file : formats::named_files(head.file, outside))
    text += "\n" + file.name + ": " + (file.path ? formats::content_hash(*file.path) : "missing");
  std::error_code status;
  for (const fs::path& file : {head.landmarks, head.edits})
    if (!file.empty()) text += "\n" + (fs::exists(file, status) ? formats::content_hash(file) : "missing");
  for (const std::string& option : head.options)
    text += "\n" + option;
  return formats::content_hash(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

}  // namespace fascia::batch

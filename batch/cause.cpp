#include "batch/cause.h"

#include <signal.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

namespace fascia::batch {

using Json = nlohmann::json;

Json json_of(const std::string& text) {
  return Json::parse(
      text, [](int depth, Json::parse_event_t, Json&) { return depth < 64; }, false);
}

std::string words_of(const Outcome& outcome) {
  const Json json = json_of(outcome.out);
  if (json.is_object() && json.contains("error") && json["error"].is_string()) return json["error"];
  std::string text = outcome.err;
  while (!text.empty() && std::strchr(" \n", text.back()))
    text.pop_back();
  return text.substr(text.find_last_of('\n') + 1);
}

std::string common_part(const std::string& message) {
  std::string text;
  bool is_quoted = false;
  for (const char c : message) {
    if (c == ';') break;
    if (c == '\'') is_quoted = !is_quoted;
    if (is_quoted || c == '\'') continue;
    if (std::isdigit(static_cast<unsigned char>(c))) {
      if (text.empty() || text.back() != '#') text += '#';
      continue;
    }
    if (c == ' ' && (text.empty() || text.back() == ' ')) continue;
    text += c;
  }
  while (!text.empty() && std::strchr(" :,.", text.front()))
    text.erase(0, 1);
  while (!text.empty() && std::strchr(" :,.", text.back()))
    text.pop_back();
  return text.empty() ? "no message" : text;
}

std::string cause_of(const Outcome& outcome) {
  if (outcome.exit_code == 0) return "";
  if (outcome.is_late) return "limit of time";
  if (outcome.signal != 0)
    return "ended by signal " + std::to_string(outcome.signal) + " (" + strsignal(outcome.signal) + ")";
  if (outcome.exit_code == exit_not_started) return "the tool cannot be started";
  const std::string words = words_of(outcome);
  if (words.find("out of memory") != std::string::npos) return "limit of memory";
  if (outcome.exit_code == exit_of_a_fault) return "internal error: " + common_part(words);
  return common_part(words);
}

bool is_of_the_machine(const Outcome& outcome) {
  if (outcome.exit_code == exit_not_started || outcome.signal == SIGXFSZ) return true;
  if (outcome.exit_code == 0 || outcome.signal != 0 || outcome.is_late) return false;
  const std::string words = words_of(outcome);
  if (words.empty()) return true;  // not even an error could be written
  for (const int error : {ENOSPC, EFBIG, EDQUOT, EIO, EROFS, ESTALE, EMFILE, ENFILE})
    if (words.find(std::strerror(error)) != std::string::npos) return true;
  return false;
}

}  // namespace fascia::batch

#include "bench/people/arguments.h"

#include <cstdio>
#include <sstream>
#include <stdexcept>

namespace fascia::bench {

Arguments::Arguments(std::string program, std::string names)
    : program_(std::move(program)), usage_(std::move(names)) {}

void Arguments::add(const std::string& name, const std::string& what, Read read) {
  usage_ += " [" + name + " " + what + "]";
  options_[name] = std::move(read);
}

void Arguments::option(const std::string& name, const std::string& what, std::string& to) {
  add(name, what, [&to](const std::string& value) { to = value; });
}

void Arguments::option(const std::string& name, const std::string& what, std::filesystem::path& to) {
  add(name, what, [&to](const std::string& value) { to = value; });
}

void Arguments::option(const std::string& name, const std::string& what, double& to) {
  add(name, what, [&to](const std::string& value) { to = std::stod(value); });
}

void Arguments::option(const std::string& name, const std::string& what, int& to) {
  add(name, what, [&to](const std::string& value) { to = std::stoi(value); });
}

void Arguments::option(const std::string& name, const std::string& what, std::set<std::string>& to) {
  add(name, what, [&to](const std::string& value) {
    std::istringstream list(value);
    for (std::string entry; std::getline(list, entry, ',');)
      if (!entry.empty()) to.insert(entry);
  });
}

void Arguments::option(const std::string& name, const std::string& what, std::vector<std::string>& to) {
  add(name, what, [&to](const std::string& value) { to.push_back(value); });
}

void Arguments::flag(const std::string& name, bool& to) {
  usage_ += " [" + name + "]";
  flags_[name] = &to;
}

bool Arguments::read_option(const std::string& name, const char* value) const {
  const auto found = options_.find(name);
  if (found == options_.end() || value == nullptr) return false;
  try {
    found->second(value);
  } catch (const std::logic_error&) {  // of std::stod and std::stoi
    return false;
  }
  return true;
}

bool Arguments::parse(int argc, char** argv, std::vector<std::string>& names) const {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.rfind("--", 0) != 0) {
      names.push_back(word);
    } else if (const auto flag = flags_.find(word); flag != flags_.end()) {
      *flag->second = true;
    } else {
      if (!read_option(word, i + 1 < argc ? argv[i + 1] : nullptr)) {
        std::fprintf(stderr, "usage: %s %s\n", program_.c_str(), usage_.c_str());
        return false;
      }
      ++i;
    }
  }
  return true;
}

}  // namespace fascia::bench

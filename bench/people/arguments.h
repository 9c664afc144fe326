#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace fascia::bench {

/// The command line of a benchmark: options with a value, flags, and names.
class Arguments {
 public:
  /// `names`: what the words without an option are called in the usage, such as "[HEAD]...".
  Arguments(std::string program, std::string names);

  /// `--NAME VALUE`, written to `to`: text, a path, a number, a list with commas, or one entry of a list for
  /// each time it is given. `what` stands for the value in the usage.
  void option(const std::string& name, const std::string& what, std::string& to);
  void option(const std::string& name, const std::string& what, std::filesystem::path& to);
  void option(const std::string& name, const std::string& what, double& to);
  void option(const std::string& name, const std::string& what, int& to);
  void option(const std::string& name, const std::string& what, std::set<std::string>& to);
  void option(const std::string& name, const std::string& what, std::vector<std::string>& to);
  void flag(const std::string& name, bool& to);

  /// Reads the command line; words without an option go to `names`. Prints the usage and returns false for an
  /// unknown option, a missing value or one that is not a number.
  bool parse(int argc, char** argv, std::vector<std::string>& names) const;

 private:
  using Read = std::function<void(const std::string&)>;
  void add(const std::string& name, const std::string& what, Read read);
  bool read_option(const std::string& name, const char* value) const;

  std::string program_, usage_;
  std::map<std::string, Read> options_;
  std::map<std::string, bool*> flags_;
};

}  // namespace fascia::bench

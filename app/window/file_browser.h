#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace fascia::app {

/// A dialog that asks for a file: one to open, or the name of one to write.
class FileBrowser {
 public:
  using Chosen = std::function<void(const std::filesystem::path&)>;

  /// Asks for a file that ends in one of `endings` (lower case, with dot; none: any).
  void ask_to_open(const std::string& title, std::vector<std::string> endings, Chosen chosen);
  /// Asks where to write; `name` is proposed.
  void ask_to_save(const std::string& title, const std::string& name, std::vector<std::string> endings,
                   Chosen chosen);

  /// Draws the dialog while it is open.
  void show();
  bool is_open() const { return is_open_; }

  std::filesystem::path confined_to;  ///< nothing is written outside of this folder; empty: anywhere
  std::filesystem::path folder;       ///< where it looks, kept from one time to the next

 private:
  struct Entry {
    std::string name;
    bool is_folder = false;
  };
  void begin(const std::string& title, std::vector<std::string> endings, Chosen chosen);
  void read_folder();
  bool accept(const std::string& name);

  bool is_open_ = false, is_saving_ = false, begins_ = false, asks_to_replace_ = false;
  std::string title_, name_, fault_;
  std::vector<std::string> endings_;
  std::vector<Entry> entries_;
  Chosen chosen_;
};

}  // namespace fascia::app

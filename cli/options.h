#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace fascia::cli {

/// Thrown to end the tool with this exit code when all there was to say has been said.
struct Exit {
  int code = 0;
};

/// Thrown for wrong usage: the tool says why and ends with 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The variable an option writes; a list takes the option several times, one value each. What it holds when
/// the option is declared is the option's default.
using Variable =
    std::variant<bool*, int*, size_t*, double*, std::optional<double>*, std::string*, std::filesystem::path*,
                 std::vector<std::string>*, std::vector<std::filesystem::path>*>;

/// What is said of an option by `--help`, the manual page and the shells' completions.
struct OptionFacts {
  std::vector<std::string> names;    ///< "-o", "--output"; of a positional one "RIG"
  std::string value;                 ///< what it takes: "FILE", "N"; empty for a flag
  std::vector<std::string> choices;  ///< the words it takes; empty: any
  std::string description;
  std::string default_text;  ///< what holds when it is not given; empty only where it is required
  bool is_required = false, is_positional = false;
};

/// One option as it is being declared: each call says one thing more about it. Copies say it of the same
/// option.
class Option {
 public:
  /// It has to be given.
  Option required() const;
  /// What holds when it is not given, where that is not the variable's value: "the rig's finest".
  Option default_text(const std::string& text) const;
  /// What it takes, in capitals, where that is not to be told from the variable: "DIR".
  Option value(const std::string& name) const;
  /// Its values may stand in one word, with commas between.
  Option separated_by_commas() const;
  /// It takes these words only.
  Option one_of(const std::vector<std::string>& words) const;
  /// It takes numbers from `least` to `most` only.
  Option range(double least, double most) const;
  /// It takes a number of the variable's own unit or one of these words, which stand for one: {{"ms", 1e-3}}.
  Option units(const std::map<std::string, double>& words) const;

 private:
  friend class Command;
  struct Parts;
  explicit Option(std::shared_ptr<Parts> parts) : parts_(std::move(parts)) {}
  std::shared_ptr<Parts> parts_;
};

/// A command of the tool, or the tool itself, as it is being declared: what it takes and what it does.
///
///     Command command = tool.command("bake", "Bake simulated shapes into morph targets");
///     command.positional("RIG", request->rig, "Rig (.glb)").required();
///     command.option("--level", request->level, "Level of detail").default_text("the finest");
///     command.flag("--keep-rig", request->keeps_rig, "Keep the FASCIA extensions in the file");
///     command.run([request, &common] { run(common, *request); });
///
/// Variables must outlive the parsing. Every option that is not required has to say its default: by its
/// variable, or in words; parsing throws std::logic_error where one does not. Copies speak of the same
/// command.
class Command {
 public:
  /// The tool: `name` and one sentence of what it is; `version` is what `--version` prints.
  Command(const std::string& name, const std::string& description, const std::string& version);

  /// A command of the tool.
  Command command(const std::string& name, const std::string& description) const;

  /// `name` in capitals: "RIG".
  Option positional(const std::string& name, Variable variable, const std::string& description) const;
  /// `names` with their dashes, and a comma between: "-o,--output".
  Option option(const std::string& names, Variable variable, const std::string& description) const;
  /// Sets `variable` to true, or to false by "--no-NAME" where `has_opposite`.
  Option flag(const std::string& name, bool& variable, const std::string& description,
              bool has_opposite = false) const;
  /// What the command does once its options are read.
  void run(std::function<void()> action) const;

  const std::string& name() const;
  std::string description() const;
  std::vector<OptionFacts> options() const;
  /// The tool's commands, in the order they were declared.
  std::vector<Command> commands() const;

  /// Reads a command line into the variables. The action of the command it names, or nothing where help or
  /// the version was asked for, which is then printed on stdout. Throws UsageError.
  std::function<void()> parse(int argc, const char* const* argv) const;

 private:
  struct Parts;
  explicit Command(std::shared_ptr<Parts> parts) : parts_(std::move(parts)) {}
  std::shared_ptr<Parts> parts_;
};

}  // namespace fascia::cli

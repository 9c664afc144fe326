#include "cli/help.h"

#include <sstream>

namespace fascia::cli {

namespace {

constexpr size_t page_width = 100, second_column = 28;

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string line;
  for (const std::string& word : words)
    line += (line.empty() ? "" : between) + word;
  return line;
}

/// A term and what it means in two columns, lines broken between words.
std::string entry(const std::string& term, const std::string& meaning) {
  const std::string indent(second_column, ' ');
  std::string page = "  " + term;
  page += page.size() + 2 > second_column ? "\n" + indent : std::string(second_column - page.size(), ' ');
  std::istringstream words(meaning);
  size_t used = 0;
  for (std::string word; words >> word;) {
    if (used > 0 && second_column + used + 1 + word.size() > page_width) {
      page += "\n" + indent;
      used = 0;
    }
    page += (used > 0 ? " " : "") + word;
    used += (used > 0 ? 1 : 0) + word.size();
  }
  return page + "\n";
}

std::string entries(const std::vector<OptionFacts>& options, bool positional) {
  std::string page;
  for (const OptionFacts& option : options)
    if (option.is_positional == positional) page += entry(usage_of(option), meaning_of(option));
  return page;
}

/// Whether the words an option takes are short enough to stand where its value does.
bool shows_choices(const OptionFacts& option) {
  return !option.is_positional && !option.choices.empty() && joined(option.choices, "|").size() <= 40;
}

std::string help_entry() {
  return entry("-h, --help", "Print this help and exit");
}

}  // namespace

std::string usage_of(const OptionFacts& option) {
  const std::string names = joined(option.names, ", ");
  if (option.is_positional || option.value.empty()) return names;
  return names + " " + (shows_choices(option) ? joined(option.choices, "|") : option.value);
}

std::string meaning_of(const OptionFacts& option) {
  std::string text = option.description;
  if (!option.choices.empty() && !shows_choices(option)) text += ": " + joined(option.choices, ", ");
  return text + (option.is_required ? " (required)" : " (default: " + option.default_text + ")");
}

std::string tool_help(const Command& tool) {
  std::string page = tool.description() + "\n\nUsage: " + tool.name() + " COMMAND [options]\n\nCommands:\n";
  for (const Command& command : tool.commands())
    page += entry(command.name(), command.description());
  return page + "\nOptions of every command:\n" + entries(tool.options(), false) + help_entry() +
         entry("--version", "Print the version and exit") + "\n'" + tool.name() +
         " COMMAND --help' explains one command.\n";
}

std::string command_help(const Command& tool, const Command& command) {
  std::string usage = tool.name() + " " + command.name();
  for (const OptionFacts& option : command.options())
    if (option.is_positional)
      usage += " " + (option.is_required ? option.names[0] : "[" + option.names[0] + "]");
    else if (option.is_required)
      usage += " " + option.names[0] + " " + option.value;
  std::string page = command.description() + "\n\nUsage: " + usage + " [options]\n";
  const std::string arguments = entries(command.options(), true), options = entries(command.options(), false);
  if (!arguments.empty()) page += "\nArguments:\n" + arguments;
  if (!options.empty()) page += "\nOptions:\n" + options;
  return page + "\nOptions of every command:\n" + entries(tool.options(), false) + help_entry();
}

}  // namespace fascia::cli

#include "cli/options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "cli/help.h"
#include "geometry/nearest_names.h"

namespace fascia::cli {

struct Option::Parts {
  OptionFacts facts;
  CLI::Option* option = nullptr;
};

struct Command::Parts {
  CLI::App* app = nullptr;
  std::unique_ptr<CLI::App> owned;  ///< of the tool itself
  std::vector<std::shared_ptr<Option::Parts>> options;
  std::vector<Command> commands;
  std::function<void()> action;
};

namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

template <class Words>
std::string list_of(const Words& words) {
  std::string text;
  for (const auto& word : words)
    text += (text.empty() ? "" : ",") + std::filesystem::path(word).string();
  return text;
}

/// What a variable holds, for people; empty where it holds nothing.
std::string value_text(const Variable& variable) {
  return std::visit(
      Overloaded{
          [](const bool* value) { return std::string(*value ? "yes" : "no"); },
          [](const int* value) { return std::to_string(*value); },
          [](const size_t* value) { return std::to_string(*value); },
          [](const double* value) { return text_of(*value); },
          [](const std::optional<double>* value) { return *value ? text_of(**value) : std::string(); },
          [](const std::string* value) { return *value; },
          [](const std::filesystem::path* value) { return value->string(); },
          [](const auto* list) { return list_of(*list); },
      },
      variable);
}

std::string value_name(const Variable& variable) {
  return std::visit(Overloaded{
                        [](const bool*) { return ""; },
                        [](const int*) { return "N"; },
                        [](const size_t*) { return "N"; },
                        [](const double*) { return "NUMBER"; },
                        [](const std::optional<double>*) { return "NUMBER"; },
                        [](const std::filesystem::path*) { return "FILE"; },
                        [](const std::vector<std::filesystem::path>*) { return "FILE"; },
                        [](const auto*) { return "NAME"; },
                    },
                    variable);
}

CLI::Option* declare(CLI::App& app, const std::string& names, const Variable& variable) {
  CLI::Option* option = std::visit(
      Overloaded{
          [&](bool* value) { return app.add_flag(names, *value); },
          [&](std::optional<double>* value) {
            return app.add_option_function<double>(names, [value](double given) { *value = given; });
          },
          [&](std::vector<std::string>* list) {
            return app.add_option(names, *list)->take_all()->allow_extra_args(!names.starts_with('-'));
          },
          [&](std::vector<std::filesystem::path>* list) {
            return app.add_option(names, *list)->take_all()->allow_extra_args(!names.starts_with('-'));
          },
          [&](auto* value) { return app.add_option(names, *value); },
      },
      variable);
  if (std::holds_alternative<double*>(variable) || std::holds_alternative<std::optional<double>*>(variable))
    option->check([](const std::string& word) {
      double value = 0.0;
      const bool is_finite = CLI::detail::lexical_cast(word, value) && std::isfinite(value);
      return is_finite ? std::string() : "'" + word + "' is not a number";
    });
  return option;
}

/// The nearest of a command's own options and those of every command; `command` is null where none was named.
std::string unknown_option(const Command& tool, const Command* command, const std::string& word) {
  std::vector<std::string> known = {"--help"};
  for (const Command& source : command ? std::vector{*command, tool} : std::vector{tool})
    for (const OptionFacts& facts : source.options())
      if (!facts.is_positional) known.insert(known.end(), facts.names.begin(), facts.names.end());
  const std::string whole = tool.name() + (command ? " " + command->name() : "");
  return "'" + whole + "' has no option '" + word + "'" +
         did_you_mean(word.substr(0, word.find('=')), known) + "; '" + whole + " --help' lists them";
}

std::string unknown_command(const Command& tool, const std::string& word) {
  std::vector<std::string> known;
  for (const Command& command : tool.commands())
    known.push_back(command.name());
  return "there is no command '" + word + "'" + did_you_mean(word, known) + "; '" + tool.name() +
         " --help' lists them";
}

}  // namespace

Option Option::required() const {
  parts_->option->required();
  parts_->facts.is_required = true;
  return *this;
}

Option Option::default_text(const std::string& text) const {
  parts_->facts.default_text = text;
  return *this;
}

Option Option::value(const std::string& name) const {
  parts_->facts.value = name;
  return *this;
}

Option Option::separated_by_commas() const {
  parts_->option->delimiter(',');
  return *this;
}

Option Option::one_of(const std::vector<std::string>& words) const {
  parts_->facts.choices = words;
  parts_->option->check([words](const std::string& word) {
    if (std::find(words.begin(), words.end(), word) != words.end()) return std::string();
    std::string all;
    for (const std::string& known : words)
      all += (all.empty() ? "" : ", ") + known;
    return "'" + word + "' is none of " + all + did_you_mean(word, words, 1);
  });
  return *this;
}

Option Option::range(double least, double most) const {
  parts_->option->check([least, most](const std::string& word) {
    double value = 0.0;
    const bool is_number = CLI::detail::lexical_cast(word, value);
    return is_number && value >= least && value <= most
               ? std::string()
               : "'" + word + "' is not a number from " + text_of(least) + " to " + text_of(most);
  });
  return *this;
}

Option Option::units(const std::map<std::string, double>& words) const {
  parts_->option->transform([words](std::string word) {
    const auto found = words.find(word);
    if (found == words.end()) return word;
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", found->second);
    return std::string(text);
  });
  return *this;
}

Command::Command(const std::string& name, const std::string& description, const std::string& version)
    : parts_(std::make_shared<Parts>()) {
  parts_->owned = std::make_unique<CLI::App>(description, name);
  parts_->app = parts_->owned.get();
  parts_->app->set_version_flag("--version", version);
  parts_->app->require_subcommand(1);
  parts_->app->fallthrough();
}

Command Command::command(const std::string& name, const std::string& description) const {
  Command command(std::make_shared<Parts>());
  command.parts_->app = parts_->app->add_subcommand(name, description);
  parts_->commands.push_back(command);
  return command;
}

Option Command::positional(const std::string& name, Variable variable, const std::string& description) const {
  const Option declared = option(name, variable, description);
  declared.parts_->facts.is_positional = true;
  return declared;
}

Option Command::option(const std::string& names, Variable variable, const std::string& description) const {
  auto parts = std::make_shared<Option::Parts>();
  parts->option = declare(*parts_->app, names, variable);
  parts->facts.names = CLI::detail::split(names, ',');
  parts->facts.value = value_name(variable);
  parts->facts.description = description;
  parts->facts.default_text = value_text(variable);
  parts_->options.push_back(parts);
  return Option(parts);
}

Option Command::flag(const std::string& name, bool& variable, const std::string& description,
                     bool has_opposite) const {
  const std::string opposite = "--no-" + name.substr(2);
  const Option declared = option(has_opposite ? name + ",!" + opposite : name, &variable, description);
  if (has_opposite) declared.parts_->facts.names[1] = opposite;
  return declared;
}

void Command::run(std::function<void()> action) const {
  parts_->action = std::move(action);
}

const std::string& Command::name() const {
  return parts_->app->get_name();
}

std::string Command::description() const {
  return parts_->app->get_description();
}

std::vector<OptionFacts> Command::options() const {
  std::vector<OptionFacts> facts;
  for (const auto& option : parts_->options)
    facts.push_back(option->facts);
  return facts;
}

std::vector<Command> Command::commands() const {
  return parts_->commands;
}

std::function<void()> Command::parse(int argc, const char* const* argv) const {
  for (const Command& command : parts_->commands)
    for (const OptionFacts& facts : command.options())
      if (!facts.is_required && facts.default_text.empty())
        throw std::logic_error("'" + facts.names[0] + "' of '" + command.name() +
                               "' does not say its default");
  const auto chosen = [&]() -> const Command* {
    for (const Command& command : parts_->commands)
      if (command.parts_->app->parsed()) return &command;
    return nullptr;
  };
  try {
    parts_->app->parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << (chosen() ? command_help(*this, *chosen()) : tool_help(*this));
    return {};
  } catch (const CLI::CallForVersion& version) {
    std::cout << version.what() << "\n";
    return {};
  } catch (const CLI::ParseError& error) {
    const Command* command = chosen();
    const std::string explains =
        "; '" + name() + (command ? " " + command->name() : "") + " --help' explains";
    for (const std::string& word : parts_->app->remaining(true)) {
      if (!command && !word.empty() && word[0] != '-') throw UsageError(unknown_command(*this, word));
      if (word.size() > 1 && word[0] == '-') throw UsageError(unknown_option(*this, command, word));
      if (command)
        throw UsageError("'" + name() + " " + command->name() + "' takes no further argument: '" + word +
                         "'" + explains);
    }
    if (!command) throw UsageError("no command is given" + explains);
    throw UsageError(error.what() + explains);
  }
  return chosen()->parts_->action;
}

}  // namespace fascia::cli

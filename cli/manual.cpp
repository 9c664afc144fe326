#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/common.h"

namespace fascia::cli {

namespace {

using Commands = std::vector<const CLI::App*>;

/// The commands people call, in the order they were added.
Commands commands_of(const CLI::App& app) {
  return app.get_subcommands(
      [](const CLI::App* command) { return !command->get_name().empty() && !command->get_group().empty(); });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

/// "--threads INT" or "HEAD".
std::string usage_of(const CLI::Option& option) {
  const std::string name = option.get_name(false, true);
  if (option.get_positional() || !takes_value(option) || option.get_type_name().empty()) return name;
  return name + " " + option.get_type_name();
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

/// Text for roff: backslashes and minus signs escaped, no line taken for a request.
std::string roff(const std::string& text) {
  std::string escaped = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  escaped = replaced(escaped, "\n", "\n.br\n");
  if (!escaped.empty() && (escaped[0] == '.' || escaped[0] == '\'')) escaped.insert(0, "\\&");
  return escaped;
}

std::string roff_options(const CLI::App& app) {
  std::string page;
  for (const CLI::Option* option : options_of(app)) {
    page += ".TP\n.B " + roff(usage_of(*option)) + "\n" + roff(option->get_description());
    if (!option->get_default_str().empty()) page += " (default: " + roff(option->get_default_str()) + ")";
    page += "\n";
  }
  return page;
}

/// The page for man(1).
std::string man_page(const CLI::App& app) {
  std::string page = ".TH FASCIA 1 \"\" \"fascia\" \"User commands\"\n.SH NAME\nfascia \\- " +
                     roff(app.get_description()) + "\n.SH SYNOPSIS\n.B fascia\n.I COMMAND\n[options]\n";
  page += ".SH OPTIONS\nEvery command takes these.\n" + roff_options(app);
  page += ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(app))
    page += ".SS fascia " + roff(command->get_name()) + "\n" + roff(command->get_description()) + "\n" +
            roff_options(*command);
  page +=
      ".SH EXIT STATUS\n"
      ".TP\n.B 0\ndone\n.TP\n.B 1\nthe input is at fault; the message names it and the remedy\n"
      ".TP\n.B 2\nwrong usage\n.TP\n.B 3\ninternal error\n"
      ".TP\n.B 4\na check failed\n.TP\n.B 130\ninterrupted\n";
  return page;
}

/// All long and short names of an app's options, such as "--json --quiet -o".
std::vector<std::string> flags_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options_of(app)) {
    for (const std::string& name : option->get_lnames())
      names.push_back("--" + name);
    for (const std::string& name : option->get_snames())
      names.push_back("-" + name);
  }
  return names;
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words)
    line += (line.empty() ? "" : " ") + word;
  return line;
}

std::string names_of(const Commands& commands) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands)
    names.push_back(command->get_name());
  return joined(names);
}

std::string bash_completion(const CLI::App& app) {
  const Commands commands = commands_of(app);
  const std::string common = joined(flags_of(app));
  std::string script =
      "_fascia() {\n"
      "  local word=\"${COMP_WORDS[COMP_CWORD]}\" flags='" +
      common +
      "'\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W '" +
      names_of(commands) +
      "' -- \"$word\"))\n    return\n  fi\n"
      "  case \"${COMP_WORDS[1]}\" in\n";
  for (const CLI::App* command : commands)
    script += "    " + command->get_name() + ") flags=\"$flags " + joined(flags_of(*command)) + "\" ;;\n";
  script +=
      "  esac\n"
      "  case \"$word\" in -*) COMPREPLY=($(compgen -W \"$flags\" -- \"$word\")) ;; esac\n"
      "}\n"
      "complete -o default -F _fascia fascia\n";
  return script;
}

/// For a text between single quotes of a shell.
std::string quoted(const std::string& text) {
  const std::string first_line = text.substr(0, text.find('\n'));
  return replaced(first_line, "'", "'\\''");
}

std::string zsh_completion(const CLI::App& app) {
  const auto spec = [](const std::string& flag, const CLI::Option& option) {
    std::string text = replaced(replaced(quoted(option.get_description()), "[", "("), "]", ")");
    return "'" + flag + "[" + replaced(text, ":", "\\:") + "]" +
           (takes_value(option) ? ":value:_files" : "") + "'";
  };
  const auto specs = [&](const CLI::App& of) {
    std::string all;
    for (const CLI::Option* option : options_of(of)) {
      for (const std::string& name : option->get_lnames())
        all += " " + spec("--" + name, *option);
      for (const std::string& name : option->get_snames())
        all += " " + spec("-" + name, *option);
    }
    return all;
  };
  std::string script = "#compdef fascia\nlocal -a commands=(\n";
  for (const CLI::App* command : commands_of(app))
    script +=
        "  '" + command->get_name() + ":" + replaced(quoted(command->get_description()), ":", "\\:") + "'\n";
  script += ")\nif (( CURRENT == 2 )); then _describe command commands; return; fi\ncase $words[2] in\n";
  for (const CLI::App* command : commands_of(app))
    script +=
        "  " + command->get_name() + ") _arguments '*:file:_files'" + specs(app) + specs(*command) + " ;;\n";
  return script + "esac\n";
}

std::string fish_completion(const CLI::App& app) {
  const auto lines = [](const CLI::App& of, const std::string& condition) {
    std::string all;
    for (const CLI::Option* option : options_of(of)) {
      std::string names;
      for (const std::string& name : option->get_lnames())
        names += " -l " + name;
      for (const std::string& name : option->get_snames())
        names += " -s " + name;
      if (!names.empty())
        all += "complete -c fascia" + condition + names + (takes_value(*option) ? " -r" : "") + " -d '" +
               quoted(option->get_description()) + "'\n";
    }
    return all;
  };
  std::string script = lines(app, "");
  for (const CLI::App* command : commands_of(app)) {
    script += "complete -c fascia -n __fish_use_subcommand -a " + command->get_name() + " -d '" +
              quoted(command->get_description()) + "'\n";
    script += lines(*command, " -n '__fish_seen_subcommand_from " + command->get_name() + "'");
  }
  return script;
}

}  // namespace

void add_manual(CLI::App& app) {
  auto* command = app.add_subcommand("manual", "Print the manual page, or the completions of a shell");
  auto kind = std::make_shared<std::string>("man");
  command->add_option("KIND", *kind, "man, bash, zsh or fish")
      ->capture_default_str()
      ->check(CLI::IsMember({"man", "bash", "zsh", "fish"}));
  command->callback([&app, kind] {
    const std::string text = *kind == "man"    ? man_page(app)
                             : *kind == "bash" ? bash_completion(app)
                             : *kind == "zsh"  ? zsh_completion(app)
                                               : fish_completion(app);
    std::fwrite(text.data(), 1, text.size(), stdout);
  });
}

}  // namespace fascia::cli

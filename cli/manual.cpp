#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/common.h"
#include "cli/help.h"

namespace fascia::cli {

namespace {

/// Names with their dashes; none of a positional one.
std::vector<std::string> flags_of(const OptionFacts& option) {
  return option.is_positional ? std::vector<std::string>() : option.names;
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

std::string roff_options(const Command& command) {
  std::string page;
  for (const OptionFacts& option : command.options())
    page += ".TP\n.B " + roff(usage_of(option)) + "\n" + roff(meaning_of(option)) + "\n";
  return page;
}

/// The page for man(1).
std::string man_page(const Command& tool) {
  std::string page = ".TH FASCIA 1 \"\" \"fascia\" \"User commands\"\n.SH NAME\nfascia \\- " +
                     roff(tool.description()) + "\n.SH SYNOPSIS\n.B fascia\n.I COMMAND\n[options]\n";
  page += ".SH OPTIONS\nEvery command takes these.\n" + roff_options(tool);
  page += ".SH COMMANDS\n";
  for (const Command& command : tool.commands())
    page += ".SS fascia " + roff(command.name()) + "\n" + roff(command.description()) + "\n" +
            roff_options(command);
  page +=
      ".SH EXIT STATUS\n"
      ".TP\n.B 0\ndone\n.TP\n.B 1\nthe input is at fault; the message names it and the remedy\n"
      ".TP\n.B 2\nwrong usage\n.TP\n.B 3\ninternal error\n"
      ".TP\n.B 4\na check failed\n.TP\n.B 130\ninterrupted\n";
  return page;
}

/// The flags of all of a command's options, such as "--json --quiet -o".
std::vector<std::string> flags_of(const Command& command) {
  std::vector<std::string> names;
  for (const OptionFacts& option : command.options())
    for (const std::string& name : flags_of(option))
      names.push_back(name);
  return names;
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words)
    line += (line.empty() ? "" : " ") + word;
  return line;
}

std::string names_of(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& command : commands)
    names.push_back(command.name());
  return joined(names);
}

/// After an option with few words to choose from the shell offers those.
std::string bash_choices(const Command& command) {
  std::string cases;
  for (const OptionFacts& option : command.options())
    if (!option.choices.empty() && !option.is_positional) {
      std::string names;
      for (const std::string& name : option.names)
        names += (names.empty() ? "" : "|") + name;
      cases += "      " + command.name() + ":" + names + ") COMPREPLY=($(compgen -W '" +
               joined(option.choices) + "' -- \"$word\")); return ;;\n";
    }
  return cases;
}

std::string bash_completion(const Command& tool) {
  std::string script =
      "_fascia() {\n"
      "  local word=\"${COMP_WORDS[COMP_CWORD]}\" flags='" +
      joined(flags_of(tool)) +
      "'\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W '" +
      names_of(tool.commands()) +
      "' -- \"$word\"))\n    return\n  fi\n"
      "  case \"${COMP_WORDS[1]}:${COMP_WORDS[COMP_CWORD-1]}\" in\n";
  for (const Command& command : tool.commands())
    script += bash_choices(command);
  script += "  esac\n  case \"${COMP_WORDS[1]}\" in\n";
  for (const Command& command : tool.commands())
    script += "    " + command.name() + ") flags=\"$flags " + joined(flags_of(command)) + "\" ;;\n";
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

std::string zsh_specs(const Command& command) {
  std::string all;
  for (const OptionFacts& option : command.options())
    for (const std::string& flag : flags_of(option)) {
      const std::string text = replaced(replaced(quoted(meaning_of(option)), "[", "("), "]", ")");
      const std::string after = option.value.empty()     ? ""
                                : option.choices.empty() ? ":value:_files"
                                                         : ":value:(" + joined(option.choices) + ")";
      all += " '" + flag + "[" + replaced(text, ":", "\\:") + "]" + after + "'";
    }
  return all;
}

std::string zsh_completion(const Command& tool) {
  std::string script = "#compdef fascia\nlocal -a commands=(\n";
  for (const Command& command : tool.commands())
    script += "  '" + command.name() + ":" + replaced(quoted(command.description()), ":", "\\:") + "'\n";
  script += ")\nif (( CURRENT == 2 )); then _describe command commands; return; fi\ncase $words[2] in\n";
  for (const Command& command : tool.commands())
    script += "  " + command.name() + ") _arguments '*:file:_files'" + zsh_specs(tool) + zsh_specs(command) +
              " ;;\n";
  return script + "esac\n";
}

std::string fish_lines(const Command& command, const std::string& condition) {
  std::string all;
  for (const OptionFacts& option : command.options()) {
    std::string names;
    for (const std::string& flag : flags_of(option))
      names += flag.rfind("--", 0) == 0 ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
    if (names.empty()) continue;
    const std::string choices =
        option.choices.empty() ? std::string() : " -f -a '" + joined(option.choices) + "'";
    all += "complete -c fascia" + condition + names + (option.value.empty() ? "" : " -r" + choices) +
           " -d '" + quoted(meaning_of(option)) + "'\n";
  }
  return all;
}

std::string fish_completion(const Command& tool) {
  std::string script = fish_lines(tool, "");
  for (const Command& command : tool.commands()) {
    script += "complete -c fascia -n __fish_use_subcommand -a " + command.name() + " -d '" +
              quoted(command.description()) + "'\n";
    script += fish_lines(command, " -n '__fish_seen_subcommand_from " + command.name() + "'");
  }
  return script;
}

}  // namespace

void add_manual(const Command& tool) {
  auto kind = std::make_shared<std::string>("man");
  const Command command = tool.command("manual", "Print the manual page, or the completions of a shell");
  command.positional("KIND", kind.get(), "Which").one_of({"man", "bash", "zsh", "fish"});
  // By reference: a copy kept by one of the tool's own commands would never be freed.
  command.run([&tool, kind] {
    const std::string text = *kind == "man"    ? man_page(tool)
                             : *kind == "bash" ? bash_completion(tool)
                             : *kind == "zsh"  ? zsh_completion(tool)
                                               : fish_completion(tool);
    std::fwrite(text.data(), 1, text.size(), stdout);
  });
}

}  // namespace fascia::cli

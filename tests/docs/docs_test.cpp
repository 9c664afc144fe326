// The pages: their links, the commands and options they name, and the tutorials as a reader would follow
// them.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "builder/rigging/embedded_head.h"
#include "tests/cli/tool.h"

namespace fascia::cli {
namespace {

namespace fs = std::filesystem;

fs::path project() {
  return test::data().parent_path().parent_path();
}

std::vector<fs::path> pages() {
  std::vector<fs::path> found = {project() / "README.md", project() / "CONTRIBUTING.md",
                                 project() / "CHANGELOG.md"};
  for (const char* folder : {"docs", "anatomy", "rig/spec", "samples", "hosts", "bindings"})
    for (const auto& entry : fs::recursive_directory_iterator(project() / folder))
      if (entry.path().extension() == ".md" &&
          entry.path().string().find("node_modules") == std::string::npos)
        found.push_back(entry.path());
  return found;
}

TEST(Docs, EveryLinkLeadsSomewhere) {
  const std::regex link(R"(\]\(([^)#\s]+)(#[^)]*)?\))");
  size_t links = 0;
  for (const fs::path& page : pages()) {
    const std::string text = text_of(page);
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
      const std::string target = (*at)[1];
      if (target.find("://") != std::string::npos || target.rfind("mailto:", 0) == 0) continue;
      ++links;
      EXPECT_TRUE(fs::exists(page.parent_path() / target)) << page << ": " << target;
    }
  }
  EXPECT_GT(links, 60u);
}

TEST(Docs, TheIndexListsEveryPage) {
  const std::string index = text_of(project() / "docs/README.md");
  for (const auto& entry : fs::recursive_directory_iterator(project() / "docs"))
    if (entry.path().extension() == ".md" && entry.path().filename() != "README.md") {
      const std::string name = fs::relative(entry.path(), project() / "docs").generic_string();
      EXPECT_NE(index.find("(" + name + ")"), std::string::npos) << name;
    }
}

/// The tests that the table of complaints names, whole suites among them, are there.
TEST(Docs, EveryTestThatAnswersAComplaintExists) {
  std::string sources;
  for (const auto& entry : fs::recursive_directory_iterator(project() / "tests"))
    if (entry.path().extension() == ".cpp" || entry.path().filename() == "CMakeLists.txt")
      sources += text_of(entry.path());
  std::istringstream page(text_of(project() / "docs/integration.md"));
  const std::regex row(R"(^\| (\d+)\. .*\|(.*)\|$)"), name(R"(`(\w+)(\.(\w+))?`)");
  std::set<int> answered;
  for (std::string line; std::getline(page, line);) {
    std::smatch cells;
    if (!std::regex_match(line, cells, row)) continue;
    const std::string tests = cells[2];
    for (std::sregex_iterator at(tests.begin(), tests.end(), name), end; at != end; ++at) {
      const std::string suite = (*at)[1], test = (*at)[3];
      const std::regex cases("TEST(_F|_P)?\\(" + suite + ", " + (test.empty() ? "" : test + "\\)"));
      const bool is_there = std::regex_search(sources, cases) ||
                            sources.find("NAME " + suite + "." + test + " ") != std::string::npos;
      EXPECT_TRUE(is_there) << line << "\n" << (*at).str();
      if (is_there) answered.insert(std::stoi(cells[1]));
    }
  }
  EXPECT_EQ(answered.size(), 17U);
}

/// What `fascia COMMAND --help` prints, asked for once.
const std::string& help_of(const std::string& command) {
  static std::map<std::string, std::string> known;
  const auto [entry, is_new] = known.try_emplace(command);
  if (is_new) {
    const fs::path folder = fs::temp_directory_path() / "fascia_docs_help";
    fs::create_directories(folder);
    entry->second = run_tool(folder, command + " --help").out;
  }
  return entry->second;
}

TEST(Docs, CommandsAndOptionsThatAreNamedExist) {
  const std::string tool_help = help_of("");
  const std::regex call(R"(\bfascia ([a-z]+)\b([^`\n|]*))"), option(R"((--[a-z][a-z-]*))");
  size_t options = 0;
  for (const fs::path& page : pages()) {
    const std::string text = text_of(page);
    for (std::sregex_iterator at(text.begin(), text.end(), call), end; at != end; ++at) {
      const std::string command = (*at)[1], rest = (*at)[2];
      // "the fascia spans": prose. A command is followed by its options or arguments, or stands in the tool's
      // list.
      if (tool_help.find("\n  " + command + " ") == std::string::npos) continue;
      for (std::sregex_iterator word(rest.begin(), rest.end(), option); word != end; ++word) {
        const std::string name = (*word)[1];
        ++options;
        EXPECT_TRUE(std::regex_search(help_of(command), std::regex(name + "\\b(?!-)")))
            << page << ": fascia " << command << rest;
      }
    }
  }
  EXPECT_GT(options, 40u);
}

/// The `sh` blocks of a page as one script. Blocks marked may-fail may end with 4, as checks do.
std::string script_of(const fs::path& page) {
  std::ifstream file(page);
  std::string script;
  bool is_inside = false, may_fail = false;
  for (std::string line; std::getline(file, line);) {
    if (!is_inside && line.rfind("```sh", 0) == 0) {
      is_inside = true;
      may_fail = line == "```sh may-fail";
      if (may_fail) script += "{\n";
    } else if (is_inside && line == "```") {
      is_inside = false;
      if (may_fail) script += "} || test $? -eq 4\n";
    } else if (is_inside) {
      script += line + "\n";
    }
  }
  return script;
}

class Tutorial : public ::testing::TestWithParam<const char*> {};

TEST_P(Tutorial, CanBeFollowed) {
  const fs::path folder = fs::temp_directory_path() / (std::string("fascia_tutorial_") + GetParam());
  fs::remove_all(folder);
  fs::create_directories(folder);
  rigging::write_embedded_head(folder / "head.obj", folder / "landmarks_of_the_head.json");
  const std::string script = script_of(project() / "docs/tutorials" / (std::string(GetParam()) + ".md"));
  ASSERT_GT(std::count(script.begin(), script.end(), '\n'), 5);
  const fs::path tools = test::tool().parent_path(), libraries = tools.parent_path() / "lib";
  std::ofstream(folder / "run.sh") << "set -eu\nexport PATH='" + tools.string() + "':\"$PATH\"\n"
                                   << "export C_INCLUDE_PATH='" + (project() / "runtime/include").string() +
                                          "'\n"
                                   << "export LIBRARY_PATH='" + libraries.string() + "'\n"
                                   << "export LD_LIBRARY_PATH='" + libraries.string() + "'\n"
                                   << "export FASCIA_SOURCE='" + project().string() + "'\nset -x\n"
                                   << script;
  const int status =
      std::system(("cd '" + folder.string() + "' && sh run.sh >out.txt 2>err.txt </dev/null").c_str());
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 0) << text_of(folder / "err.txt");
  if (status == 0) fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Docs, Tutorial,
                         ::testing::Values("artist", "engine_programmer", "anatomist", "researcher"));

}  // namespace
}  // namespace fascia::cli

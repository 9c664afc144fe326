#include "app/window/file_browser.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "app/window/theme.h"
#include "app/window/widgets.h"
#include "geometry/text.h"

namespace fascia::app {

namespace fs = std::filesystem;

void FileBrowser::ask_to_open(const std::string& title, std::vector<std::string> endings, Chosen chosen) {
  is_saving_ = false;
  name_.clear();
  begin(title, std::move(endings), std::move(chosen));
}

void FileBrowser::ask_to_save(const std::string& title, const std::string& name,
                              std::vector<std::string> endings, Chosen chosen) {
  is_saving_ = true;
  name_ = name;
  begin(title, std::move(endings), std::move(chosen));
}

void FileBrowser::begin(const std::string& title, std::vector<std::string> endings, Chosen chosen) {
  title_ = title;
  endings_ = std::move(endings);
  chosen_ = std::move(chosen);
  is_open_ = begins_ = true;
  asks_to_replace_ = false;
  std::error_code status;
  if (folder.empty() || !fs::is_directory(folder, status)) folder = fs::current_path(status);
  read_folder();
}

void FileBrowser::read_folder() {
  entries_.clear();
  fault_.clear();
  std::error_code status;
  fs::directory_iterator entry(folder, fs::directory_options::skip_permission_denied, status);
  if (status) fault_ = "This folder cannot be read: " + status.message();
  for (const size_t most = 5000; !status && entry != fs::directory_iterator() && entries_.size() < most;
       entry.increment(status)) {
    const std::string name = entry->path().filename().string();
    std::error_code kind;
    const bool is_folder = entry->is_directory(kind);
    if (name.empty() || name[0] == '.') continue;
    const std::string ending = extension_of(entry->path());
    if (!is_folder && !endings_.empty() &&
        std::find(endings_.begin(), endings_.end(), ending) == endings_.end())
      continue;
    entries_.push_back({name, is_folder});
  }
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.is_folder != b.is_folder ? a.is_folder : lower_case(a.name) < lower_case(b.name);
  });
}

bool FileBrowser::accept(const std::string& name) {
  if (name.empty()) return false;
  fs::path path = fs::path(name).is_absolute() ? fs::path(name) : folder / name;
  std::error_code status;
  if (fs::is_directory(path, status)) {
    folder = fs::weakly_canonical(path, status);
    name_.clear();
    read_folder();
    return false;
  }
  if (is_saving_ && path.extension().empty() && !endings_.empty()) path += endings_.front();
  if (!is_saving_ && !fs::exists(path, status)) {
    fault_ = "There is no file of that name";
    return false;
  }
  if (is_saving_ && !fs::is_directory(path.parent_path(), status)) {
    fault_ = "The folder is not there";
    return false;
  }
  if (is_saving_ && !confined_to.empty() &&
      fs::weakly_canonical(path.parent_path(), status) != fs::canonical(confined_to, status)) {
    fault_ = "Nothing is written here";
    return false;
  }
  if (is_saving_ && fs::exists(path, status) && !asks_to_replace_) {
    asks_to_replace_ = true;
    fault_ = "It is there already: press again to replace it";
    return false;
  }
  folder = path.parent_path();
  is_open_ = false;
  const Chosen chosen = std::move(chosen_);
  chosen(path);
  return true;
}

void FileBrowser::show() {
  if (!is_open_) return;
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5F * window.x, 0.5F * window.y}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::SetNextWindowSize({std::min(scaled(640), window.x - 20), std::min(scaled(480), window.y - 20)});
  if (std::exchange(begins_, false)) ImGui::OpenPopup("##browser");
  const Palette& p = palette();
  if (!ImGui::BeginPopupModal("##browser", nullptr,
                              ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar)) {
    is_open_ = false;
    return;
  }
  ImGui::PushFont(fonts().large);
  ImGui::TextUnformatted(title_.c_str());
  ImGui::PopFont();
  const float width = ImGui::GetContentRegionAvail().x;
  if (ui::button("Up##browser")) {
    folder = folder.parent_path();
    read_folder();
  }
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(p.faint, "%s", ui::shortened(folder.string(), width - scaled(60)).c_str());
  const float foot = 2.6F * ImGui::GetFrameHeightWithSpacing();
  ImGui::PushStyleColor(ImGuiCol_ChildBg, p.window);
  ImGui::BeginChild("##entries", {0, -foot});
  std::string picked;
  bool is_double = false;
  for (const Entry& entry : entries_) {
    ImGui::PushID(entry.name.c_str());
    const std::string line = "  " + entry.name + (entry.is_folder ? "/" : "");
    if (ImGui::Selectable(line.c_str(), entry.name == name_, ImGuiSelectableFlags_AllowDoubleClick)) {
      picked = entry.name;
      is_double = ImGui::IsMouseDoubleClicked(0) || entry.is_folder;
    }
    ImGui::PopID();
  }
  ImGui::EndChild();
  ImGui::PopStyleColor();
  if (!picked.empty()) {
    name_ = picked;
    asks_to_replace_ = false;
  }
  ImGui::SetNextItemWidth(width);
  if (is_saving_ && ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  const bool is_entered =
      ImGui::InputTextWithHint("##name", "Name or path", &name_, ImGuiInputTextFlags_EnterReturnsTrue);
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(p.warning, "%s", fault_.c_str());
  const float buttons = scaled(100);
  ImGui::SameLine(width - 2 * buttons - scaled(8) + ImGui::GetStyle().WindowPadding.x);
  const bool is_cancelled = ui::button("Cancel##browser", ui::Emphasis::quiet, buttons) ||
                            ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  ImGui::SameLine();
  const bool is_taken =
      ui::button(is_saving_ ? "Save##browser" : "Open##browser", ui::Emphasis::strong, buttons);
  if (is_taken || is_entered || is_double)
    accept(name_);
  else if (is_cancelled)
    is_open_ = false;
  if (!is_open_) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace fascia::app

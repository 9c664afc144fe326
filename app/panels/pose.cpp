#include <algorithm>
#include <map>

#include "anatomy/anatomy.h"
#include "app/model/names.h"
#include "app/panels/screen.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

/// One line of the list: a value, or a left and a right one.
struct Row {
  std::string title, note, group;
  std::string left, right, middle;  ///< full names; empty: none
};

const char* vocabulary_title(const std::string& set) {
  if (set == "arkit") return "ARKit";
  if (set == "au") return "FACS";
  if (set == "viseme") return "Visemes";
  if (set == "vrm") return "Emotions";
  if (set == "smile") return "Smiles";
  return nullptr;
}

/// What the rig's vocabularies say of their members, such as "lip corner puller", by set:member.
const std::map<std::string, std::string>& notes() {
  static const std::map<std::string, std::string> known = [] {
    std::map<std::string, std::string> found;
    for (const std::string& file : anatomy::embedded_files()) {
      if (file.rfind("expressions/", 0) != 0) continue;
      const auto json = nlohmann::json::parse(anatomy::embedded_file(file), nullptr, false);
      if (!json.is_object() || !json.contains("expressions")) continue;
      for (const auto& expression : json["expressions"])
        if (expression.contains("note"))
          found[json.value("name", "") + ":" + expression.value("name", "")] = expression.value("note", "");
    }
    return found;
  }();
  return known;
}

std::string note_of(const std::string& name) {
  const auto found = notes().find(name);
  if (found == notes().end()) return "";
  return found->second.substr(0, found->second.find(", left side"));
}

void add_row(std::vector<Row>& rows, std::map<std::string, size_t>& known, const std::string& name,
             const std::string& group) {
  const SplitName split = split_side(name);
  // Of an action unit for both sides and its halves the halves are enough.
  const auto [entry, is_new] = known.try_emplace(split.base, rows.size());
  if (is_new) rows.push_back({title_of(name), note_of(name), group, "", "", ""});
  Row& row = rows[entry->second];
  (split.half == Half::left ? row.left : split.half == Half::right ? row.right : row.middle) = name;
}

std::vector<Row> channel_rows(const FaceAsset& asset) {
  std::vector<Row> rows;
  std::map<std::string, size_t> known;
  for (const FaceChannel& channel : asset.channels)
    add_row(rows, known, channel.name, std::string(region_of(channel.name)));
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    const std::array<std::string, 6> order = {
        "Brow and eye", "Nose and upper lip", "Mouth and cheek", "Lower lip and chin", "Jaw", "Other"};
    const auto place = [&](const Row& row) { return std::find(order.begin(), order.end(), row.group); };
    return place(a) < place(b);
  });
  return rows;
}

std::vector<Row> set_rows(const FaceSet& set) {
  std::vector<Row> rows;
  std::map<std::string, size_t> known;
  for (const std::string& member : set.members)
    add_row(rows, known, set.name + ":" + member, "");
  for (Row& row : rows)
    if (!row.left.empty() && !row.right.empty()) row.middle.clear();
  return rows;
}

void show_slider(Workspace& work, const std::string& name, const ImVec4& tint, const char* tag, float width) {
  const FaceChannel range = work.rig->asset->range_of(name);
  auto value = static_cast<float>(work.value(name));
  ui::SliderLook look{range.minimum, range.maximum, range.rest, tint, tag, "%.2f"};
  bool has_ended = false;
  if (ui::slider(name, value, look, width, has_ended)) work.set_value(name, static_cast<double>(value), true);
  if (has_ended) work.seal();
  const int channel = work.rig->asset->channel(name);
  if (ImGui::IsItemHovered() && channel >= 0 && work.frame) {
    char text[160];
    std::snprintf(text, sizeof text, "%s = %.3f now, of %.2g to %.2g %s", name.c_str(),
                  static_cast<double>(work.frame->values[static_cast<size_t>(channel)]),
                  static_cast<double>(range.minimum), static_cast<double>(range.maximum), range.unit.c_str());
    ImGui::SetTooltip("%s", text);
  }
}

void show_row(Workspace& work, const Row& row, float width) {
  const Palette& p = palette();
  const std::string& any = !row.middle.empty() ? row.middle : !row.left.empty() ? row.left : row.right;
  std::set<std::string>& stars = work.settings.favourites;
  ImGui::PushID(any.c_str());
  const float mark = ImGui::GetFontSize() + scaled(4);
  const float right_edge = ImGui::GetCursorPosX() + width - mark;
  ImGui::TextUnformatted(ui::shortened(row.title, width - mark - scaled(4)).c_str());
  if (!row.note.empty()) {
    ImGui::SameLine(0, scaled(8));
    const float room = right_edge - ImGui::GetCursorPosX() - scaled(6);
    if (room > scaled(40)) {
      ImGui::PushFont(fonts().small);
      ImGui::SetCursorPosY(ImGui::GetCursorPosY() + scaled(2));
      ImGui::TextColored(p.faint, "%s", ui::shortened(row.note, room).c_str());
      ImGui::PopFont();
    } else {
      ImGui::NewLine();
    }
  }
  ImGui::SameLine(right_edge);
  if (ui::star("star " + any, stars.count(any) > 0))
    if (!stars.erase(any)) stars.insert(any);
  if (!row.middle.empty() && row.left.empty()) {
    show_slider(work, row.middle, p.accent, "", width);
  } else {
    // The subject's right stands to the left, as in the picture.
    const float half = 0.5F * (width - scaled(14));
    if (!row.right.empty()) show_slider(work, row.right, p.right, "R", half);
    if (!row.right.empty() && !row.left.empty()) ImGui::SameLine(0, scaled(14));
    if (!row.left.empty()) show_slider(work, row.left, p.left, "L", half);
  }
  ImGui::PopID();
}

bool is_shown(const Workspace& work, const Screen& screen, const Row& row) {
  const std::string& any = !row.middle.empty() ? row.middle : !row.left.empty() ? row.left : row.right;
  if (screen.shows_favourites && !work.settings.favourites.count(any)) return false;
  return matches(row.title + " " + row.note + " " + any, screen.pose_search);
}

/// The rows of every vocabulary of a rig, put together once.
const std::vector<Row>& rows_of(const FaceAsset& asset, int vocabulary) {
  static const FaceAsset* made_for = nullptr;
  static std::vector<std::vector<Row>> made;
  if (made_for != &asset) {
    made = {channel_rows(asset)};
    for (const FaceSet& set : asset.sets)
      made.push_back(set_rows(set));
    made_for = &asset;
  }
  return made[std::min(static_cast<size_t>(vocabulary), made.size() - 1)];
}

}  // namespace

void show_pose_panel(Workspace& work, Screen& screen) {
  if (!work.rig) return ui::hint("Open a head to pose it.");
  const FaceAsset& asset = *work.rig->asset;
  const float width = ImGui::GetContentRegionAvail().x;
  std::vector<const char*> titles = {"Muscles"};
  std::vector<int> numbers = {0};
  for (size_t s = 0; s < asset.sets.size(); ++s)
    if (const char* title = vocabulary_title(asset.sets[s].name)) {
      titles.push_back(title);
      numbers.push_back(static_cast<int>(s) + 1);
    }
  int chosen = 0;
  for (size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] == screen.vocabulary) chosen = static_cast<int>(i);
  ImGui::PushFont(fonts().small);
  ui::choice("set", titles.data(), static_cast<int>(titles.size()), chosen, width);
  ImGui::PopFont();
  screen.vocabulary = numbers[static_cast<size_t>(chosen)];
  ui::search("Search", screen.pose_search, width);
  ui::check("Symmetric", work.settings.is_symmetric);
  ui::tooltip("Both sides follow together (X)");
  ImGui::SameLine(0, scaled(14));
  ui::check("Favourites", screen.shows_favourites);
  ImGui::SameLine(width - scaled(74) + ImGui::GetStyle().WindowPadding.x);
  if (ui::button("Neutral", ui::Emphasis::plain, scaled(74))) work.clear_pose();
  ImGui::Dummy({0, scaled(2)});
  ImGui::BeginChild("##values", {0, list_height(0.0F)});
  const float inner = ImGui::GetContentRegionAvail().x - scaled(12);
  std::string group;
  int shown = 0;
  for (const Row& row : rows_of(asset, screen.vocabulary)) {
    if (!is_shown(work, screen, row)) continue;
    if (row.group != group) ui::heading((group = row.group).c_str());
    show_row(work, row, inner);
    ++shown;
  }
  if (shown == 0)
    ui::hint(screen.shows_favourites ? "No favourites here yet: click a star to keep a value at hand."
                                     : "Nothing of that name.");
  ImGui::EndChild();
}

}  // namespace fascia::app

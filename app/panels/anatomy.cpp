// Landmarks, muscles and warnings: what is edited and built again.
#include <algorithm>

#include "anatomy/anatomy.h"
#include "app/model/names.h"
#include "app/panels/screen.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

const anatomy::GenericAnatomy& generic() {
  static const anatomy::GenericAnatomy loaded = anatomy::load_generic();
  return loaded;
}

const anatomy::Landmark* described_landmark(const std::string& name) {
  for (const anatomy::Landmark& landmark : generic().landmarks)
    if (landmark.name == name) return &landmark;
  return nullptr;
}

const anatomy::Muscle* described_muscle(const std::string& name) {
  for (const anatomy::Muscle& muscle : generic().muscles)
    if (muscle.name == name) return &muscle;
  return nullptr;
}

/// Edits that the rig does not have yet, and what becomes of them.
void show_rebuild(Workspace& work, float width) {
  ui::check("Build again by itself", work.rebuilds_by_itself);
  ui::tooltip("After each edit the skull, the SMAS and the muscles are built anew in the background");
  if (!work.has_unbuilt_edits() || work.is_building()) return;
  if (ui::button("Build again", ui::Emphasis::strong, width)) work.rebuild();
}

void show_edit_files(Workspace& work, Screen& screen) {
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - scaled(8));
  if (ui::button("Load edits", ui::Emphasis::plain, half))
    screen.browser.ask_to_open("Load edits", {".json"},
                               [&work](const std::filesystem::path& file) { work.load_edits(file); });
  ImGui::SameLine();
  if (ui::button("Save edits", ui::Emphasis::plain, half))
    screen.browser.ask_to_save("Save the edits", "edits.json", {".json"},
                               [&work](const std::filesystem::path& file) { work.save_edits(file); });
}

void show_landmark(Workspace& work, const std::string& name) {
  const anatomy::Landmark* known = described_landmark(name);
  ui::heading(full_title(name).c_str());
  if (known) ui::hint(known->definition);
  for (const rig::Landmark& landmark : work.rig->rig->skull.landmarks)
    if (landmark.name == name) {
      const bool is_edited = landmark_edit(work.state(), name).has_value();
      ImGui::TextColored(landmark_colour(work, landmark),
                         is_edited ? "Placed by hand" : "Found, confidence %.2f",
                         static_cast<double>(landmark.confidence));
      if (landmark.depth > 0.0F)
        ImGui::TextColored(palette().faint, "%.1f mm of tissue over the bone",
                           1e3 * static_cast<double>(landmark.depth));
      if (is_edited && ui::button("Let it be found")) work.release_landmark(name);
    }
}

}  // namespace

void show_landmark_panel(Workspace& work, Screen& screen) {
  if (!work.rig) return ui::hint("Open a head to see its landmarks.");
  const float width = ImGui::GetContentRegionAvail().x;
  ui::hint("Drag a landmark on the skin. Green is certain, amber and red are doubtful, blue is yours.");
  ui::check("Symmetric##landmarks", work.settings.is_symmetric);
  ImGui::SameLine(0, scaled(14));
  ui::check("Only doubtful", screen.shows_only_low);
  show_rebuild(work, width);
  ui::search("Search landmarks", screen.landmark_search, width);
  const float foot = work.selected_landmark.empty() ? scaled(44) : scaled(200);
  ImGui::BeginChild("##landmarks", {0, list_height(foot)});
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (const rig::Landmark& landmark : work.rig->rig->skull.landmarks) {
    const float certain = 0.75F;
    if (screen.shows_only_low && landmark.confidence > certain) continue;
    const std::string title = full_title(landmark.name);
    if (!matches(title + " " + landmark.name, screen.landmark_search)) continue;
    ImGui::PushID(landmark.name.c_str());
    const ImVec2 at = ImGui::GetCursorScreenPos();
    if (ImGui::Selectable(("      " + title).c_str(), work.selected_landmark == landmark.name)) {
      work.selected_landmark = landmark.name;
      if (const auto place = work.landmark(landmark.name)) work.look_at(*place);
    }
    ui::note(landmark.name);
    list->AddCircleFilled({at.x + scaled(10), at.y + 0.5F * ImGui::GetFontSize()}, scaled(4),
                          colour_of(landmark_colour(work, landmark)));
    ImGui::PopID();
  }
  ImGui::EndChild();
  if (!work.selected_landmark.empty()) {
    ImGui::BeginChild("##landmark", {0, scaled(152)});
    show_landmark(work, work.selected_landmark);
    ImGui::EndChild();
  }
  show_edit_files(work, screen);
}

namespace {

/// A factor of a muscle's entry, and of the other side's in symmetric editing.
void show_factor(Workspace& work, const std::string& muscle, const char* key, const char* title,
                 double otherwise, float least, float most, float width) {
  auto value = static_cast<float>(muscle_number(work.state(), muscle, key, otherwise));
  ImGui::TextUnformatted(title);
  ui::SliderLook look{least, most, static_cast<float>(otherwise), palette().accent, "", "%.2f"};
  bool has_ended = false;
  if (ui::slider(title, value, look, width, has_ended)) {
    DocumentState next = work.state();
    const double rounded = std::round(100.0 * static_cast<double>(value)) / 100.0;
    set_muscle_number(next, muscle, key, rounded, otherwise);
    if (work.settings.is_symmetric) set_muscle_number(next, mirrored(muscle), key, rounded, otherwise);
    work.commit(std::move(next), std::string(title) + " of " + full_title(muscle), key + muscle);
  }
  if (has_ended) work.seal();
}

void show_variants(Workspace& work, const std::string& name, const anatomy::Muscle& muscle) {
  if (muscle.variants.empty()) return;
  const std::string chosen = muscle_variant(work.state(), name);
  ImGui::TextUnformatted("Variant");
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::BeginCombo("##variant", chosen.empty() ? "usual" : chosen.c_str())) return;
  const auto choose = [&](const std::string& variant) {
    DocumentState next = work.state();
    set_muscle_variant(next, name, variant);
    if (work.settings.is_symmetric) set_muscle_variant(next, mirrored(name), variant);
    work.commit(std::move(next), "Variant of " + full_title(name));
  };
  if (ImGui::Selectable("usual", chosen.empty())) choose("");
  for (const anatomy::Variant& variant : muscle.variants) {
    char text[160];
    std::snprintf(text, sizeof text, "%s, %.0f %% of faces", variant.name.c_str(),
                  100.0 * variant.prevalence);
    if (ImGui::Selectable(text, chosen == variant.name)) choose(variant.name);
    ui::tooltip(variant.note);
  }
  ImGui::EndCombo();
}

void show_muscle(Workspace& work, Screen& screen, const std::string& name) {
  const float width = ImGui::GetContentRegionAvail().x - scaled(6);
  ui::heading(full_title(name).c_str());
  const anatomy::Muscle* known = described_muscle(name);
  for (const rig::Muscle& muscle : work.rig->rig->muscles)
    if (muscle.name == name && !muscle.fibre_offsets.empty())
      ImGui::TextColored(palette().faint, "%zu fibres, %.1f N at full activation",
                         muscle.fibre_offsets.size() - 1, static_cast<double>(muscle.strength));
  if (ui::button("Contract")) {
    work.set_value(name, work.value(name) > 0.5 ? 0.0 : 1.0, false);
  }
  ImGui::SameLine();
  if (ui::button("Isolate")) {
    const bool was_alone = work.hidden_muscles.size() + 2 >= work.rig->rig->muscles.size();
    work.hidden_muscles.clear();
    if (!was_alone)
      for (const rig::Muscle& muscle : work.rig->rig->muscles)
        if (muscle.name != name && muscle.name != mirrored(name)) work.hidden_muscles.insert(muscle.name);
    work.settings.layers.muscles = true;
  }
  ImGui::SameLine();
  bool is_present = muscle_is_present(work.state(), name);
  if (ui::check("Present", is_present)) {
    DocumentState next = work.state();
    set_muscle_present(next, name, is_present);
    if (work.settings.is_symmetric) set_muscle_present(next, mirrored(name), is_present);
    work.commit(std::move(next), (is_present ? "Add " : "Leave out ") + full_title(name));
  }
  show_factor(work, name, "strength", "Strength", 1.0, 0.0F, 3.0F, width);
  show_factor(work, name, "width", "Width", 1.0, 0.25F, 3.0F, width);
  show_sketch_buttons(work, screen, name, known && known->band);
  if (known) show_variants(work, name, *known);
}

}  // namespace

void show_muscle_panel(Workspace& work, Screen& screen) {
  if (!work.rig) return ui::hint("Open a head to see its muscles.");
  const float width = ImGui::GetContentRegionAvail().x;
  ui::hint("Click a muscle on the face or in the list.");
  if (ui::button(work.hidden_muscles.empty() ? "Show none##muscles" : "Show all##muscles")) {
    if (work.hidden_muscles.empty())
      for (const rig::Muscle& muscle : work.rig->rig->muscles)
        work.hidden_muscles.insert(muscle.name);
    else
      work.hidden_muscles.clear();
  }
  ImGui::SameLine(0, scaled(14));
  ui::check("Symmetric##muscles", work.settings.is_symmetric);
  show_rebuild(work, width);
  ui::search("Search muscles", screen.muscle_search, width);
  const float foot = work.selected_muscle.empty() ? scaled(44) : scaled(360);
  ImGui::BeginChild("##muscles", {0, list_height(foot)});
  std::string region;
  std::vector<const rig::Muscle*> sorted;
  for (const rig::Muscle& muscle : work.rig->rig->muscles)
    if (matches(full_title(muscle.name) + " " + muscle.name, screen.muscle_search)) sorted.push_back(&muscle);
  std::stable_sort(sorted.begin(), sorted.end(), [](const rig::Muscle* a, const rig::Muscle* b) {
    return region_of(a->name) < region_of(b->name);
  });
  for (const rig::Muscle* muscle : sorted) {
    if (region != region_of(muscle->name)) ui::heading((region = region_of(muscle->name)).c_str());
    ImGui::PushID(muscle->name.c_str());
    bool is_shown = !work.hidden_muscles.count(muscle->name);
    if (ui::check("##shown " + muscle->name, is_shown)) {
      if (is_shown)
        work.hidden_muscles.erase(muscle->name);
      else
        work.hidden_muscles.insert(muscle->name);
    }
    ImGui::SameLine();
    const bool is_edited =
        work.state().edits.contains("muscles") && work.state().edits["muscles"].contains(muscle->name);
    if (is_edited) ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(0.42F, 0.66F, 1.0F, 1.0F));
    if (ImGui::Selectable(full_title(muscle->name).c_str(), work.selected_muscle == muscle->name)) {
      work.selected_muscle = muscle->name;
      work.settings.layers.muscles = true;
      if (work.settings.layers.skin_opacity > 0.99) work.settings.layers.skin_opacity = 0.35;
    }
    ui::note(muscle->name);
    if (is_edited) ImGui::PopStyleColor();
    ImGui::PopID();
  }
  ImGui::EndChild();
  if (!work.selected_muscle.empty()) {
    ImGui::BeginChild("##muscle", {0, scaled(308)});
    show_muscle(work, screen, work.selected_muscle);
    ImGui::EndChild();
  }
  show_edit_files(work, screen);
}

void show_warning_panel(Workspace& work, Screen& screen) {
  if (!work.rig) return ui::hint("Open a head: what the builder doubts is listed here.");
  if (ui::button("Check the rig", ui::Emphasis::plain, ImGui::GetContentRegionAvail().x)) work.run_check();
  ui::tooltip("Plays a fixed list of poses and measures the face in them; some seconds in the background");
  if (work.warnings.empty())
    return ui::hint(
        "No warnings. The check plays a list of poses and measures lids, lips, skin and symmetry.");
  ui::hint("Click a warning to see the place.");
  ImGui::BeginChild("##list", {0, list_height(0.0F)});
  for (size_t i = 0; i < work.warnings.size(); ++i) {
    const Warning& warning = work.warnings[i];
    const float width = ImGui::GetContentRegionAvail().x - scaled(10);
    const ImVec2 text = ImGui::CalcTextSize(warning.text.c_str(), nullptr, false, width - scaled(34));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 box(width, text.y + scaled(20));
    if (ImGui::InvisibleButton(("warning " + std::to_string(i + 1)).c_str(), box) && warning.place) {
      work.selected_landmark = warning.landmark;
      work.settings.layers.landmarks = true;
      work.look_at(*warning.place);
    }
    ui::note("warning " + std::to_string(i + 1));
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(
        at, {at.x + box.x, at.y + box.y},
        colour_of(ImGui::IsItemHovered() && warning.place ? palette().hover : palette().raised), scaled(8));
    list->AddCircleFilled({at.x + scaled(15), at.y + scaled(19)}, scaled(4),
                          colour_of(warning.place ? palette().warning : palette().faint));
    list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), {at.x + scaled(27), at.y + scaled(10)},
                  colour_of(palette().text), warning.text.c_str(), nullptr, width - scaled(34));
  }
  ImGui::EndChild();
  (void)screen;
}

}  // namespace fascia::app

// Compare, live input, export.
#include <algorithm>
#include <array>
#include <cmath>

#include "app/panels/screen.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

struct Figures {
  double mean = 0.0,
         largest = 0.0;  ///< millimetres, over the vertices that are apart by more than half a millimetre
  size_t moved = 0;
};

Figures figures_of(const Workspace& work) {
  Figures figures;
  if (!work.has_distances()) return figures;
  for (const auto& list : distances_between(*work.frame, work.reference_frame->positions))
    for (const float metres : list) {
      const double mm = 1e3 * static_cast<double>(metres);
      figures.largest = std::max(figures.largest, mm);
      if (mm < 0.5) continue;
      figures.mean += mm;
      ++figures.moved;
    }
  if (figures.moved) figures.mean /= static_cast<double>(figures.moved);
  return figures;
}

}  // namespace

void show_compare_panel(Workspace& work, Screen& screen) {
  if (!work.rig) return ui::hint("Open a head to compare it.");
  struct Entry {
    Reference reference;
    const char *name, *what;
  };
  constexpr std::array<Entry, 7> entries = {{
      {Reference::none, "Nothing", "the face alone"},
      {Reference::rest, "Rest", "how far every point has moved"},
      {Reference::before, "Before the edits", "the rig as it was built the time before"},
      {Reference::bullet, "Bullet", "the same lattice, another solver"},
      {Reference::converged, "Converged", "double precision, every step to the end"},
      {Reference::file, "A file", "a scan or a sculpt of this head"},
      {Reference::other, "Another head", "the same pose on a second head or rig"},
  }};
  ui::hint("Show the face beside another, or its distance from it.");
  for (const Entry& entry : entries) {
    const bool is_chosen = work.comparison.reference == entry.reference;
    if (ImGui::RadioButton(entry.name, is_chosen) && !is_chosen) {
      if (entry.reference == Reference::file)
        screen.browser.ask_to_open("Compare with a mesh", {".glb", ".gltf", ".obj", ".ply"},
                                   [&work](const std::filesystem::path& file) {
                                     work.compare_with(Reference::file, file.string());
                                   });
      else if (entry.reference == Reference::other)
        screen.browser.ask_to_open("Compare with another head or rig", mesh_endings(),
                                   [&work](const std::filesystem::path& file) {
                                     work.compare_with(Reference::other, file.string());
                                   });
      else
        work.compare_with(entry.reference);
    }
    ui::note(entry.name);
    ImGui::SameLine(scaled(170));
    ImGui::PushFont(fonts().small);
    ImGui::SetCursorPosY(ImGui::GetCursorPosY() + scaled(8));
    ImGui::TextColored(palette().faint, "%s",
                       ui::shortened(entry.what, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopFont();
    ui::tooltip(entry.what);
  }
  if (work.comparison.reference == Reference::none) return;
  ImGui::Dummy({0, scaled(6)});
  if (!work.reference_frame) return ui::hint("It is being prepared.");
  if (work.comparison.reference == Reference::other) {
    ui::hint(std::filesystem::path(work.comparison.file).filename().string() +
             " is on the left. What is not the same mesh has no distances.");
    if (work.frame->positions.size() != work.reference_frame->positions.size()) return;
  }
  ui::check("Heat map", work.comparison.has_heat);
  ImGui::SameLine(0, scaled(14));
  ui::check("Side by side", work.comparison.is_side_by_side);
  ImGui::TextUnformatted("Scale, mm");
  auto scale = static_cast<float>(work.comparison.scale_mm);
  bool has_ended = false;
  if (ui::slider("Scale", scale, {0.5F, 20.0F, 5.0F, palette().accent, "", "%.1f"},
                 ImGui::GetContentRegionAvail().x, has_ended))
    work.comparison.scale_mm = static_cast<double>(scale);
  const Figures figures = figures_of(work);
  char text[160];
  std::snprintf(text, sizeof text,
                "Largest distance %.2f mm. Mean of the %zu points farther than 0.5 mm: %.2f mm.",
                figures.largest, figures.moved, figures.mean);
  ImGui::Dummy({0, scaled(4)});
  ui::hint(text);
}

void show_live_panel(Workspace& work, Screen& screen) {
  ui::hint(
      "Receives a captured face over the network, on this machine only (127.0.0.1), and plays it on top of "
      "the "
      "pose.");
  const float width = ImGui::GetContentRegionAvail().x;
  const auto receiver = [&](const char* title, const char* button, const char* note,
                            LiveReceiver::Protocol protocol, int& port) {
    ui::heading(title);
    ui::hint(note);
    ImGui::PushID(title);
    ImGui::SetNextItemWidth(scaled(110));
    ImGui::InputInt("port", &port, 0);
    port = std::clamp(port, 1, 65535);
    const bool is_on = work.live && work.live->protocol() == protocol;
    ImGui::SameLine(width - scaled(100) + ImGui::GetStyle().WindowPadding.x);
    if (ui::button(is_on ? std::string("Stop##") + button : button,
                   is_on ? ui::Emphasis::plain : ui::Emphasis::strong, scaled(100))) {
      if (is_on)
        work.stop_listening();
      else
        work.listen(protocol, static_cast<uint16_t>(port));
    }
    ImGui::PopID();
  };
  receiver("OSC and VMC", "Listen##osc",
           "VSeeFace, VTube Studio, Waidayo, any program that sends blend shapes by OSC.",
           LiveReceiver::Protocol::osc, screen.osc_port);
  receiver("Live Link Face", "Listen##livelink", "Epic Games' app on a phone, forwarded to this machine.",
           LiveReceiver::Protocol::live_link, screen.live_link_port_number);
  if (!work.live) return;
  ImGui::Dummy({0, scaled(6)});
  const double since = work.live->seconds_since_last();
  ImGui::TextColored(since < 1.0 ? palette().good : palette().faint,
                     since < 1.0 ? "Receiving" : "Listening, nothing comes in");
  char text[120];
  std::snprintf(text, sizeof text, "%llu packets, %llu not understood, %zu values",
                static_cast<unsigned long long>(work.live->datagrams()),
                static_cast<unsigned long long>(work.live->refused()), work.live->values().size());
  ui::hint(text);
}

void show_export_panel(Workspace& work, Screen& screen) {
  if (!work.rig) return ui::hint("Open a head to export it.");
  const float width = ImGui::GetContentRegionAvail().x;
  const std::string stem = std::filesystem::path(work.state().head).stem().string();
  const std::filesystem::path rig = work.rig->file;
  const auto entry = [&](const char* title, const char* what, const std::string& name,
                         std::vector<std::string> endings, FileBrowser::Chosen chosen) {
    ImGui::PushID(title);
    if (ui::button(title, ui::Emphasis::plain, width))
      screen.browser.ask_to_save(title, name, std::move(endings), std::move(chosen));
    ImGui::PopID();
    ui::hint(what);
    ImGui::Dummy({0, scaled(2)});
  };
  entry("Export rig", "The head with its anatomy (.glb), for the runtime and for later.", stem + "_rig.glb",
        {".glb"}, [&work](const std::filesystem::path& file) { work.save_rig(file); });
  entry("Export pose", "The mesh as it stands, in the file's own vertex order.", stem + "_posed.glb",
        {".glb", ".obj", ".ply"}, [&work](const std::filesystem::path& file) { work.export_pose(file); });
  entry("Export ARKit shapes", "52 morph targets with ARKit's names.", stem + "_arkit.glb", {".glb"},
        [&work, rig](const std::filesystem::path& file) {
          work.run(bake_command(rig, "arkit", file), "Export " + file.filename().string());
        });
  if (work.take) {
    ui::SliderLook look{12.0F, 120.0F, 60.0F, palette().accent, "", "%.0f"};
    auto fps = static_cast<float>(screen.export_fps);
    bool has_ended = false;
    entry("Export animation",
          "The recording's piece, simulated: morph targets and curves, or a point cache (.pc2, .mdd).",
          stem + "_take.glb", {".glb", ".pc2", ".mdd"},
          [&work, &screen](const std::filesystem::path& file) { work.export_take(file, screen.export_fps); });
    ImGui::TextUnformatted("Frames a second");
    if (ui::slider("Frames a second", fps, look, width, has_ended))
      screen.export_fps = static_cast<int>(std::lround(fps));
    ImGui::Dummy({0, scaled(4)});
  } else {
    ui::hint("Load a recording in the timeline to export an animation.");
  }
  entry("Draw a picture", "What the picture above the timeline shows, 1600 pixels high.", stem + ".png",
        {".png"}, [&work, &screen](const std::filesystem::path& file) {
          const Area area = face_area(work, screen.viewport);
          work.draw_picture(file, static_cast<double>(area.width / std::max(area.height, 1.0F)));
        });
  entry("Film a turntable", "A film once around the head.", stem + ".mp4", {".mp4"},
        [&work](const std::filesystem::path& file) { work.film_turntable(file); });
  for (const auto& job : work.jobs()) {
    ImGui::PushID(job.get());
    char text[200];
    std::snprintf(text, sizeof text, "%s, %.0f s", job->title().c_str(), job->seconds());
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(text);
    ImGui::SameLine(width - scaled(70));
    if (ui::button("Give up")) job->cancel();
    ImGui::PopID();
  }
}

}  // namespace fascia::app

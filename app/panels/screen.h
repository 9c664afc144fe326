#pragma once

#include <imgui.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/scene/face_picture.h"
#include "app/scene/scene_list.h"
#include "app/scene/still_renderer.h"
#include "app/window/file_browser.h"
#include "app/workspace.h"

namespace fascia::app {

/// A rectangle of the window, pixels.
struct Area {
  float x = 0, y = 0, width = 0, height = 0;
  bool holds(ImVec2 p) const { return p.x >= x && p.y >= y && p.x < x + width && p.y < y + height; }
};

enum class Tool { turn, pull };

/// A rig that is drawn: it is held as long as its scene.
struct ShownFace {
  std::shared_ptr<const FaceAsset> asset;
  std::shared_ptr<const rig::Rig> rig;
  std::shared_ptr<const view::Appearance> appearance;
  std::unique_ptr<SceneStore> scene;

  /// Makes the scene anew when it is of another rig; none when there is none.
  void renew(const LoadedRig* loaded);
};

/// The curve that is being drawn on the skin for a muscle's end.
struct SketchTool {
  std::string muscle;
  std::optional<MuscleEnd> end;  ///< none: nothing is to be drawn
  bool is_drawing = false;       ///< the mouse is down
  std::vector<SkinHit> stroke;
};

/// What the window itself holds: nothing that undo would bring back.
struct Screen {
  FileBrowser browser;
  FacePicture picture;
  StillRenderer stills;
  ShownFace face, reference;

  Tool tool = Tool::turn;
  SketchTool sketch;
  std::string pose_search, landmark_search, muscle_search;
  int vocabulary = 0;  ///< of the pose panel
  bool shows_favourites = false, shows_only_low = false, shows_help = false;
  std::string command;  ///< the `fascia` command that does what was done last
  std::string dragged_landmark, hovered_landmark, hovered_muscle;
  bool is_turning = false, is_shifting = false;
  ImVec2 pressed_at;
  bool has_moved = false;
  int osc_port = vmc_port, live_link_port_number = live_link_port;
  int export_fps = 60;
  uint64_t drawn_stamp = 0;
  double since_motion = 0.0;  ///< seconds the picture has stood still
  FacePicture::Care drawn_care = FacePicture::Care::quick;
  bool is_scripted = false;  ///< the picture is drawn when it is wanted, with everything
  bool wants_full = false;   ///< the next picture is drawn with everything
  std::string picture_key;   ///< of what was drawn last besides the frame
  Area viewport;
  double longest_frame = 0.0, frame_milliseconds = 0.0;
  bool wants_quit = false, wants_theme = false;
  float wanted_scale = 0.0F;  ///< 0: unchanged
};

// Each draws its part of the window into its area.
void show_top_bar(Workspace& work, Screen& screen, const Area& area);
void show_rail(Workspace& work, Screen& screen, const Area& area);
void show_side_panel(Workspace& work, Screen& screen, const Area& area);
void show_viewport(Workspace& work, Screen& screen, const Area& area);
/// Draws the face into the screen's picture when it has changed, or can be drawn with more care than it is.
void renew_picture(Workspace& work, Screen& screen, const Area& area);
/// Curves of the picked muscle's regions over the picture, and the one that is being drawn. `area` is the
/// face's.
void draw_sketches(Workspace& work, Screen& screen, const Area& area);
/// Where the mouse went down, went, and was let go; begin_stroke() is false where nothing is to be drawn.
bool begin_stroke(const Workspace& work, Screen& screen, const std::optional<SkinHit>& hit);
void extend_stroke(const Workspace& work, Screen& screen, const std::optional<SkinHit>& hit);
void end_stroke(Workspace& work, Screen& screen);
/// Rows of the layers, below the track; the height of the timeline with them.
void show_layers(Workspace& work, float width);
float timeline_height(const Workspace& work);
void show_timeline(Workspace& work, Screen& screen, const Area& area);
void show_status(Workspace& work, Screen& screen, const Area& area);
void show_start(Workspace& work, Screen& screen, const Area& area);
void show_build(Workspace& work, Screen& screen, const Area& area);
void show_notices(Workspace& work, const Area& area);
void show_help(Screen& screen);

void show_pose_panel(Workspace& work, Screen& screen);
void show_landmark_panel(Workspace& work, Screen& screen);
void show_muscle_panel(Workspace& work, Screen& screen);
/// To draw the regions of a muscle; one that rings an opening has none.
void show_sketch_buttons(Workspace& work, Screen& screen, const std::string& muscle, bool is_ring);
void show_warning_panel(Workspace& work, Screen& screen);
void show_compare_panel(Workspace& work, Screen& screen);
void show_live_panel(Workspace& work, Screen& screen);
void show_export_panel(Workspace& work, Screen& screen);

/// Begins and ends a part of the window that stays where it is. What may not fit into a small window can
/// scroll.
enum class Scroll { no, down };
void begin_area(const char* name, const Area& area, const ImVec4& background, ImVec2 padding,
                Scroll scroll = Scroll::no);
void end_area();

/// The height of a list that leaves `foot` below it, and of a small window enough to show some lines: then
/// the panel scrolls.
float list_height(float foot);

// The commands that keys and buttons share.
const std::vector<std::string>& mesh_endings();
void ask_to_open(Workspace& work, Screen& screen);
void ask_for_take(Workspace& work, Screen& screen);
void ask_for_layer(Workspace& work, Screen& screen);
void ask_to_save_rig(Workspace& work, Screen& screen);
/// Acts on the keys of the keyboard map.
void act_on_keys(Workspace& work, Screen& screen);

/// The keyboard map, for the help page and the manual.
struct KeyHelp {
  const char *key, *what;
};
const std::vector<KeyHelp>& keyboard_map();

/// The colour of a landmark by how sure the builder is of it, or by the hand that put it.
ImVec4 landmark_colour(const Workspace& work, const rig::Landmark& landmark);

/// The part of the viewport that shows the face: its right half where the reference is beside it.
Area face_area(const Workspace& work, const Area& viewport);

}  // namespace fascia::app

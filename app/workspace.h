#pragma once

#include <deque>
#include <future>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/engine/build_task.h"
#include "app/engine/live_skull.h"
#include "app/engine/pending.h"
#include "app/engine/simulation.h"
#include "app/engine/tool_job.h"
#include "app/live/receiver.h"
#include "app/model/command_line.h"
#include "app/model/document.h"
#include "app/model/orbit.h"
#include "app/model/picking.h"
#include "app/model/session.h"
#include "app/model/settings.h"
#include "app/model/sketch.h"
#include "builder/spatial/surface_query.h"

namespace fascia::app {

/// A line that appears in the window for some seconds.
struct Notice {
  enum class Kind { info, warning, error };
  std::string text;
  Kind kind = Kind::info;
  double age = 0.0;  ///< seconds
};

/// A warning of the builder or a row of the check that failed.
struct Warning {
  std::string text;
  std::string landmark;       ///< the first it names; empty: none
  std::optional<Vec3> place;  ///< where on the face at rest, metres
};

enum class Reference { none, rest, before, bullet, converged, file, other };

/// With what the face is compared, and how that is shown.
struct Comparison {
  Reference reference = Reference::none;
  bool has_heat = true, is_side_by_side = false;  ///< another head is always beside the face
  double scale_mm = 5.0;                          ///< where the heat map ends
  std::string file;                               ///< of Reference::file and ::other
};

constexpr int recorded_rate = 60;  ///< poses a second

/// The timeline's own state.
struct Playback {
  bool is_playing = false, is_recording = false;
  double time = 0.0;                                    ///< seconds in the take
  std::vector<std::map<std::string, double>> recorded;  ///< the pose, `recorded_rate` times a second
  double recorded_seconds = 0.0;
  bool adds_layer = false;  ///< what is recorded is added to the recording that plays
};

/// Skin held by the mouse.
struct Poke {
  uint32_t part = 0, vertex = 0;
  Vec3 target = Vec3::Zero();  ///< metres
  std::vector<std::pair<uint32_t, double>> grip;
};

/// About the landmarks and bones of a rig, metres.
Bounds face_box(const rig::Rig& rig);

enum class Gravity { upright, lying, face_down, upside_down };

/// Everything behind the window, and every command of it, without a pixel: panels, keys and scripts call the
/// same functions. update() lets time pass and never waits for anything.
class Workspace {
 public:
  struct Places {
    std::filesystem::path state;  ///< folder of settings and recordings, and of each window's own folder
    std::filesystem::path tool;   ///< the `fascia` program
  };
  Workspace(Places places, Simulation::Pace pace);
  ~Workspace();

  // --- Files

  /// Opens whatever it is: a head (built in the background), a rig, a recording, an edits file.
  void open(const std::filesystem::path& file);
  /// Opens the head that comes with Fascia.
  void open_embedded_head();
  /// Builds the head again with the present edits.
  void rebuild();
  void cancel_build();
  bool is_building() const { return build_ != nullptr; }
  BuildTask::Progress build_progress() const;
  /// The document of a window that crashed, to be offered; nothing when there is none.
  const std::optional<DocumentState>& left_behind() const { return session_.left_behind(); }
  /// Continues with it. What it left is kept until its head is there.
  void restore();
  /// Gives it up.
  void forget_left_behind() { session_.forget_left_behind(); }
  /// Reads a recording, or edits, in the background.
  void load_take(const std::filesystem::path& file);
  /// The same, and adds it to the recording there is; without one it is the first.
  void load_layer(const std::filesystem::path& file);
  /// The recording of a layer of the document; null while it is read.
  std::shared_ptr<const Take> layer_take(size_t layer) const;
  /// Change a layer, or the first recording, which is layer -1. A weight is one step until seal().
  void weigh_layer(int layer, double weight);
  void mute_layer(int layer, bool is_muted);
  /// Takes a layer away; of the first recording, all of it.
  void remove_layer(int layer);
  /// How long the longest recording is, and where the trimmed piece ends, seconds.
  double timeline_length() const;
  double timeline_end() const;
  void load_edits(const std::filesystem::path& file);
  /// Waits until files are read or written that are under way.
  void wait_for_files();
  /// Saves the edits, or copies the rig as it is built, this in the background: a notice tells when it is
  /// done. False, with a notice, when it cannot be.
  bool save_edits(const std::filesystem::path& file);
  bool save_rig(const std::filesystem::path& file);

  // --- The document

  const DocumentState& state() const { return history_.state(); }
  const History<DocumentState>& history() const { return history_; }
  void commit(DocumentState next, const std::string& label, const std::string& gesture = {});
  /// A drag has ended: what comes next is another step.
  void seal();
  void undo();
  void redo();
  /// Sets a value of the pose, and of the other side in symmetric editing.
  void set_value(const std::string& name, double value, bool is_gesture);
  double value(const std::string& name) const;
  void clear_pose();
  /// Moves a landmark to a point of the skin at rest, metres; its mirror image too in symmetric editing.
  void move_landmark(const std::string& name, const Vec3& point, bool is_gesture);
  void release_landmark(const std::string& name);
  /// Where a landmark is at rest, edits included, metres.
  std::optional<Vec3> landmark(const std::string& name) const;
  /// The same on the face as it stands.
  std::optional<Vec3> landmark_now(const std::string& name) const;
  /// The same with the skin it lies on: `position` and `normal` as the face stands, `rest` at rest.
  std::optional<SkinHit> landmark_hold(const std::string& name) const;
  /// Makes a stroke on the skin (metres at rest) the region of a muscle's end, and its mirror image that of
  /// the other side in symmetric editing. Returns why it cannot be one, and a notice says so; empty: done.
  std::string sketch_region(const std::string& muscle, MuscleEnd end, const std::vector<Vec3>& stroke);
  /// Leaves the region to the builder again.
  void clear_sketch(const std::string& muscle, MuscleEnd end);
  /// The region drawn for a muscle's end as it lies on the skin now; empty when there is none.
  std::vector<SkinHit> sketch_now(const std::string& muscle, MuscleEnd end) const;
  bool has_unbuilt_edits() const { return rig && state().edits != built_edits_; }

  // --- Jobs

  /// Runs a command of the tool in the background.
  void run(const CommandLine& command, const std::string& title);
  /// Exports the mesh as it stands.
  void export_pose(const std::filesystem::path& output);
  /// Exports the trimmed piece of the take.
  void export_take(const std::filesystem::path& output, double fps);
  /// Draws what the viewport shows, `aspect` times as wide as high; films it once around.
  void draw_picture(const std::filesystem::path& output, double aspect);
  void film_turntable(const std::filesystem::path& output);
  /// The command that does the same in a terminal, and what it needs.
  struct PresentCommand {
    std::string text;
    std::map<std::filesystem::path, std::string> files;  ///< that it names and that are not there yet
  };
  PresentCommand present_command() const;
  /// Writes the files it names and returns it; a notice says what it needs. Empty when they cannot
  /// be written.
  std::string copy_command();
  /// What the face does now, by name: the pose, or with a recording or a captured face the channels' values.
  std::map<std::string, double> standing_pose() const;
  void run_check();
  const std::list<std::unique_ptr<ToolJob>>& jobs() const { return jobs_; }

  // --- Live input, comparison, motion

  void listen(LiveReceiver::Protocol protocol, uint16_t port);
  void stop_listening() { live.reset(); }
  void compare_with(Reference reference, const std::string& file = {});
  /// The rig of what the face is compared with, which may be the face's own; null while there is none.
  const LoadedRig* reference_rig() const;
  /// Whether the skin is coloured by its distance to the reference: that has the same vertices.
  bool has_distances() const;
  /// Whether the reference is shown beside the face, in the left half of the picture.
  bool is_divided() const;
  /// The camera for the reference: of another head it shows the same as of the face.
  view::Camera reference_camera() const;
  void start_recording();
  void stop_recording();
  void shake_head() { shake_ = 0.0; }
  /// How far the head is turned by a shake now, degrees about +Y.
  double shake_yaw() const;

  /// Takes hold of the skin, moves the hand, lets go.
  void poke(const SkinHit& hit);
  void pull(const Vec3& target);
  void let_go();
  const std::optional<Poke>& held() const { return poke_; }

  /// Lets time pass.
  void update(double seconds);
  /// True when nothing is on its way: no build, no job, no motion.
  bool is_idle() const;
  /// The same but for the face's own motion, which lips that touch may keep up for long.
  bool is_busy() const;
  /// Counts up with everything that changes the picture of the face.
  uint64_t picture_stamp() const;

  void notify(const std::string& text, Notice::Kind kind = Notice::Kind::info);
  /// Shows a point of the face at rest.
  void look_at(const Vec3& point);

  // --- What panels read, and set where it is theirs

  Settings settings;
  std::optional<LoadedRig> rig;
  std::unique_ptr<Simulation> simulation, reference;
  std::shared_ptr<const Take> take;
  std::vector<std::vector<float>> reference_positions;  ///< of Reference::file, one list a part
  Comparison comparison;
  Playback playback;
  std::unique_ptr<LiveReceiver> live;
  Gravity gravity = Gravity::upright;
  std::vector<Warning> warnings;
  std::vector<Notice> notices;
  Orbit orbit;
  std::string selected_landmark, selected_muscle;
  std::set<std::string> hidden_muscles;
  bool rebuilds_by_itself = true;
  bool orbit_moves = false;  ///< the camera glides
  std::shared_ptr<const FaceFrame> frame;
  std::shared_ptr<const SkullShift> skull_shift;     ///< by landmarks that are not built in yet; null: none
  std::shared_ptr<const FaceFrame> reference_frame;  ///< what the face is compared with; null: nothing

 private:
  enum class FileKind { take, layer, edits, either };
  /// A recording or edits, as read from a file.
  struct ReadFile {
    std::filesystem::path file;
    std::shared_ptr<const Take> take;
    nlohmann::ordered_json edits;
    bool is_again = false;  ///< the document has it already
    bool is_layer = false;  ///< to be added to the recording there is
  };
  void take_build();
  void take_jobs();
  void take_files(bool waits);
  void take_saved(bool waits);
  void take_other();
  void take_reference(bool waits);
  void start_reference(const std::shared_ptr<const FaceAsset>& asset, fascia_solver solver);
  std::shared_ptr<const FaceFrame> frame_of_file() const;
  void renew_reference_frame();
  void read_file(const std::filesystem::path& file, FileKind kind, bool is_again);
  static ReadFile read_now(const std::filesystem::path& file, FileKind kind);
  void adopt(const ReadFile& read);
  /// Reads the document's recording, or drops the one there is.
  void follow_document();
  void start_build(const std::filesystem::path& head, bool builds_anew);
  void remove_old_builds();
  /// Ends a face, or another thing with a thread, without waiting for the step it is at.
  template <class Thing>
  void part_with(std::unique_ptr<Thing> thing) {
    if (!thing) return;
    farewells_.push_back(
        std::async(std::launch::async, [thing = std::move(thing)]() mutable { thing.reset(); }));
  }
  void follow_landmarks();
  bool waits() const { return pace_ == Simulation::Pace::lockstep; }
  void adopt(LoadedRig loaded);
  void read_check(const ToolJob& job);
  void submit(double seconds);
  PictureOrder picture_order() const;
  /// The skin under a point at rest, kept by name.
  std::optional<SkinHit> hold(const std::string& name, const Vec3& rest) const;
  /// The same curve on the other side of the face, on its skin.
  std::vector<Vec3> mirror_image(std::vector<Vec3> curve) const;
  Warning warning_of(const std::string& text) const;

  Places places_;
  Simulation::Pace pace_;
  History<DocumentState> history_;
  Session session_;
  std::unique_ptr<BuildTask> build_;
  std::vector<std::unique_ptr<BuildTask>> given_up_;
  std::list<std::unique_ptr<ToolJob>> jobs_;
  std::deque<std::future<ReadFile>> coming_files_;
  std::map<std::string, std::shared_ptr<const Take>> takes_;  ///< that have been read, by file
  std::set<std::string> asked_takes_;                         ///< that are being read again
  Pending<std::filesystem::path> saving_;
  Pending<std::unique_ptr<Simulation>> coming_reference_;
  Pending<std::vector<std::vector<float>>> coming_positions_;
  std::vector<std::future<void>> farewells_;
  std::unique_ptr<LiveSkull> live_skull_;
  /// What was saved, and of what: commands may name it as long as that is what is there.
  struct SavedFile {
    std::filesystem::path file;
    std::string content;  ///< of a rig the file it was copied from, of edits their text
  };
  std::optional<SavedFile> saved_rig_, saved_edits_;
  std::optional<LoadedRig> before_, other_;
  std::unique_ptr<BuildTask> other_build_;
  std::shared_ptr<const FaceFrame> rest_frame_;
  std::optional<spatial::SurfaceQuery> skin_;
  std::string opened_;     ///< what the build under way was opened as; empty: a rebuild
  bool restores_ = false;  ///< the build under way is of the document that was left behind
  nlohmann::ordered_json built_edits_ = nlohmann::ordered_json::object(), building_edits_, failed_edits_;
  mutable std::map<std::string, SkinHit> holds_;  ///< the skin under landmarks and sketches, found once
  std::optional<Poke> poke_;
  std::optional<double> shake_;
  double since_edit_ = 0.0, since_save_ = 0.0;
  uint32_t resets_ = 0;
  uint64_t changes_ = 0;
};

}  // namespace fascia::app

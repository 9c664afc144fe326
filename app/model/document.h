#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/model/history.h"
#include "geometry/mesh.h"

namespace fascia::app {

/// A recording that is added to the first.
struct TakeLayer {
  std::string file;
  double weight = 1.0;
  bool is_muted = false;

  bool operator==(const TakeLayer&) const = default;
};

/// The recording that is played with those added to it, and which piece of them.
struct TakeChoice {
  std::string file;    ///< empty: none
  double begin = 0.0;  ///< seconds, trim
  double end = -1.0;   ///< seconds; below 0: to the end
  bool loops = true;
  double weight = 1.0;  ///< of the first recording
  bool is_muted = false;
  std::vector<TakeLayer> layers = {};  ///< from the same beginning

  bool operator==(const TakeChoice&) const = default;
};

/// Everything that a user makes in the window, and that undo brings back.
struct DocumentState {
  std::string head;  ///< the mesh the rig is built from; the rig itself when that is what was opened
  /// Of the builder, in the form of an edits file (docs/muscles.md): entries the window does not know are
  /// kept.
  nlohmann::ordered_json edits = nlohmann::ordered_json::object();
  /// By name as `--set` takes them: a channel, or set:member; only what is not at rest.
  std::map<std::string, double> pose;
  TakeChoice take;

  bool operator==(const DocumentState&) const = default;
};

/// Where a landmark was put by hand, in the head file's axes and units; nothing when the builder is to find
/// it.
std::optional<Vec3> landmark_edit(const DocumentState& state, const std::string& name);
void set_landmark(DocumentState& state, const std::string& name, const Vec3& point);
void clear_landmark(DocumentState& state, const std::string& name);
/// Names of the landmarks put by hand.
std::vector<std::string> edited_landmarks(const DocumentState& state);

/// Sets `key` of a muscle's entry, or takes it out when `value` is null, and the entry with its last one.
void set_muscle_entry(DocumentState& state, const std::string& muscle, const char* key,
                      const nlohmann::ordered_json& value);
/// A number of a muscle's entry (`strength`, `width`, `peak_shortening`); `otherwise` when it has none.
double muscle_number(const DocumentState& state, const std::string& muscle, const char* key,
                     double otherwise);
/// Sets it; a number equal to `otherwise` is taken out, and the entry with its last one.
void set_muscle_number(DocumentState& state, const std::string& muscle, const char* key, double value,
                       double otherwise);
bool muscle_is_present(const DocumentState& state, const std::string& muscle);
void set_muscle_present(DocumentState& state, const std::string& muscle, bool is_present);
/// The variant chosen for a muscle; empty for the usual form.
std::string muscle_variant(const DocumentState& state, const std::string& muscle);
void set_muscle_variant(DocumentState& state, const std::string& muscle, const std::string& variant);

/// Sets a value of the pose, or takes it out where it is at `rest`.
void set_pose(DocumentState& state, const std::string& name, double value, double rest = 0.0);

/// The state as JSON and back, for the file that a crash leaves behind. Reading throws fascia::Error naming
/// `where` when the text is not such a state.
std::string to_text(const DocumentState& state);
DocumentState state_from_text(const std::string& text, const std::string& where);

/// Reads an edits file as it stands; whether the builder accepts it shows when it builds. Throws
/// fascia::Error.
nlohmann::ordered_json read_edits_file(const std::filesystem::path& path);
/// Edits as their file has them.
std::string text_of_edits(const nlohmann::ordered_json& edits);
/// Writes edits, whole or not at all. Throws fascia::Error.
void write_edits_file(const std::filesystem::path& path, const nlohmann::ordered_json& edits);

}  // namespace fascia::app

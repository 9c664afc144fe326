#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "app/model/document.h"

namespace fascia::app {

/// What of the anatomy is drawn.
struct Layers {
  bool skin = true, fat = false, smas = false, muscles = false, ligaments = false, skull = false,
       lattice = false, landmarks = false, strain = false;
  bool has_textures = true;   ///< the head's own materials, where it has any and the skin is whole
  double skin_opacity = 1.0;  ///< below 1 what lies beneath shows through

  /// Whether anything beneath the skin is drawn.
  bool has_depth() const { return fat || smas || muscles || ligaments || skull || lattice; }
  bool operator==(const Layers&) const = default;
};

/// Layers by the names that `fascia render --layers` takes, and back; unknown names are left out.
Layers layers_of(const std::string& names);
std::string names_of(const Layers& layers);

/// What the window remembers from one day to the next.
struct Settings {
  int width = 1280, height = 800;
  double scale = 0.0;  ///< of text and widgets; 0: as the display says
  bool is_light = false;
  double panel_width = 370.0;
  std::string panel = "pose";
  bool is_symmetric = true;
  Layers layers;
  std::vector<std::string> recent;   ///< files opened, the last first
  std::set<std::string> favourites;  ///< names of the pose panel
  std::string export_folder;

  /// Puts a file at the head of the recent ones.
  void remember(const std::string& file);
};

/// Where the window keeps its things: $XDG_STATE_HOME/fascia, else ~/.local/state/fascia, else a folder of
/// the temporary directory. Not made yet.
std::filesystem::path state_folder();

/// Settings from a file; what it lacks or has wrong is as it is by default. Never throws.
Settings read_settings(const std::filesystem::path& file);
/// Writes them, whole or not at all; failure is silent, as nothing is lost but comfort.
void write_settings(const std::filesystem::path& file, const Settings& settings);

/// A copy of the document that a crash leaves behind, written as the document changes.
class Autosave {
 public:
  explicit Autosave(std::filesystem::path file) : file_(std::move(file)) {}

  /// What an earlier run left behind; nothing when it ended well. Never throws: an unreadable file is none.
  std::optional<DocumentState> left_behind() const;
  /// Writes the state, if it is another than the last. Never throws.
  void keep(const DocumentState& state);

 private:
  std::filesystem::path file_;
  std::optional<DocumentState> kept_;
};

}  // namespace fascia::app

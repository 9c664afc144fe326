#include "app/application.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "app/monkey.h"
#include "app/panels/screen.h"
#include "app/script_runner.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"
#include "app/window/window.h"

namespace fascia::app {

namespace {

using Clock = std::chrono::steady_clock;

/// Removes the folders of scripts that were killed, when they are a day old.
void remove_old_folders(const std::filesystem::path& temporary) {
  std::error_code status;
  const auto least = std::filesystem::file_time_type::clock::now() - std::chrono::hours(24);
  for (const auto& entry : std::filesystem::directory_iterator(temporary, status))
    if (entry.path().filename().string().rfind("fascia-view-", 0) == 0 && entry.is_directory(status) &&
        entry.last_write_time(status) < least)
      std::filesystem::remove_all(entry.path(), status);
}

/// Scripts and the monkey leave the user's own things alone.
std::filesystem::path state_place(const ApplicationOptions& options) {
  if (!options.state.empty()) return options.state;
  if (options.script.empty() && !options.monkey) return state_folder();
  const std::filesystem::path temporary = std::filesystem::temp_directory_path();
  remove_old_folders(temporary);
  std::string name = (temporary / "fascia-view-XXXXXX").string();
  return mkdtemp(name.data()) ? std::filesystem::path(name) : state_folder();
}

/// Scripts give the same pictures every time, unless they are to show how fast the window is.
bool is_lockstep(const ApplicationOptions& options) {
  return !options.script.empty() && !options.is_real_time;
}

class Application {
 public:
  explicit Application(const ApplicationOptions& options)
      : options_(options),
        state_(state_place(options)),
        work_({state_, ToolJob::this_program()},
              is_lockstep(options) ? Simulation::Pace::lockstep : Simulation::Pace::real_time),
        window_(options.script.empty() ? work_.settings.width : 1280,
                options.script.empty() ? work_.settings.height : 800, "Fascia") {
    if (!options.script.empty()) script_.emplace(options.script);
    if (options.monkey) monkey_.emplace(*options.monkey);
    renew_theme();
    screen_ = std::make_unique<Screen>();
    screen_->is_scripted = is_lockstep(options);
    screen_->browser.folder = work_.settings.export_folder;
    if (monkey_) screen_->browser.folder = screen_->browser.confined_to = state_;
    window_.on_drop = [this](const std::vector<std::string>& files) {
      for (const std::string& file : files)
        work_.open(file);
    };
    for (const std::filesystem::path& file : options.files)
      work_.open(file);
  }

  ~Application() {
    work_.settings.width = window_.width();
    work_.settings.height = window_.height();
    work_.settings.export_folder = screen_->browser.folder.string();
    screen_.reset();
    if (state_ != options_.state && state_ != state_folder()) {
      std::error_code status;
      std::filesystem::remove_all(state_, status);
    }
  }

  ApplicationReport run() {
    const auto started = Clock::now();
    while (!window_.wants_to_close() && !(script_ && script_->has_ended())) {
      if (monkey_ && std::chrono::duration<double>(Clock::now() - started).count() > options_.monkey_seconds)
        break;
      frame();
    }
    ApplicationReport report;
    report.frames = times_.size();
    if (!times_.empty()) {
      std::sort(times_.begin(), times_.end());
      report.longest_frame_ms = times_.back();
      report.median_frame_ms = times_[times_.size() / 2];
    }
    report.longest_update_ms = longest_update_ms_;
    if (script_) report.files = script_->written();
    return report;
  }

 private:
  static double milliseconds_since(Clock::time_point then) {
    return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
  }

  void renew_theme() {
    const double wanted = options_.scale > 0.0         ? options_.scale
                          : work_.settings.scale > 0.0 ? work_.settings.scale
                                                       : static_cast<double>(window_.display_scale());
    const float scale = script_ && options_.scale == 0.0 ? 1.0F : static_cast<float>(wanted);
    const bool is_same = fonts().text && scale == ui_scale();
    apply_theme(work_.settings.is_light, scale);
    if (!is_same) window_.renew_fonts();
  }

  /// How long the loop may sleep until something happens by itself.
  double patience() const {
    if (screen_->is_scripted || monkey_) return 0.0;
    const double passed = std::chrono::duration<double>(Clock::now() - frame_began_).count();
    if (!work_.is_idle() || work_.orbit_moves || !work_.notices.empty())
      return std::max(1.0 / 60.0 - passed, 0.001);
    if (work_.live) return 1.0 / 60.0;
    return screen_->since_motion < 0.5 ? 0.02 : 0.25;
  }

  void frame() {
    if (script_) script_->advance(work_, *screen_, window_);
    if (monkey_) monkey_->advance(work_, *screen_, window_);
    const SyntheticInput* hand = script_ ? &script_->input() : monkey_ ? &monkey_->input() : nullptr;
    window_.begin_frame(patience(), hand);
    const auto started = frame_began_ = Clock::now();
    ui::begin_items();
    const double seconds = std::min(static_cast<double>(ImGui::GetIO().DeltaTime), 0.1);
    act_on_keys(work_, *screen_);
    work_.update(seconds);
    longest_update_ms_ = std::max(longest_update_ms_, milliseconds_since(started));
    work_.orbit_moves = work_.orbit.advance(seconds, screen_->is_scripted);
    lay_out();
    if (screen_->is_scripted && !script_->wants_picture())
      window_.drop_frame();
    else
      window_.end_frame([&] {
        if (script_) script_->take_pictures(*screen_, window_);
      });
    times_.push_back(milliseconds_since(started));

    const size_t most = 100000;
    if (times_.size() > most) times_.erase(times_.begin(), times_.begin() + most / 2);
    if (std::exchange(screen_->wants_theme, false)) renew_theme();
  }

  void lay_out() {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float top = scaled(46), status = scaled(26), rail = scaled(84);
    show_top_bar(work_, *screen_, {0, 0, size.x, top});
    const float height = std::max(size.y - top, 1.0F);
    if (!work_.rig) {
      const Area area{0, top, size.x, height};
      if (work_.is_building())
        show_build(work_, *screen_, area);
      else
        show_start(work_, *screen_, area);
      show_notices(work_, area);
      if (!screen_->is_scripted) screen_->picture.warm_up();
    } else {
      const float timeline = timeline_height(work_);
      const float panel = std::min(scaled(static_cast<float>(work_.settings.panel_width)), 0.45F * size.x);
      const float left = rail + panel, middle = std::max(height - status, 1.0F);
      show_rail(work_, *screen_, {0, top, rail, middle});
      show_side_panel(work_, *screen_, {rail, top, panel, middle});
      const Area viewport{left, top, std::max(size.x - left, 1.0F), std::max(middle - timeline, 1.0F)};
      show_viewport(work_, *screen_, viewport);
      show_timeline(work_, *screen_, {left, top + viewport.height, viewport.width, timeline});
      show_status(work_, *screen_, {0, size.y - status, size.x, status});
      if (work_.is_building()) show_build(work_, *screen_, viewport);
      show_splitter({left - scaled(3), top, scaled(6), middle});
      show_notices(work_, viewport);
    }
    screen_->browser.show();
    show_help(*screen_);
  }

  /// The edge between panel and picture, to be dragged.
  void show_splitter(const Area& area) {
    begin_area("##splitter", area, ImVec4(0, 0, 0, 0), {0, 0});
    ImGui::InvisibleButton("edge", {area.width, area.height});
    ui::note("edge");
    if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (ImGui::IsItemActive())
      work_.settings.panel_width = std::clamp(
          work_.settings.panel_width + static_cast<double>(ImGui::GetIO().MouseDelta.x / ui_scale()), 300.0,
          720.0);
    end_area();
  }

  ApplicationOptions options_;
  std::filesystem::path state_;
  Workspace work_;
  Window window_;
  std::unique_ptr<Screen> screen_;
  std::optional<ScriptRunner> script_;
  std::optional<Monkey> monkey_;
  std::vector<double> times_;
  double longest_update_ms_ = 0.0;
  Clock::time_point frame_began_ = Clock::now();
};

}  // namespace

ApplicationReport run_application(const ApplicationOptions& options) {
  Application application(options);
  return application.run();
}

}  // namespace fascia::app

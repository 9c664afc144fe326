#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "app/workspace.h"
#include "tests/rig/tiny_rig.h"

namespace fascia::app {

namespace fs = std::filesystem;

/// A workspace in a folder of its own, with the tiny rig opened.
class WorkspaceTest : public testing::Test {
 protected:
  WorkspaceTest() : folder_(fs::temp_directory_path() / ("fascia_workspace_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    const auto bytes = test::tiny_rig_file();
    std::ofstream(folder_ / "tiny.glb", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    std::ofstream(folder_ / "smile.csv") << "time,arkit:mouthSmileLeft,unknown\n0,0,1\n0.5,1,1\n1,0,1\n";
    renew();
  }
  ~WorkspaceTest() override {
    work_.reset();
    fs::remove_all(folder_);
  }

  void renew() {
    work_.reset();
    work_ = std::make_unique<Workspace>(Workspace::Places{folder_ / "state", "/bin/true"},
                                        Simulation::Pace::lockstep);
    work_->rebuilds_by_itself = false;
  }
  /// Until nothing is built, read or written any more.
  static void settle(Workspace& work) {
    for (int i = 0; i < 2000 && (i == 0 || work.is_busy()); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      work.update(1.0 / 60.0);
    }
  }
  void open() {
    work_->open(folder_ / "tiny.glb");
    settle(*work_);
    ASSERT_TRUE(work_->rig) << (work_->notices.empty() ? "" : work_->notices.back().text);
  }
  void run(int frames) {
    for (int i = 0; i < frames; ++i)
      work_->update(1.0 / 60.0);
  }
  double distance_from_rest() const {
    double largest = 0.0;
    const auto& part = work_->rig->asset->parts[0];
    for (size_t i = 0; i < part.rest.size(); ++i)
      largest =
          std::max(largest, std::abs(static_cast<double>(work_->frame->positions[0][i] - part.rest[i])));
    return largest;
  }

  fs::path folder_;
  std::unique_ptr<Workspace> work_;
};

}  // namespace fascia::app

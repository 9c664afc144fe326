#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "formats/landmark_file.h"
#include "formats/scene.h"

namespace fascia::bench {

/// A head to build from, with its landmarks.
struct Person {
  formats::Scene scene;
  formats::LandmarkFile landmarks;
};

/// `embedded` for the head the library brings along, else the measured one of that name (neutral, person_0
/// ..).
Person read_person(const std::string& name);

/// Whether the measured heads are available.
bool has_measured_people();

/// The mesh of the face. Throws Error when the scene has none.
const formats::SceneMesh& head_mesh(const formats::Scene& scene);

/// Builds the rig of `person` with all levels up to `detail` and writes it to `path`.
void build_rig_file(const Person& person, const std::string& detail, const std::filesystem::path& path);

/// Calls `run` for each of `people` (the embedded head if there are none) and says which are not available.
/// Prints what `run` throws; returns the exit code of the benchmark `program`.
int for_each_person(const char* program, const std::vector<std::string>& people,
                    const std::function<void(const std::string&)>& run);

}  // namespace fascia::bench

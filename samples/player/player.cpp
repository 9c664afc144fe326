// Plays a curve file on a rig without a window: a summary, or each frame as an OBJ file.
#include <fascia/fascia.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

struct Arguments {
  std::string rig, curves, output;  // output: folder for OBJ frames
  double fps = 60;
  int frames = -1;  // -1: as long as the curves last
};

void check(fascia_result result, const std::string& what) {
  if (result != FASCIA_OK) throw std::runtime_error(what + ": " + fascia_last_message());
}

std::vector<char> file_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

int count_of(const std::string& option, const std::string& word) {
  int count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size() || count < 0)
    throw std::invalid_argument(option + " takes a whole number from 0, not '" + word + "'");
  return count;
}

Arguments arguments_of(int argc, char** argv) {
  Arguments arguments;
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto next = [&]() -> std::string {
      if (i + 1 == argc) throw std::invalid_argument(word + " needs a value");
      return argv[++i];
    };
    if (word == "--frames")
      arguments.frames = count_of(word, next());
    else if (word == "--fps")
      arguments.fps = std::atof(next().c_str());
    else if (word == "-o")
      arguments.output = next();
    else
      names.push_back(word);
  }
  if (names.size() != 2 || !(arguments.fps > 0))
    throw std::invalid_argument("a rig, a curve file and a rate above 0");
  arguments.rig = names[0];
  arguments.curves = names[1];
  return arguments;
}

fascia_vectors positions_of(fascia_face* face, uint32_t mesh) {
  fascia_vectors vectors = {};
  vectors.struct_size = sizeof vectors;
  check(fascia_face_positions(face, mesh, &vectors), "positions");
  return vectors;
}

/// All meshes of the face as one OBJ file, in the input file's own axes and units.
void write_obj(const fascia_asset* asset, fascia_face* face, uint32_t meshes, const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) throw std::runtime_error("cannot write " + path);
  uint32_t first = 1;
  for (uint32_t m = 0; m < meshes; ++m) {
    fascia_mesh_info mesh = {};
    mesh.struct_size = sizeof mesh;
    check(fascia_asset_get_mesh(asset, m, &mesh), "mesh");
    const fascia_vectors positions = positions_of(face, m);
    std::fprintf(file, "o %s\n", mesh.part);
    for (uint32_t v = 0; v < positions.count; ++v)
      std::fprintf(file, "v %.7g %.7g %.7g\n", static_cast<double>(positions.data[3 * v]),
                   static_cast<double>(positions.data[3 * v + 1]),
                   static_cast<double>(positions.data[3 * v + 2]));
    for (uint32_t t = 0; t < mesh.triangle_count; ++t)
      std::fprintf(file, "f %u %u %u\n", first + mesh.triangles[3 * t], first + mesh.triangles[3 * t + 1],
                   first + mesh.triangles[3 * t + 2]);
    first += positions.count;
  }
  const bool is_whole = std::fflush(file) == 0 && std::ferror(file) == 0;
  if (std::fclose(file) != 0 || !is_whole) {
    std::remove(path.c_str());
    throw std::runtime_error("cannot write " + path);
  }
}

/// Warns of curves that move nothing, with their names.
void report_unmatched(const fascia_curves* curves, const fascia_asset* asset) {
  fascia_curves_info info = {};
  info.struct_size = sizeof info;
  check(fascia_curves_get_info(curves, &info), "curves");
  std::vector<uint8_t> matched(info.count);
  uint32_t count = 0;
  check(fascia_curves_match(curves, asset, &count, matched.data()), "curves");
  if (count == 0) throw std::runtime_error("the rig has no channel for any of the curves");
  for (uint32_t i = 0; i < info.count; ++i)
    if (matched[i] == 0) std::fprintf(stderr, "no channel for curve %s\n", info.names[i]);
}

int play(const Arguments& arguments) {
  const std::vector<char> rig = file_bytes(arguments.rig), motion = file_bytes(arguments.curves);
  fascia_asset* asset = nullptr;
  fascia_curves* curves = nullptr;
  fascia_face* face = nullptr;
  check(fascia_asset_load(rig.data(), rig.size(), &asset), arguments.rig);
  check(fascia_curves_load(motion.data(), motion.size(), &curves), arguments.curves);
  report_unmatched(curves, asset);
  fascia_face_options options = fascia_default_face_options();
  options.space = arguments.output.empty() ? FASCIA_SPACE_METRES : FASCIA_SPACE_INPUT;
  check(fascia_face_create(asset, &options, &face), "face");

  fascia_asset_info info = {};
  info.struct_size = sizeof info;
  check(fascia_asset_get_info(asset, &info), "info");
  fascia_curves_info length = {};
  length.struct_size = sizeof length;
  check(fascia_curves_get_info(curves, &length), "curves");
  const int frames = arguments.frames >= 0
                         ? arguments.frames
                         : static_cast<int>(std::floor(length.duration * arguments.fps)) + 1;

  std::vector<std::vector<float>> rest;
  for (uint32_t m = 0; m < info.mesh_count; ++m) {
    const fascia_vectors positions = positions_of(face, m);
    rest.emplace_back(positions.data, positions.data + 3 * positions.count);
  }
  double farthest = 0, seconds = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const auto begin = std::chrono::steady_clock::now();
    check(fascia_curves_apply(curves, frame / arguments.fps, 1.0F, face), "curves");
    check(fascia_face_step(face, static_cast<float>(1.0 / arguments.fps)), "step");
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (uint32_t m = 0; m < info.mesh_count; ++m) {
      const fascia_vectors positions = positions_of(face, m);
      for (std::size_t i = 0; i < rest[m].size(); i += 3)
        farthest =
            std::max(farthest, std::hypot(static_cast<double>(positions.data[i]) - rest[m][i],
                                          static_cast<double>(positions.data[i + 1]) - rest[m][i + 1],
                                          static_cast<double>(positions.data[i + 2]) - rest[m][i + 2]));
    }
    if (!arguments.output.empty()) {
      char name[32];
      std::snprintf(name, sizeof name, "/frame_%05d.obj", frame);
      write_obj(asset, face, info.mesh_count, arguments.output + name);
    }
  }
  const bool metres = options.space == FASCIA_SPACE_METRES;
  std::printf("%d frames, %.3f ms each, farthest vertex %.4g %s\n", frames,
              frames > 0 ? 1000 * seconds / frames : 0.0, metres ? 1000 * farthest : farthest,
              metres ? "mm" : "of the file's units");
  fascia_face_release(face);
  fascia_curves_release(curves);
  fascia_asset_release(asset);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return play(arguments_of(argc, argv));
  } catch (const std::invalid_argument& error) {
    std::fprintf(
        stderr, "%s\nusage: sample_player RIG.glb CURVES.(csv|json|glb) [--frames N] [--fps F] [-o FOLDER]\n",
        error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

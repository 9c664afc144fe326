#include "snapshot/record.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "formats/content_hash.h"
#include "geometry/error.h"
#include "rig/read/read.h"
#include "snapshot/player.h"

namespace fascia::snapshot {

namespace {

/// Where each of the snapshot's meshes is among the player's.
std::vector<size_t> meshes_of(const Snapshot& snapshot, const std::vector<PlayedMesh>& meshes,
                              const std::string& name) {
  std::vector<size_t> places;
  for (const Mesh& wanted : snapshot.meshes) {
    const auto found = std::find_if(meshes.begin(), meshes.end(), [&](const PlayedMesh& mesh) {
      return mesh.mesh == wanted.mesh && mesh.primitive == wanted.primitive;
    });
    const size_t count = found == meshes.end() ? 0 : found->rest.size() / 3;
    if (count != wanted.vertex_count)
      throw Error(name + ": mesh " + std::to_string(wanted.mesh) + ", primitive " +
                  std::to_string(wanted.primitive) + " has " + std::to_string(count) +
                  " vertices, where the snapshot's head had " + std::to_string(wanted.vertex_count) +
                  ": the mesh is another; record a new snapshot");
    places.push_back(static_cast<size_t>(found - meshes.begin()));
  }
  return places;
}

/// Keeps of the player's meshes those that the regions name, and makes the regions name them.
void set_regions(Snapshot& snapshot, std::vector<Region> regions, const std::vector<PlayedMesh>& meshes) {
  std::vector<int64_t> kept(meshes.size(), -1);
  for (const Region& region : regions)
    for (const Vertex& vertex : region.vertices)
      kept[vertex.mesh] = 0;
  for (size_t m = 0; m < meshes.size(); ++m) {
    if (kept[m] < 0) continue;
    kept[m] = static_cast<int64_t>(snapshot.meshes.size());
    snapshot.meshes.push_back(
        {meshes[m].mesh, meshes[m].primitive, static_cast<uint32_t>(meshes[m].rest.size() / 3)});
  }
  for (Region& region : regions)
    for (Vertex& vertex : region.vertices)
      vertex.mesh = static_cast<uint32_t>(kept[vertex.mesh]);
  snapshot.regions = std::move(regions);
}

/// Reads the watched vertices off a player.
class Watch {
 public:
  Watch(const Snapshot& snapshot, std::vector<size_t> meshes)
      : snapshot_(snapshot), meshes_(std::move(meshes)) {}

  std::vector<int32_t> quanta(const Player& player, bool is_rest) const {
    std::vector<int32_t> numbers;
    numbers.reserve(3 * snapshot_.vertex_count());
    const double scale = 1e3 / snapshot_.quantum_mm;
    for (const Region& region : snapshot_.regions)
      for (const Vertex& vertex : region.vertices) {
        const size_t mesh = meshes_[vertex.mesh];
        const std::span<const float> now = player.positions(mesh);
        const std::vector<float>& rest = player.meshes()[mesh].rest;
        for (size_t k = 3 * size_t{vertex.vertex}; k < 3 * size_t{vertex.vertex} + 3; ++k) {
          const double length = is_rest ? double{rest[k]} : double{now[k]} - double{rest[k]};
          if (!std::isfinite(length))
            throw Error("vertex " + std::to_string(vertex.vertex) + " of region '" + region.name +
                        "' stands at no finite place");
          numbers.push_back(static_cast<int32_t>(std::lround(std::clamp(length * scale, -1e9, 1e9))));
        }
      }
    return numbers;
  }

 private:
  const Snapshot& snapshot_;
  std::vector<size_t> meshes_;
};

/// A take with its curves read.
struct LoadedTake {
  std::shared_ptr<fascia_curves> curves;
  size_t first_state = 0;
};

void play_take(const Take& take, const LoadedTake& loaded, Player& player, const Watch& watch,
               std::vector<State>& states) {
  player.begin(loaded.curves.get());
  size_t kept = 0;
  for (uint32_t frame = 0; kept < take.frames.size(); ++frame) {
    if (frame > 0)
      player.step(loaded.curves.get(), frame / take.frames_per_second, 1.0 / take.frames_per_second);
    if (frame != take.frames[kept]) continue;
    states[loaded.first_state + kept].quanta = watch.quanta(player, false);
    ++kept;
  }
}

/// Fills the states of `snapshot`: every pose and take is a job by itself, so threads change nothing.
void play(Snapshot& snapshot, const Player& first, const std::string& name,
          const std::vector<LoadedTake>& takes, int threads,
          const std::function<void(size_t, size_t)>& progress) {
  for (const std::string& state : state_names(snapshot))
    snapshot.states.push_back({state, {}});
  const Watch watch(snapshot, meshes_of(snapshot, first.meshes(), name));
  snapshot.states[0].quanta = watch.quanta(first, true);
  const size_t jobs = snapshot.poses.size() + takes.size();
  const size_t wanted = threads > 0 ? static_cast<size_t>(threads) : std::thread::hardware_concurrency();
  std::atomic<size_t> next = 0;
  size_t done = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      Player player = first.sibling();
      for (size_t job = next++; job < jobs; job = next++) {
        if (job < takes.size()) {  // the longest first
          play_take(snapshot.takes[job], takes[job], player, watch, snapshot.states);
        } else {
          const size_t pose = job - takes.size();
          player.pose(snapshot.poses[pose].values);
          snapshot.states[1 + pose].quanta = watch.quanta(player, false);
        }
        const std::lock_guard lock(mutex);
        if (progress) progress(++done, jobs);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      next = jobs;
    }
  };
  std::vector<std::thread> others;
  for (size_t t = 1; t < std::min(std::max<size_t>(wanted, 1), jobs); ++t)
    others.emplace_back(work);
  work();
  for (std::thread& thread : others)
    thread.join();
  if (failure) std::rethrow_exception(failure);
}

std::vector<LoadedTake> load(const std::vector<TakeFile>& files) {
  std::vector<LoadedTake> takes;
  for (const TakeFile& file : files)
    takes.push_back({load_curves(file.bytes, file.name), 0});
  return takes;
}

void number_states(const Snapshot& snapshot, std::vector<LoadedTake>& takes) {
  size_t at = 1 + snapshot.poses.size();
  for (size_t t = 0; t < takes.size(); ++t) {
    takes[t].first_state = at;
    at += snapshot.takes[t].frames.size();
  }
}

Take take_of(const TakeFile& file, const fascia_curves* curves, const Request& request) {
  fascia_curves_info info = {};
  info.struct_size = sizeof info;
  if (fascia_curves_get_info(curves, &info) != FASCIA_OK)
    throw Error(file.name + ": " + fascia_last_message());
  Take take;
  take.path = file.path;
  take.name = file.path.substr(file.path.find_last_of('/') + 1);
  take.hash = formats::content_hash(file.bytes);
  take.frames_per_second = request.frames_per_second;
  const double last = std::floor(info.duration * take.frames_per_second + 1e-6);
  if (last > 1e6)
    throw Error(file.name + ": the take is " + std::to_string(info.duration) +
                " s long; a snapshot plays takes of up to a million frames: cut out what matters");
  const size_t count = std::min(request.frames_kept, static_cast<size_t>(last) + 1);
  for (size_t k = 0; k < count; ++k)
    take.frames.push_back(
        static_cast<uint32_t>(count > 1 ? std::lround(last * double(k) / double(count - 1)) : 0));
  return take;
}

}  // namespace

Snapshot record(std::span<const uint8_t> rig, const std::string& name, const Request& request) {
  const Player player(rig, name, request.level);
  Snapshot snapshot;
  snapshot.rig = formats::content_hash(rig);
  snapshot.level = player.level();
  const std::vector<rig::Landmark> landmarks = rig::read(rig, name).rig.skull.landmarks;
  if (!request.kept_regions.empty() && request.regions.empty()) {
    snapshot.meshes = request.kept_meshes;
    snapshot.regions = request.kept_regions;
  } else {
    set_regions(snapshot,
                request.regions.empty()
                    ? face_regions(player.meshes(), landmarks, request.region_options)
                    : own_regions(request.regions, player.meshes(), landmarks, request.region_options),
                player.meshes());
  }
  if (snapshot.regions.empty()) throw Error(name + ": the rig moves no mesh, so there is nothing to record");
  snapshot.poses = request.poses.empty() ? player.all_poses() : request.poses;
  std::vector<LoadedTake> takes = load(request.takes);
  for (size_t t = 0; t < takes.size(); ++t)
    snapshot.takes.push_back(take_of(request.takes[t], takes[t].curves.get(), request));
  number_states(snapshot, takes);
  check_size(snapshot.vertex_count(), state_names(snapshot).size());
  play(snapshot, player, name, takes, request.threads, request.progress);
  return snapshot;
}

Snapshot replay(std::span<const uint8_t> rig, const std::string& name, const Snapshot& wanted,
                const std::vector<TakeFile>& files, int threads,
                const std::function<void(size_t done, size_t all)>& progress) {
  if (files.size() != wanted.takes.size())
    throw Error("the snapshot has " + std::to_string(wanted.takes.size()) + " takes, but " +
                std::to_string(files.size()) + " files of curves were given");
  for (size_t t = 0; t < files.size(); ++t)
    if (formats::content_hash(files[t].bytes) != wanted.takes[t].hash)
      throw Error(files[t].name + " is not the file that was recorded as take '" + wanted.takes[t].name +
                  "'; give that one with --curves, or record the snapshot anew");
  const Player player(rig, name, wanted.level);
  Snapshot snapshot = wanted;
  snapshot.states.clear();
  snapshot.rig = formats::content_hash(rig);
  std::vector<LoadedTake> takes = load(files);
  number_states(snapshot, takes);
  play(snapshot, player, name, takes, threads, progress);
  return snapshot;
}

}  // namespace fascia::snapshot

#include "app/engine/build_task.h"

#include <tbb/parallel_for.h>

#include <array>
#include <new>
#include <utility>

#include "builder/rigging/gltf_source.h"
#include "formats/files.h"
#include "geometry/error.h"
#include "rig/read/read.h"
#include "rig/write/write.h"

namespace fascia::app {

namespace {

struct Cancelled {};

/// What a stage is called in the window, and where it begins in the whole, measured on the embedded head.
struct StageShare {
  const char *name, *title;
  double begin;
};
constexpr std::array<StageShare, 12> stage_shares = {{
    {"read", "Reading the head", 0.0},
    {"head", "Looking at the head", 0.03},
    {"prepare", "Finding eyes, teeth and skin", 0.20},
    {"landmarks", "Finding landmarks", 0.22},
    {"openings", "Opening lips and lids", 0.25},
    {"skull", "Fitting the skull", 0.26},
    {"smas", "Spanning the SMAS", 0.35},
    {"muscles", "Laying the muscles", 0.42},
    {"tissue", "Weaving the tissue", 0.46},
    {"write", "Writing the rig", 0.94},
    {"load", "Loading the rig", 0.96},
    {"done", "Done", 1.0},
}};

std::string extension_of(const std::string& format) {
  return format.empty() ? ".glb" : "." + format;
}

/// The head a rig was built from, as a file: the record's own, or the rig without its extensions.
std::filesystem::path head_of(const rig::RigFile& file, const std::vector<uint8_t>& bytes,
                              const std::filesystem::path& cache) {
  std::filesystem::create_directories(cache);
  if (!file.source.bytes.empty()) {
    const std::filesystem::path head = cache / ("head" + extension_of(file.source.format));
    formats::write_bytes(head, file.source.bytes.data(), file.source.bytes.size());
    return head;
  }
  const std::filesystem::path head = cache / "head.glb";
  formats::write_bytes(head, bytes.data(), bytes.size());
  return head;
}

}  // namespace

LoadedRig load_rig(const std::filesystem::path& file, const std::filesystem::path& cache) {
  const std::vector<uint8_t> bytes = formats::read_bytes(file);
  LoadedRig loaded;
  loaded.file = file;
  const rig::RigFile read = rig::read(bytes, file.string());
  loaded.rig = std::make_shared<const rig::Rig>(read.rig);
  loaded.asset = std::make_shared<const FaceAsset>(bytes, file.string());
  view::Appearance::Options textures;
  textures.largest_texture = 1024;  // the window shows a face some 500 pixels high
  loaded.appearance =
      std::make_shared<const view::Appearance>(view::Appearance::read(bytes, file.string(), textures));
  loaded.head_to_metres = read.rig.input_to_metres.cast<double>();
  if (!cache.empty()) loaded.head = head_of(read, bytes, cache);
  return loaded;
}

BuildTask::BuildTask(BuildOrder order) : cache_(order.cache), started_(std::chrono::steady_clock::now()) {
  thread_ = std::thread([this, order = std::move(order)] { run(order); });
}

void BuildTask::run(const BuildOrder& order) {
  std::optional<LoadedRig> result;
  std::string fault;
  try {
    result = open(order);
  } catch (const Cancelled&) {
  } catch (const std::bad_alloc&) {
    fault = "out of memory: the head is too large for this machine";
  } catch (const std::exception& error) {
    fault = error.what();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  result_ = std::move(result);
  fault_ = std::move(fault);
  progress_.share = 1.0;
  progress_.is_done = true;
}

BuildTask::~BuildTask() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

void BuildTask::enter(const std::string& stage) {
  if (is_cancelled_) throw Cancelled();
  const std::lock_guard<std::mutex> lock(mutex_);
  progress_.stage = stage;
  for (const StageShare& share : stage_shares)
    if (stage == share.name) {
      progress_.stage = share.title;
      progress_.share = share.begin;
    }
}

LoadedRig BuildTask::open(const BuildOrder& order) {
  enter("read");
  if (!order.builds_anew && rig::is_rig(formats::read_bytes(order.head))) {
    enter("load");
    LoadedRig loaded = load_rig(order.head, order.cache);
    enter("done");
    return loaded;
  }
  return build(order);
}

LoadedRig BuildTask::build(const BuildOrder& order) {
  const formats::Scene scene = formats::read(order.head);
  rigging::BuildOptions options;
  options.detail = order.detail;
  if (!order.edits.empty()) options.edits = rigging::read_edits(order.edits);
  options.progress = [this](const std::string& stage) { enter(stage); };
  options.for_each = [](size_t count, const std::function<void(size_t)>& part) {
    tbb::parallel_for(size_t{0}, count, part);
  };
  const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  rigging::BuildResult built = rigging::build_rig(scene, {}, anatomy, options);
  enter("write");
  const std::vector<uint8_t> bytes =
      rig::write(rigging::gltf_source(built.opened.value_or(scene), built.report.input_to_metres), built.rig);
  std::filesystem::create_directories(order.cache);
  const std::filesystem::path output = order.cache / "rig.glb";
  formats::write_bytes(output, bytes.data(), bytes.size());
  enter("load");
  LoadedRig loaded = load_rig(output, {});
  Mat4 to_origin = Mat4::Identity();
  to_origin.topRightCorner<3, 1>() = -scene.offset;
  loaded.head = order.head;
  loaded.head_to_metres = built.report.input_to_metres * to_origin;
  built.report.warnings.insert(built.report.warnings.begin(), scene.warnings.begin(), scene.warnings.end());
  loaded.report = std::move(built.report);
  enter("done");
  return loaded;
}

BuildTask::Progress BuildTask::progress() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Progress now = progress_;
  now.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  return now;
}

std::optional<LoadedRig> BuildTask::take_result() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(result_, std::nullopt);
}

std::string BuildTask::fault() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return fault_;
}

}  // namespace fascia::app

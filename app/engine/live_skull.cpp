#include "app/engine/live_skull.h"

#include <array>
#include <exception>
#include <limits>
#include <optional>
#include <utility>

#include "anatomy/anatomy.h"
#include "builder/skull/fitter.h"
#include "builder/skull/from_anatomy.h"

namespace fascia::app {

namespace {

/// The asset's parts of one kind at rest, vertices at one place joined.
TriangleMesh joined_part(const FaceAsset& asset, const std::string& kind) {
  TriangleMesh mesh;
  std::map<std::array<float, 3>, int> known;
  for (const FacePart& part : asset.parts) {
    if (part.part != kind) continue;
    std::vector<int> index;
    for (size_t i = 0; i + 2 < part.rest.size(); i += 3) {
      const auto [entry, is_new] =
          known.try_emplace({part.rest[i], part.rest[i + 1], part.rest[i + 2]}, mesh.vertex_count());
      if (is_new) mesh.vertices.emplace_back(part.rest[i], part.rest[i + 1], part.rest[i + 2]);
      index.push_back(entry->second);
    }
    for (Triangle t : part.triangles) {
      for (int& corner : t)
        corner = index[static_cast<size_t>(corner)];
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

/// For each vertex of a rig's bone the one of the fit that it is, or that is nearest.
std::vector<size_t> partners(const std::vector<rig::Vec3f>& bone, const std::vector<Vec3>& fitted) {
  std::vector<size_t> found(bone.size(), 0);
  for (size_t v = 0; v < bone.size(); ++v) {
    if (bone.size() == fitted.size()) {
      found[v] = v;
      continue;
    }
    double least = std::numeric_limits<double>::max();
    for (size_t w = 0; w < fitted.size(); ++w)
      if (const double d = (fitted[w] - bone[v].cast<double>()).squaredNorm(); d < least) {
        least = d;
        found[v] = w;
      }
  }
  return found;
}

}  // namespace

HeadMeshes head_meshes(const FaceAsset& asset) {
  return {joined_part(asset, "skin"), joined_part(asset, "teeth_upper"), joined_part(asset, "teeth_lower")};
}

/// The fitter with where its landmarks and bones were at first.
class LiveSkull::Fit {
 public:
  Fit(const rig::Rig& rig, const HeadMeshes& head) {
    std::map<std::string, skull::TargetLandmark> targets;
    for (const rig::Landmark& landmark : rig.skull.landmarks)
      targets[landmark.name] = {landmark.skin.cast<double>(), static_cast<double>(landmark.confidence)};
    skull::FitOptions options;
    if (!head.teeth_upper.empty()) options.teeth_upper = &head.teeth_upper;
    if (!head.teeth_lower.empty()) options.teeth_lower = &head.teeth_lower;
    fitter_.emplace(skull::from_anatomy(anatomy::load_generic()), skull::exterior(head.skin), targets,
                    options);
    for (const skull::FittedLandmark& landmark : fitter_->result().landmarks)
      built_[landmark.name] = landmark.skin;
    now_ = built_;
    const skull::FitResult& first = fitter_->result();
    const rig::Skull& bones = rig.skull;
    for (const auto& [bone, surface] :
         {std::pair(&bones.cranium, &first.cranium), std::pair(&bones.mandible, &first.mandible),
          std::pair(&bones.teeth_upper, &first.teeth_upper),
          std::pair(&bones.teeth_lower, &first.teeth_lower)}) {
      first_.push_back(surface->vertices);
      partners_.push_back(partners(bone->positions, surface->vertices));
    }
  }

  /// Moves what is not where it is wanted. Throws as the fitter does.
  SkullShift shift_for(const Landmarks& moved) {
    for (auto& [name, place] : now_) {
      const auto wanted = moved.find(name);
      const Vec3& to = wanted == moved.end() ? built_.at(name) : wanted->second;
      if (to == place) continue;
      fitter_->move_landmark(name, to);
      place = to;
    }
    const skull::FitResult& result = fitter_->result();
    return {difference(0, result.cranium), difference(1, result.mandible), difference(2, result.teeth_upper),
            difference(3, result.teeth_lower)};
  }

 private:
  std::vector<Vec3> difference(size_t bone, const TriangleMesh& now) const {
    std::vector<Vec3> all;
    if (now.vertices.size() != first_[bone].size() || now.vertices.empty()) return all;
    for (const size_t v : partners_[bone])
      all.push_back(now.vertices[v] - first_[bone][v]);
    return all;
  }

  std::optional<skull::Fitter> fitter_;
  Landmarks built_, now_;
  std::vector<std::vector<Vec3>> first_;
  std::vector<std::vector<size_t>> partners_;
};

LiveSkull::LiveSkull(std::shared_ptr<const rig::Rig> rig, std::function<HeadMeshes()> head, Pace pace)
    : rig_(std::move(rig)), head_(std::move(head)), pace_(pace) {
  if (pace_ == Pace::background) thread_ = std::thread([this] { run(); });
}

LiveSkull::~LiveSkull() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void LiveSkull::submit(const Landmarks& moved) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (moved == wanted_) return;
    wanted_ = moved;
    has_news_ = true;
  }
  if (pace_ == Pace::at_once) return follow(moved);
  wake_.notify_all();
}

std::shared_ptr<const SkullShift> LiveSkull::shift() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return shift_;
}

void LiveSkull::follow(const Landmarks& moved) {
  std::shared_ptr<const SkullShift> shift;
  try {
    if (!fit_) fit_ = std::make_unique<Fit>(*rig_, head_());
    if (!moved.empty()) shift = std::make_shared<const SkullShift>(fit_->shift_for(moved));
  } catch (const std::exception&) {
    // A head that no skull fits at once is shown as it was built, until it is built again.
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  shift_ = std::move(shift);
}

void LiveSkull::run() {
  follow({});
  for (;;) {
    Landmarks moved;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [this] { return has_news_ || ends_; });
      if (ends_) return;
      has_news_ = false;
      moved = wanted_;
    }
    follow(moved);
  }
}

}  // namespace fascia::app

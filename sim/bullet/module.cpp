#include "sim/bullet/bullet_face.h"

/// The entry of libfascia_bullet (see sim/solver.h). Nothing thrown leaves it.
extern "C" __attribute__((visibility("default"))) fascia::sim::Solver* fascia_make_solver(
    const fascia::sim::FaceModel* model, size_t channels) {
  if (model == nullptr || !model->valid()) return nullptr;
  try {
    return new fascia::sim::BulletFace(*model, channels);
  } catch (...) {
    return nullptr;
  }
}

#include "bench/sim/bullet_sheet.h"

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <vector>

namespace fascia::bench {

struct BulletSheet::World {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::unique_ptr<btSoftBody> body;
  int substeps = 1;
};

BulletSheet::BulletSheet(int n, double spacing, int substeps, int iterations)
    : world_(std::make_unique<World>()) {
  World& w = *world_;
  w.substeps = substeps;
  w.world.setGravity(btVector3(0, btScalar(-9.81), 0));
  btSoftBodyWorldInfo& info = w.world.getWorldInfo();
  info.m_gravity = btVector3(0, btScalar(-9.81), 0);
  info.air_density = 0;
  info.water_density = 0;
  info.m_sparsesdf.Initialize();
  std::vector<btVector3> places;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column)
      places.emplace_back(static_cast<btScalar>(column * spacing), btScalar(0),
                          static_cast<btScalar>(row * spacing));
  const std::vector<btScalar> masses(places.size(), btScalar(1e-4));
  w.body = std::make_unique<btSoftBody>(&info, n * n, places.data(), masses.data());
  const int ways[6][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {0, 2}, {2, 0}};
  for (const auto& way : ways)
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column) {
        const int r = row + way[0], c = column + way[1];
        if (r < n && c >= 0 && c < n) w.body->appendLink(row * n + column, r * n + c);
      }
  for (int column = 0; column < n; ++column)
    w.body->setMass(column, 0);
  w.body->m_cfg.piterations = iterations;
  w.body->m_cfg.collisions = 0;
  w.body->m_cfg.kDP = 0;
  w.world.addSoftBody(w.body.get());
}

BulletSheet::~BulletSheet() {
  world_->world.removeSoftBody(world_->body.get());
}

void BulletSheet::step(double seconds) {
  world_->world.stepSimulation(static_cast<btScalar>(seconds), world_->substeps,
                               static_cast<btScalar>(seconds / world_->substeps));
}

double BulletSheet::mean_stretch() const {
  const auto& links = world_->body->m_links;
  double sum = 0.0;
  for (int i = 0; i < links.size(); ++i)
    sum += std::abs((links[i].m_n[1]->m_x - links[i].m_n[0]->m_x).length() / links[i].m_rl - 1.0);
  return sum / links.size();
}

}  // namespace fascia::bench

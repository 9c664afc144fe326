#include "sim/bullet/bullet_face.h"

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>

namespace fascia::sim {
namespace {

btVector3 to_bullet(const Vec3& v, double scale) {
  return {static_cast<btScalar>(scale * v.x()), static_cast<btScalar>(scale * v.y()),
          static_cast<btScalar>(scale * v.z())};
}

Vec3 from_bullet(const btVector3& v, double scale) {
  return Vec3(v.x(), v.y(), v.z()) / scale;
}

btTransform to_bullet(const RigidTransform& t, double scale) {
  const Mat3& r = t.rotation;
  const btMatrix3x3 basis(
      static_cast<btScalar>(r(0, 0)), static_cast<btScalar>(r(0, 1)), static_cast<btScalar>(r(0, 2)),
      static_cast<btScalar>(r(1, 0)), static_cast<btScalar>(r(1, 1)), static_cast<btScalar>(r(1, 2)),
      static_cast<btScalar>(r(2, 0)), static_cast<btScalar>(r(2, 1)), static_cast<btScalar>(r(2, 2)));
  return btTransform(basis, to_bullet(t.translation, scale));
}

}  // namespace

struct BulletFace::World {
  const FaceModel& model;
  BulletOptions options;
  Frame frame;
  Positions state, forces;
  std::vector<double> masses;
  std::vector<float> activations, rest_excitations;
  double left_over = 0.0;

  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  btSoftRigidDynamicsWorld dynamics{&dispatcher, &broadphase, &constraints, &configuration};
  btSphereShape bone{1.0F};
  std::unique_ptr<btRigidBody> head, jaw;
  std::unique_ptr<btGeneric6DofSpring2Constraint> joint;
  btSoftBody* tissue = nullptr;  // the world's list holds it, we delete it
  btTransform condyles;          // the joint's frame at rest

  World(const FaceModel& m, size_t channels, const BulletOptions& o)
      : model(m),
        options(o),
        frame(m.make_frame()),
        state(m.rest()),
        forces(m.rest().size()),
        activations(channels),
        rest_excitations(channels) {
    dynamics.setGravity(btVector3(0, 0, 0));
    dynamics.getWorldInfo().m_gravity.setZero();
    make_bones();
    make_tissue();
  }
  ~World() {
    dynamics.removeConstraint(joint.get());
    dynamics.removeSoftBody(tissue);
    dynamics.removeRigidBody(jaw.get());
    dynamics.removeRigidBody(head.get());
    delete tissue;
  }

  void make_bones() {
    head = std::make_unique<btRigidBody>(0.0F, nullptr, &bone);
    jaw = std::make_unique<btRigidBody>(0.12F, nullptr, &bone, btVector3(1, 1, 1));
    jaw->setActivationState(DISABLE_DEACTIVATION);
    // Bones do not collide here: their surfaces act through the lattice's own nodes.
    dynamics.addRigidBody(head.get(), 0, 0);
    dynamics.addRigidBody(jaw.get(), 0, 0);
    condyles.setIdentity();
    condyles.setOrigin(to_bullet(model.jaw().origin, options.length_scale));
    joint = std::make_unique<btGeneric6DofSpring2Constraint>(*head, *jaw, condyles, condyles);
    for (int axis = 0; axis < 6; ++axis) {
      joint->setLimit(axis, 0, 0);
      joint->setParam(BT_CONSTRAINT_STOP_ERP, btScalar(0.8), axis);
    }
    dynamics.addConstraint(joint.get(), true);
  }

  /// Explicit steps hold while h^2 k < 4 m (Courant, Friedrichs & Lewy 1928): nodes stiffer than their mass
  /// allows are made heavier, as explicit finite elements do. Where a face comes to rest is the same.
  void weigh() {
    const double h = options.substep,
                 contact = model.options().contact.globe_stiffness + model.options().contact.facing_stiffness;
    const auto& unknowns = model.unknowns();
    masses = model.masses();
    for (size_t i = 0; i < unknowns.size(); ++i) {
      double stiffness = contact;
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(model.stiffness(),
                                                                         static_cast<int>(i));
           e; ++e)
        stiffness += std::abs(e.value());
      masses[unknowns[i]] = std::max(masses[unknowns[i]], 30.0 * h * h * stiffness);
    }
  }

  void make_tissue() {
    weigh();
    const double s = options.length_scale, h = options.substep;
    std::vector<btVector3> places;
    std::vector<btScalar> weights;
    for (size_t i = 0; i < state.size(); ++i) {
      places.push_back(to_bullet(state[i], s));
      weights.push_back(model.prescribed(i) ? btScalar(0) : static_cast<btScalar>(masses[i]));
    }
    tissue = new btSoftBody(&dynamics.getWorldInfo(), static_cast<int>(places.size()), places.data(),
                            weights.data());
    const auto inverse = [&](uint32_t i) { return model.prescribed(i) ? 0.0 : 1.0 / masses[i]; };
    for (const Spring& spring : model.springs()) {
      const double w = inverse(spring.nodes[0]) + inverse(spring.nodes[1]);
      if (spring.one_sided || w == 0.0 || spring.stiffness == 0.0 || spring.length < 1e-9) continue;
      // One projection of a link by this share moves it as its stiffness would in one implicit step:
      // the compliance of XPBD (Macklin, Mueller & Chentanez 2016, eq. 18) folded into Bullet's factor.
      const double stiff = w * spring.stiffness * h * h;
      btSoftBody::Material* material = tissue->appendMaterial();
      material->m_kLST = static_cast<btScalar>(stiff / (1.0 + stiff));
      tissue->appendLink(static_cast<int>(spring.nodes[0]), static_cast<int>(spring.nodes[1]), material);
    }
    tissue
        ->updateConstants();  // now, at rest: Bullet would take its rest lengths from the first pose it steps
    tissue->m_bUpdateRtCst = false;
    tissue->m_cfg.piterations = 1;
    tissue->m_cfg.viterations = 0;
    tissue->m_cfg.citerations = 0;
    tissue->m_cfg.collisions = 0;
    tissue->m_cfg.kDP = static_cast<btScalar>(options.damping);
    tissue->getCollisionShape()->setMargin(btScalar(0.01));
    dynamics.addSoftBody(tissue, 0, 0);
    tissue->setActivationState(DISABLE_DEACTIVATION);
  }

  RigidTransform mandible() const {
    const btTransform& t = jaw->getCenterOfMassTransform();
    RigidTransform result;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        result.rotation(r, c) = t.getBasis()[r][c];
    result.translation = from_bullet(t.getOrigin(), options.length_scale);
    return result;
  }

  void read_state() {
    for (size_t i = 0; i < state.size(); ++i)
      if (!model.prescribed(i))
        state[i] = from_bullet(tissue->m_nodes[static_cast<int>(i)].m_x, options.length_scale);
  }

  /// Puts nodes without mass where their bones are; on the mandible itself, where Bullet's mandible is.
  void carry_nodes() {
    const RigidTransform bone_motion = mandible();
    const bool still = frame.carried == model.rest();
    for (size_t i = 0; i < state.size(); ++i) {
      if (!model.prescribed(i)) continue;
      const bool on_jaw = static_cast<NodeKind>(model.lattice().kinds[i]) == NodeKind::fixed_mandible &&
                          model.lattice().jaw_weights[i] == 1.0F;
      state[i] = on_jaw && !still ? bone_motion * model.rest()[i] : frame.carried[i];
      btSoftBody::Node& node = tissue->m_nodes[static_cast<int>(i)];
      node.m_x = node.m_q = to_bullet(state[i], options.length_scale);
      node.m_v.setZero();
    }
  }

  /// A link's pull is l (l^2 - r^2) / (l^2 + r^2) times its stiffness, a spring's only while l is near its
  /// rest length r: what is missing to l - r comes as a force.
  void add_link_corrections() {
    for (const Spring& spring : model.springs()) {
      if (spring.one_sided || spring.stiffness == 0.0) continue;
      const Vec3 along = state[spring.nodes[1]] - state[spring.nodes[0]];
      const double length = along.norm(), rest = spring.length;
      if (length < 1e-9) continue;
      const double squares = length * length + rest * rest;
      const double missing = length - rest - length * (length * length - rest * rest) / squares;
      const Vec3 pull = (spring.stiffness * missing / length) * along;
      forces[spring.nodes[0]] -= pull;
      forces[spring.nodes[1]] += pull;
    }
  }

  unsigned substeps = 0;

  void substep(const Controls& controls) {
    const double s = options.length_scale;
    model.place({activations, controls.jaw, controls.acceleration, controls.touches}, frame);
    if (substeps++ % 20 == 0)
      model.find_facing(state.data(), frame);  // contact pairs hardly change within 20 substeps
    joint->setFrames(to_bullet(jaw_transform(model.jaw(), clamped(controls.jaw)), s) * condyles, condyles);
    carry_nodes();
    model.energy_beside_links(frame, state.data(), forces.data());
    add_link_corrections();
    for (const uint32_t i : model.unknowns()) {
      // Forces are capped at 0.2 mm displacement per substep: larger ones come from inverted elements.
      const double most = 2e-4 * masses[i] / (options.substep * options.substep), size = forces[i].norm();
      tissue->m_nodes[static_cast<int>(i)].m_f +=
          to_bullet(-(size > most ? most / size : 1.0) * forces[i], s);
    }
    const auto h = static_cast<btScalar>(options.substep);
    dynamics.stepSimulation(h, 1, h);
    read_state();
  }

  bool sound() const {
    for (size_t i = 0; i < state.size(); ++i)
      if (!((state[i] - frame.carried[i]).norm() < 0.15)) return false;
    return true;
  }

  double fastest() const {
    double most = 0.0;
    for (int i = 0; i < tissue->m_nodes.size(); ++i)
      most =
          std::max<double>(most, static_cast<double>(tissue->m_nodes[i].m_v.length()) / options.length_scale);
    return most;
  }

  void put(const Positions& where, const Controls& controls) {
    const RigidTransform t = jaw_transform(model.jaw(), clamped(controls.jaw));
    jaw->setCenterOfMassTransform(to_bullet(t, options.length_scale));
    jaw->setLinearVelocity(btVector3(0, 0, 0));
    jaw->setAngularVelocity(btVector3(0, 0, 0));
    state = where;
    for (size_t i = 0; i < state.size(); ++i) {
      btSoftBody::Node& node = tissue->m_nodes[static_cast<int>(i)];
      node.m_x = node.m_q = to_bullet(state[i], options.length_scale);
      node.m_v.setZero();
      node.m_f.setZero();
    }
  }
};

BulletFace::BulletFace(const FaceModel& model, size_t channels, const BulletOptions& options)
    : world_(std::make_unique<World>(model, channels, options)) {}

BulletFace::~BulletFace() = default;

RigidTransform BulletFace::mandible() const {
  return world_->mandible();
}

void BulletFace::reset(const Controls& controls) {
  World& w = *world_;
  std::fill(w.activations.begin(), w.activations.end(), 0.0F);
  w.model.place({{}, controls.jaw, Vec3::Zero()}, w.frame);
  w.put(w.frame.carried, controls);
  w.left_over = 0.0;
}

StepResult BulletFace::step(double seconds, const Controls& controls) {
  World& w = *world_;
  StepResult result;
  bool finite = std::isfinite(seconds) && controls.acceleration.allFinite();
  for (const float a : controls.activations)
    finite = finite && std::isfinite(a);
  if (!finite) {
    reset({{}, controls.jaw, Vec3::Zero()});
    result.status = StepStatus::reset;
    return result;
  }
  const double due = w.left_over + std::clamp(seconds, 0.0, longest_frame());
  const int substeps = static_cast<int>(due / w.options.substep + 1e-9);
  for (int k = 0; k < substeps; ++k) {
    follow({}, w.options.substep, controls.activations, w.activations);
    w.substep(controls);
  }
  w.left_over = std::max(0.0, due - substeps * w.options.substep);
  result.substeps = substeps;
  if (!w.sound()) {
    reset(controls);
    result.status = StepStatus::reset;
  }
  return result;
}

MinimiseResult BulletFace::settle(const Controls& controls) {
  World& w = *world_;
  MinimiseResult result;
  reset(controls);
  for (size_t c = 0; c < w.activations.size(); ++c)
    w.activations[c] = controls.activation(c);
  const int most = static_cast<int>(w.options.settle_seconds / w.options.substep);
  for (int k = 0; k < most && !result.converged; ++k) {
    w.substep(controls);
    result.iterations = k + 1;
    result.converged = k > 60 && w.fastest() < w.options.settle_speed;
  }
  result.move = w.fastest() * w.options.substep;
  if (!w.sound())
    reset(controls);
  else
    w.put(Positions(w.state), controls);  // where it has come to, without velocity
  return result;
}

void BulletFace::displacements(std::span<Vec3f> out) const {
  for (size_t i = 0; i < out.size() && i < world_->state.size(); ++i)
    out[i] = (world_->state[i] - world_->model.rest()[i]).cast<float>();
}

}  // namespace fascia::sim

#pragma once

#include <Eigen/Core>

#include "sim/face_model.h"

namespace fascia::sim {

/// A symmetric strain in the head's frame at rest: xx, yy, zz, xy, yz, zx.
using Strain = Eigen::Matrix<float, 6, 1>;

/// Green strain of the skin layer under `displacements` (#nodes), averaged at each column by area; `out` is
/// #columns. Exactly zero at rest.
void skin_strain(const FaceModel& model, std::span<const Vec3f> displacements, std::span<Strain> out);

/// The largest compression of a strain: its direction (unit, its sign chosen so that its largest component is
/// positive) times 1 minus the stretch along it. Zero without compression.
Vec3f strongest_compression(const Strain& strain);

}  // namespace fascia::sim

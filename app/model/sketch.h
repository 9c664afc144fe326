#pragma once

#include <string>
#include <vector>

#include "app/model/document.h"

/// Regions of muscles drawn on the skin.
namespace fascia::app {

/// The end of a muscle that a region is drawn for; the strings are the keys of its entry in an edits file.
enum class MuscleEnd { origin, insertion };
const char* name_of(MuscleEnd end);

/// From the axes and units of the edits' points ("units" in their file; as in the head file without) to
/// metres. Units that the builder refuses count as none.
Mat4 edits_to_metres(const DocumentState& state, const Mat4& head_to_metres);

/// The curve drawn for a muscle's end, metres at rest; empty when there is none. `head_to_metres` as in
/// LoadedRig.
std::vector<Vec3> muscle_sketch(const DocumentState& state, const std::string& muscle, MuscleEnd end,
                                const Mat4& head_to_metres);
/// Sets it, in the axes and units of the edits; an empty one is taken out.
void set_muscle_sketch(DocumentState& state, const std::string& muscle, MuscleEnd end,
                       const std::vector<Vec3>& curve, const Mat4& head_to_metres);
/// How many regions are drawn for all muscles.
size_t count_sketches(const DocumentState& state);

/// A stroke of the mouse as a closed curve of points at even distances, 2 mm where 64 points are enough: a
/// hand that ends beyond its beginning is cut where the ends meet. A stroke of fewer than three points stays
/// as it is.
std::vector<Vec3> closed_curve(const std::vector<Vec3>& stroke);

/// Why the builder would refuse the curve (metres); empty: it would not.
std::string sketch_fault(const std::vector<Vec3>& curve);

}  // namespace fascia::app

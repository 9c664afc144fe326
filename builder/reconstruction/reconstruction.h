#pragma once

// Craniofacial approximation: skin from a skull, the inverse of fitting a skull under a skin.
//
// This work is based on:
// O. Aina. Generating Anatomical Substructures for Physically-Based Facial Animation, sec. 8.1. 2011
// C. Stephan, E. Simpson. Facial soft tissue depths in craniofacial identification, part I. 2008
// D. Vandermeulen et al. Computerized craniofacial reconstruction using CT-derived implicit surface
// representations. 2006

#include <map>
#include <string>
#include <vector>

#include "builder/reconstruction/soft_tissue.h"
#include "geometry/landmarks.h"

namespace fascia::reconstruction {

struct Options {
  double metres = 0.0;        ///< a unit of the scan; 0: by the skull's size
  std::string table;          ///< name of a tissue depth table; empty: the default one
  double tissue_scale = 1.0;  ///< scales every depth
  Landmarks bone;             ///< landmarks on the scan's bone, its own axes and units
};

/// A head over a skull. Coordinates are the scan's own.
struct Result {
  double metres = 0.0;               ///< a unit of the scan's length
  landmarks::Placement placement;    ///< generic head -> scan, before it is bent
  skull::BoneMap mean, thin, thick;  ///< generic head -> its own frame; one standard deviation less and more
  std::vector<SkinOverBone> landmarks;
  double bone_residual = 0.0;  ///< mean distance of the registered generic skull from the scan, metres
  double covered_share = 0.0;  ///< of the generic skull's outer surface that the scan has
  std::vector<std::string> warnings;

  /// Points of the generic head, metres, on the mean head.
  std::vector<Vec3> place(const skull::BoneMap& map, std::span<const Vec3> generic) const;
};

/// Reconstructs skin over the skull `scan`. Throws fascia::Error when no skull is found in it, an option is
/// out of range, or the table is not known.
Result reconstruct(const anatomy::GenericAnatomy& anatomy, const TriangleMesh& scan,
                   const Options& options = {});

/// Known attributes of the person; empty: unknown.
struct Person {
  std::string sex, age, ancestry;  ///< female or male; a table's own words for the others, such as adult
};

/// The tissue depth table of the people nearest to `person`: the one that agrees with most of what is known
/// and contradicts none of it; the default one first. A line in `warnings` for what no table tells apart.
std::string nearest_table(const anatomy::GenericAnatomy& anatomy, const Person& person,
                          std::vector<std::string>& warnings);

/// Metres a unit of `scan` is, by the size that skulls have. Throws fascia::Error when it is none of m, cm,
/// mm and inch.
double guess_unit(const TriangleMesh& scan);

}  // namespace fascia::reconstruction

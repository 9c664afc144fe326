#pragma once

#include <vector>

#include "fit/fit.h"

namespace fascia::fit {

struct ScanOptions {
  int rounds = 8;             ///< closest points anew, so often
  bool moves_head = true;     ///< the scan is brought onto the head along with the fit
  double reach = 0.02;        ///< metres: farther points of the scan are nobody's in the first round...
  double last_reach = 0.005;  ///< ...and in the last
  int samples = 4000;         ///< vertices matched, at most
};

struct ScanFit {
  Target target;     ///< the last round's matches
  FitResult result;  ///< its share, error and rms are of distances from the scan's surface
  Mat4 scan_to_head = Mat4::Identity();  ///< rigid motion of the scan onto the rig's head
  std::vector<double>
      distance;  ///< #vertices, metres across the scan's surface; not a number where not matched
  double matched_share = 0.0;  ///< of the outer skin's vertices, those that met the scan
};

/// Fits a face to a scan of any topology: rounds of closest points that face the same way, a head pose by
/// point to plane (Chen & Medioni 1992), and Gauss-Newton steps in which matched vertices slide over the
/// scan. Matches are weighted by Tukey's biweight of their distance; the edge of the scan attracts nothing.
///
/// `scan`: metres, rig frame, about where the head is (a few centimetres and some 20 degrees off at most),
/// normals outward. Throws fascia::Error when hardly anything of it lies near the head.
ScanFit fit_scan(Subject& subject, const TriangleMesh& scan, const FitOptions& fitting = {},
                 const ScanOptions& options = {});

}  // namespace fascia::fit

#pragma once

#include <string>
#include <vector>

namespace fascia::bench {

/// What an actuator alone at 1 ought to do: which landmark it moves, which way, and how far. The left side
/// stands for both; `right`-ward counterparts mirror it. Directions are (lateral, up, forward) of the
/// subject's left; travels millimetres.
struct Expectation {
  std::string actuator;  ///< without side; after "both:" both sides at once
  double value;          ///< it is set to
  std::string landmark;  ///< full name
  double direction[3];   ///< unit or not; the travel is measured along it
  double least, most;    ///< of the travel along it
};

/// The actions of the mimic muscles after Gray's Anatomy and FACS; travels after measured faces where there
/// are any (corner of the mouth 6..14 mm in a smile: Flynn 2015; brows some 5..10 mm: Price 2009), else
/// estimates.
const std::vector<Expectation>& expectations();

}  // namespace fascia::bench

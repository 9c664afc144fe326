#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/expressions/sculpted_head.h"

namespace fascia::identify {

struct ResponseOptions {
  std::vector<double> weights = {0.1, 0.25, 0.5, 0.75};  ///< at which rows say their response
  double tolerance = 0.004;                              ///< of the share of the way, where a search ends
  double least_mm = 0.2;  ///< a shape that moves nothing as far as this keeps the weight itself
  int most_rounds = 12;   ///< of a search
  int threads = 2;
};

/// Finds for each row of the tables in `folder` (expressions/*.json) what share of it to play at each weight
/// so that `heads` show that weight of the shape, and writes it into the tables. What a head shows is the
/// displacement of its skin projected onto that at weight 1; a corrective's is what it adds to the shape that
/// it corrects. Heads that differ are served by their median: a
/// lip that snaps on one of them bends nobody else's curve. Rows that are equal,
/// or each other's mirror image, share their response; rows that turn an eye have none. Prints a line a row
/// with the largest distance of a head from its weight that is left. Throws fascia::Error when a head cannot
/// be built or a row names an actuator that a rig has not.
void identify_responses(const std::filesystem::path& folder, const std::vector<bench::SculptedHead>& heads,
                        const std::string& level, const ResponseOptions& options);

}  // namespace fascia::identify

#include "snapshot/junit.h"

#include <cstdio>
#include <map>

#include "geometry/text.h"

namespace fascia::snapshot {

std::string sentence(const Snapshot& then, const Difference& difference, double tolerance_mm) {
  char numbers[160];
  std::snprintf(numbers, sizeof numbers,
                ": %.3f mm on average, %.3f mm at vertex %u of mesh %u; %g mm allowed", difference.mean_mm,
                difference.largest_mm, difference.vertex.vertex, then.meshes[difference.vertex.mesh].mesh,
                tolerance_mm > 0.0 ? tolerance_mm : then.regions[difference.region].tolerance_mm);
  return then.regions[difference.region].name + numbers;
}

std::string junit(const Snapshot& then, const Comparison& comparison, const std::string& suite,
                  double tolerance_mm) {
  std::map<size_t, std::string> failures;
  for (const Difference& difference : comparison.differences)
    if (!difference.ok) failures[difference.state] += sentence(then, difference, tolerance_mm) + "\n";
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n <testsuite name=\"" +
                     escaped_markup(suite) + "\" tests=\"" + std::to_string(then.states.size()) +
                     "\" failures=\"" + std::to_string(failures.size()) + "\" errors=\"0\">\n";
  for (size_t s = 0; s < then.states.size(); ++s) {
    text += "  <testcase classname=\"" + escaped_markup(suite) + "\" name=\"" +
            escaped_markup(then.states[s].name) + "\"";
    if (const auto found = failures.find(s); found != failures.end())
      text += ">\n   <failure message=\"the face moves otherwise than in the snapshot\">" +
              escaped_markup(found->second) + "</failure>\n  </testcase>\n";
    else
      text += "/>\n";
  }
  return text + " </testsuite>\n</testsuites>\n";
}

}  // namespace fascia::snapshot

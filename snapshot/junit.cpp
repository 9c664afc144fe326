#include "snapshot/junit.h"

#include <cstdio>
#include <map>

namespace fascia::snapshot {

namespace {

/// Text in XML: what XML 1.0 has no place for becomes '?'.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t' ? '?' : c;
  }
  return out;
}

}  // namespace

std::string sentence(const Snapshot& then, const Difference& difference, double tolerance_mm) {
  char numbers[160];
  std::snprintf(numbers, sizeof numbers,
                ": %.3f mm on average, %.3f mm at vertex %u of mesh %u; %g mm allowed", difference.mean_mm,
                difference.largest_mm, difference.vertex.vertex, then.meshes[difference.vertex.mesh].mesh,
                tolerance_mm > 0.0 ? tolerance_mm : then.regions[difference.region].tolerance_mm);
  return then.regions[difference.region].name + numbers;
}

std::string junit(const Snapshot& then, const Comparison& comparison, const std::string& suite) {
  std::map<size_t, std::string> failures;
  for (const Difference& difference : comparison.differences)
    if (!difference.ok) failures[difference.state] += sentence(then, difference) + "\n";
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n <testsuite name=\"" +
                     escaped(suite) + "\" tests=\"" + std::to_string(then.states.size()) + "\" failures=\"" +
                     std::to_string(failures.size()) + "\" errors=\"0\">\n";
  for (size_t s = 0; s < then.states.size(); ++s) {
    text += "  <testcase classname=\"" + escaped(suite) + "\" name=\"" + escaped(then.states[s].name) + "\"";
    if (const auto found = failures.find(s); found != failures.end())
      text += ">\n   <failure message=\"the face moves otherwise than in the snapshot\">" +
              escaped(found->second) + "</failure>\n  </testcase>\n";
    else
      text += "/>\n";
  }
  return text + " </testsuite>\n</testsuites>\n";
}

}  // namespace fascia::snapshot

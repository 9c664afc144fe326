#include "cli/version.h"

#include <embree3/rtcore_config.h>
#include <meshoptimizer.h>
#include <tbb/version.h>
#include <zlib.h>

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "sim/lanes/instruction_set.h"

namespace fascia::cli {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string vector_unit() {
  switch (sim::lanes::instruction_set()) {
    case sim::lanes::InstructionSet::avx512:
      return "AVX-512";
    case sim::lanes::InstructionSet::avx2:
      return "AVX2";
    case sim::lanes::InstructionSet::baseline:
      break;
  }
  return "baseline";
}

std::string libraries() {
  return "Eigen " + dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION) + ", oneTBB " +
         TBB_runtime_version() + ", Embree " RTC_VERSION_STRING ", nlohmann-json " +
         dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH) +
         ", CLI11 " CLI11_VERSION ", meshoptimizer " + std::to_string(MESHOPTIMIZER_VERSION / 1000) + "." +
         std::to_string(MESHOPTIMIZER_VERSION / 10 % 100) + ", zlib " + zlibVersion();
}

}  // namespace

std::string version_text() {
  std::string text = "fascia " FASCIA_VERSION_TEXT;
  text += "\ncommit:      " FASCIA_COMMIT;
  text += "\ncompiler:    " FASCIA_COMPILER;
  text += "\nbuild:       " FASCIA_BUILD_FACTS;
  text += "\nvector unit: " + vector_unit();
  text += "\nlibraries:   " + libraries();
  return text;
}

}  // namespace fascia::cli

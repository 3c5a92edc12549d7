// SPDX-License-Identifier: BSD-3-Clause
#include "version_text.hpp"

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "built_without.hpp"
#include "holdfast/core/simd.hpp"
#include "holdfast/core/version.hpp"
#include "holdfast/run/results.hpp"

namespace holdfast {

namespace {

std::string dotted(int major_number, int minor_number, int patch) {
  return std::to_string(major_number) + "." + std::to_string(minor_number) + "." + std::to_string(patch);
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

}  // namespace

std::string version_text() {
  std::string text = "holdfast " HOLDFAST_VERSION "\n";
  text += "commit     " + std::string(build_commit()) + "\n";
  text += "compiler   " + compiler() + "\n";
  text += "libraries  Eigen " + dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION) + ", OpenCV " +
          cv::getVersionString() + HOLDFAST_LIBRARY_VERSIONS ", nlohmann-json " +
          dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH) + "\n";
  text += std::string("SIMD       ") + to_string(simd_level());
  for (const std::string& part : built_without()) text += "\nwithout    " + part;
  return text;
}

}  // namespace holdfast

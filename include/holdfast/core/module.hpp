// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Base class of all interfaces that a plugin can implement (interfaces/*.hpp).
class Module {
 public:
  virtual ~Module() = default;
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

 protected:
  Module() = default;
};

/// Information about the run that a module receives on construction, in addition to its settings.
struct CreationContext {
  Camera camera = {};                           ///< camera of the run
  std::uint64_t seed = 1;                       ///< the only seed of the run; derive a module's own with Random::fork
  bool sequential = true;                       ///< if true, results must be bit-identical from run to run
  std::filesystem::path output_directory = {};  ///< for observers that write files; empty if nothing is written
  /// Class names of the source's FrameTruth::class_labels, by index; empty if the source has none, and for the source
  /// itself.
  std::vector<std::string> class_names = {};
};

}  // namespace holdfast

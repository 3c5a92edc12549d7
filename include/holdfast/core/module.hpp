// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Base of everything that a plugin provides (interfaces/*.hpp).
class Module {
 public:
  virtual ~Module() = default;
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

 protected:
  Module() = default;
};

/// What a module is told when it is made, beside its own settings.
struct CreationContext {
  Camera camera = {};                           ///< of the run
  std::uint64_t seed = 1;                       ///< the run's only seed; derive your own with Random::fork
  bool sequential = true;                       ///< results must be bit-identical from run to run
  std::filesystem::path output_directory = {};  ///< for observers that write files; empty when nothing is written
  /// Of the source's FrameTruth::class_labels, by index; empty when the source knows none, and for the source itself.
  std::vector<std::string> class_names = {};
};

}  // namespace holdfast

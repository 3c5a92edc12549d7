// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/inference/model_metadata.hpp"
#include "holdfast/settings/onnx.hpp"

namespace holdfast::onnx_plugin {

/// The classes of a network for objects. The network's class k has the label k + 1; label 0 is the background.
struct ObjectClasses {
  std::vector<std::string> names;    ///< by label; only the background if nothing says them
  std::vector<std::string> movable;  ///< person, if there is one, and nothing was said
  bool are_of_metadata = false;

  int count() const { return static_cast<int>(names.size()) - 1; }
};

/// Those of the settings, otherwise those of the model's metadata. A first name "background" in the settings is the
/// background and may be left out. Throws ConfigurationError with every wrong name in the settings, and InputError for
/// metadata with more names than there are labels.
ObjectClasses object_classes(const OnnxSettings& settings, const ModelMetadata& metadata);

/// Throws ConfigurationError with every problem of class names: fewer than `least` or more than 254, empty and repeated
/// ones, movable ones that are none of them.
void check_class_names(const std::vector<std::string>& classes, const std::vector<std::string>& movable,
                       std::size_t least);

/// "3 classes (person, bicycle, car)"; of more than five the first five.
std::string class_text(const std::vector<std::string>& names);

}  // namespace holdfast::onnx_plugin

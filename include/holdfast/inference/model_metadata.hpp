// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace holdfast {

/// What an exporter noted about a network for objects, in the keys that Ultralytics writes.
struct ModelMetadata {
  std::vector<std::string> names;  ///< of the classes, by number; empty if there are none that can be read
  std::string task;                ///< "detect", "segment", "pose", ...; empty if not noted
  int width = 0, height = 0;       ///< of the input (imgsz) [px]; 0 if not noted
};

/// Reads the metadata of a model (OnnxSignature::metadata). Values that cannot be read count as not noted.
ModelMetadata read_model_metadata(const std::map<std::string, std::string>& metadata);

/// Class names as a dictionary or a list, as Python or JSON writes them: {0: 'person', 1: 'bicycle'}, {"0": "person"},
/// ['person', 'bicycle']. A number without a name is named "class 3", and a name that occurred before gets its number
/// as well, so that all names differ. Nothing for any other text, and for numbers above 9999.
std::optional<std::vector<std::string>> read_class_names(const std::string& text);

}  // namespace holdfast

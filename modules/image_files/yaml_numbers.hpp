// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/error.hpp"

/// Strict reading of calibration files: every problem is an InputError with file, line and column.
namespace holdfast::yaml_numbers {

/// The place of a mark of the parser, which counts from 0; of a node that does not exist, the file.
SourceLocation location(const std::filesystem::path& file, const YAML::Mark& mark);

/// Parses a YAML or JSON file. `expected` says what it should be. The first line may be the "%YAML:1.0" of OpenCV's
/// files, which is no YAML.
YAML::Node load(const std::filesystem::path& file, const std::string& expected);

[[noreturn]] void reject(const std::filesystem::path& file, const YAML::Node& node, const std::string& key,
                         const std::string& expected);

/// A finite number.
double number(const std::filesystem::path& file, const YAML::Node& node, const std::string& key, bool positive = false);
/// The size of an image in pixels.
int size(const std::filesystem::path& file, const YAML::Node& node, const std::string& key);
/// A list of numbers; `counts`: the lengths that it may have.
std::vector<double> numbers(const std::filesystem::path& file, const YAML::Node& node, const std::string& key,
                            const std::vector<std::size_t>& counts);

/// The distortion of coefficients in OpenCV's order: four of a fisheye lens, otherwise k1 k2 p1 p2 and, if there is
/// one, k3.
Distortion distortion(Lens lens, const std::vector<double>& coefficients);

/// The rigid motion of the 16 numbers of a 4 x 4 matrix, row by row. The rotation is made orthonormal; nothing for a
/// matrix that is far from a rigid motion.
std::optional<Eigen::Isometry3d> rigid_motion(const std::vector<double>& row_by_row);

}  // namespace holdfast::yaml_numbers

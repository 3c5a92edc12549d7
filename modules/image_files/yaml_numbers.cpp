// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_numbers.hpp"

#include <cmath>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/nearest_rotation.hpp"
#include "holdfast/core/parsed_number.hpp"

namespace holdfast::yaml_numbers {

SourceLocation location(const std::filesystem::path& file, const YAML::Mark& mark) {
  return mark.is_null() ? SourceLocation{file.string()} : SourceLocation{file.string(), mark.line + 1, mark.column + 1};
}

YAML::Node load(const std::filesystem::path& file, const std::string& expected) {
  std::string content = file_content(file, largest_file::configuration, expected);
  if (content.starts_with("%YAML:")) content[0] = '#';
  try {
    return YAML::Load(content);
  } catch (const YAML::Exception& problem) {
    throw InputError(location(file, problem.mark), problem.msg + "; expected YAML or JSON");
  }
}

void reject(const std::filesystem::path& file, const YAML::Node& node, const std::string& key,
            const std::string& expected) {
  throw InputError(location(file, node.Mark()), "found '" +
                                                    (node.IsScalar() ? node.Scalar() : std::string("no value")) +
                                                    "' for " + key + "; expected " + expected + "; correct the value");
}

double number(const std::filesystem::path& file, const YAML::Node& node, const std::string& key, bool positive) {
  const char* expected = positive ? "a number greater than 0" : "a number";
  if (!node.IsScalar()) reject(file, node, key, expected);
  const auto value = parsed_number<double>(node.Scalar());
  if (!value || !std::isfinite(*value) || (positive && *value <= 0.0)) reject(file, node, key, expected);
  return *value;
}

int size(const std::filesystem::path& file, const YAML::Node& node, const std::string& key) {
  constexpr const char* expected = "a whole number of pixels from 1 to 32768";
  if (!node.IsScalar()) reject(file, node, key, expected);
  const auto value = parsed_number<int>(node.Scalar());
  if (!value || *value < 1 || *value > 32768) reject(file, node, key, expected);
  return *value;
}

std::vector<double> numbers(const std::filesystem::path& file, const YAML::Node& node, const std::string& key,
                            const std::vector<std::size_t>& counts) {
  std::string expected = "a list of ";
  for (std::size_t i = 0; i < counts.size(); ++i) expected += (i == 0 ? "" : " or ") + std::to_string(counts[i]);
  expected += " numbers";
  if (!node.IsSequence()) reject(file, node, key, expected);
  std::vector<double> values;
  for (const YAML::Node& item : node) values.push_back(number(file, item, key));
  for (const std::size_t count : counts)
    if (values.size() == count) return values;
  throw InputError(location(file, node.Mark()),
                   "found " + counted(values.size(), "number") + " for " + key + "; expected " + expected);
}

Distortion distortion(Lens lens, const std::vector<double>& k) {
  if (lens == Lens::fisheye) return {.k1 = k[0], .k2 = k[1], .k3 = k[2], .k4 = k[3], .lens = lens};
  return {.k1 = k[0], .k2 = k[1], .p1 = k[2], .p2 = k[3], .k3 = k.size() < 5 ? 0.0 : k[4], .lens = lens};
}

std::optional<Eigen::Isometry3d> rigid_motion(const std::vector<double>& row_by_row) {
  HOLDFAST_CHECK(row_by_row.size() == 16, row_by_row.size());
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(row_by_row.data());
  const Eigen::Matrix3d stored = matrix.topLeftCorner<3, 3>();
  constexpr double tolerance = 1e-3;
  if ((stored * stored.transpose() - Eigen::Matrix3d::Identity()).norm() > tolerance || stored.determinant() < 0.0 ||
      matrix.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0))
    return std::nullopt;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = nearest_rotation(stored);
  motion.translation() = matrix.topRightCorner<3, 1>();
  return motion;
}

}  // namespace holdfast::yaml_numbers

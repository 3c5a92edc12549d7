// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/frame_poses.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/nearest_rotation.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/text_file.hpp"
#include "holdfast/image_files/numpy_array.hpp"
#include "yaml_numbers.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

/// Nothing for a frame without a pose.
using OptionalPose = std::optional<Eigen::Isometry3d>;

constexpr const char* layouts =
    "a trajectory in TUM format, lines of 12 or 16 numbers, a folder or a pattern of files with one matrix "
    "each, .npy or .json";

/// The pose of a matrix of three or four rows, row by row; nothing if a number is not finite.
OptionalPose pose_of(const std::vector<double>& numbers, const SourceLocation& place) {
  for (const double number : numbers)
    if (!std::isfinite(number)) return std::nullopt;
  const Eigen::Matrix<double, 3, 4> upper =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data());
  if (numbers.size() == 16 && (numbers[12] != 0.0 || numbers[13] != 0.0 || numbers[14] != 0.0 || numbers[15] != 1.0))
    throw InputError(place, "is not a pose: its last row is not 0 0 0 1; expected a 4 x 4 matrix, row by row");
  const Eigen::Matrix3d stored = upper.leftCols<3>();
  constexpr double tolerance = 1e-2;
  if (stored.determinant() < 0.0)
    throw InputError(place, "is not a pose: its 3 x 3 part is a reflection; expected a rotation");
  if ((stored * stored.transpose() - Eigen::Matrix3d::Identity()).norm() > tolerance)
    throw InputError(place, "is not a pose: its 3 x 3 part is not a rotation, or a scaled one; expected a rotation");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = nearest_rotation(stored);
  pose.translation() = upper.col(3);
  return pose;
}

/// The frame of a camera of OpenGL: y up, and the view along -z.
OptionalPose from_opengl(OptionalPose pose) {
  if (pose) pose->linear() = pose->linear() * Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  return pose;
}

/// Calls use(place, numbers) for every line with numbers; '#' begins a comment.
template <class Use>
void each_line(const fs::path& file, Use&& use) {
  LineReader lines(file, layouts);
  for (std::string text; lines.next(text);) {
    std::string_view rest = std::string_view(text).substr(0, text.find('#'));
    std::vector<double> numbers;
    for (;;) {
      const std::size_t begin = rest.find_first_not_of(" \t\r,");
      if (begin == std::string_view::npos) break;
      rest.remove_prefix(begin);
      const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r,"));
      rest.remove_prefix(word.size());
      const auto number = parsed_number<double>(word);
      if (!number) throw InputError(lines.location(), "found '" + std::string(word) + "'; expected a number");
      numbers.push_back(*number);
    }
    if (!numbers.empty()) use(lines.location(), numbers);
  }
}

OptionalPose read_matrix_file(const fs::path& file) {
  std::vector<double> numbers;
  each_line(file, [&](const SourceLocation&, const std::vector<double>& line) {
    numbers.insert(numbers.end(), line.begin(), line.end());
  });
  if (numbers.size() != 12 && numbers.size() != 16)
    throw InputError({file.string()},
                     "has " + counted(numbers.size(), "number") + "; expected the 16 or 12 of a 4 x 4 or 3 x 4 matrix");
  return pose_of(numbers, {file.string()});
}

Trajectory of_numbered_files(const std::vector<NumberedFrame>& frames, const std::map<FileNumbers, fs::path>& files,
                             const fs::path& place) {
  Trajectory truth;
  bool found_any = false;
  for (const NumberedFrame& frame : frames) {
    const auto file = files.find(frame.numbers);
    if (file == files.end()) continue;
    found_any = true;
    if (const OptionalPose pose = read_matrix_file(file->second)) truth.push_back({frame.timestamp, *pose});
  }
  if (!found_any)
    throw InputError({place.string()}, "has a pose for none of the " + counted(frames.size(), "image") +
                                           "; expected text files with the numbers of the images");
  return truth;
}

Trajectory read_folder(const fs::path& folder, const std::vector<NumberedFrame>& frames) {
  std::map<FileNumbers, fs::path> files;
  for (const NumberedFile& file : find_numbered_files(folder, ".txt")) files[file.numbers] = file.path;
  return of_numbered_files(frames, files, folder);
}

Trajectory read_pattern(const fs::path& path, const std::vector<NumberedFrame>& frames) {
  const NumberPattern pattern(path.parent_path(), path.filename().string());
  std::map<FileNumbers, fs::path> files;
  std::error_code error;
  for (const NumberedFrame& frame : frames)
    if (const fs::path file = pattern.path_of(frame.numbers.back()); fs::exists(file, error))
      files[frame.numbers] = file;
  return of_numbered_files(frames, files, path);
}

/// Poses without numbers of their own: one for each image.
Trajectory of_images(const std::vector<OptionalPose>& poses, const std::vector<NumberedFrame>& frames,
                     std::size_t image_count, const fs::path& file) {
  if (poses.size() != image_count)
    throw InputError({file.string()}, "has " + counted(poses.size(), "pose") + ", but there are " +
                                          std::to_string(image_count) + " images; expected one for each");
  Trajectory truth;
  for (const NumberedFrame& frame : frames)
    if (poses[frame.index]) truth.push_back({frame.timestamp, *poses[frame.index]});
  return truth;
}

/// Whether the first line that is no comment has as many words as a matrix has numbers.
bool begins_with_matrix(const fs::path& file) {
  LineReader lines(file, layouts);
  for (std::string text; lines.next(text);) {
    std::istringstream line(text.substr(0, text.find('#')));
    const auto words = std::distance(std::istream_iterator<std::string>(line), {});
    if (words > 0) return words == 12 || words == 16;
  }
  return false;
}

Trajectory read_lines(const fs::path& file, const std::vector<NumberedFrame>& frames, std::size_t image_count) {
  if (!begins_with_matrix(file)) return read_trajectory(file);
  std::vector<OptionalPose> poses;
  each_line(file, [&](const SourceLocation& place, const std::vector<double>& numbers) {
    if (numbers.size() != 16 && numbers.size() != 12)
      throw InputError(place, "has " + counted(numbers.size(), "number") + "; expected 16 or 12, as in the first line");
    poses.push_back(pose_of(numbers, place));
  });
  return of_images(poses, frames, image_count, file);
}

constexpr const char* expected_array =
    "; expected an array of NumPy, n x 4 x 4 or n x 3 x 4 of float32 or float64; write it with numpy.save()";

[[noreturn]] void refuse_array(const fs::path& file, const std::string& found) {
  throw InputError({file.string()}, found + expected_array);
}

/// The form of an array of matrices.
struct ArrayForm {
  bool is_double = false;
  std::size_t matrices = 0, numbers = 0;  ///< numbers of each matrix: 12 or 16
};

std::uint64_t little_endian(const char* bytes, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  return value;
}

ArrayForm read_form(InputFile& input) {
  const NumpyHeader header = read_numpy_header(input, expected_array);
  ArrayForm form;
  form.is_double = header.type == "<f8";
  if ((!form.is_double && header.type != "<f4") || header.has_fortran_order)
    refuse_array(input.path(), "has numbers of type '" + header.type + "', or the order of Fortran");
  form.numbers = header.shape.size() < 2 ? 0 : 1;
  for (std::size_t i = 1; i < header.shape.size() && form.numbers <= 16; ++i) form.numbers *= header.shape[i];
  if (form.numbers != 12 && form.numbers != 16) refuse_array(input.path(), "has the shape " + shape_text(header));
  form.matrices = header.shape[0];
  return form;
}

Trajectory read_array(const fs::path& file, const std::vector<NumberedFrame>& frames, std::size_t image_count) {
  InputFile input(file, largest_file::cloud, "an array of NumPy");
  const ArrayForm form = read_form(input);
  const std::size_t number_bytes = form.is_double ? 8 : 4;
  std::vector<char> bytes(form.numbers * number_bytes);
  std::vector<double> row(form.numbers);
  std::vector<OptionalPose> poses;
  while (poses.size() < form.matrices && input.read(bytes.data(), bytes.size()) == bytes.size()) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::uint64_t bits = little_endian(bytes.data() + i * number_bytes, number_bytes);
      row[i] = form.is_double ? std::bit_cast<double>(bits)
                              : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    }
    poses.push_back(pose_of(row, {file.string() + ", pose " + std::to_string(poses.size())}));
  }
  if (poses.size() != form.matrices) refuse_array(file, "ends after " + counted(poses.size(), "pose"));
  return of_images(poses, frames, image_count, file);
}

/// "poses" of Record3D: qx qy qz qw px py pz.
OptionalPose quaternion_pose(const std::vector<double>& n, const SourceLocation& place) {
  const Eigen::Quaterniond rotation(n[3], n[0], n[1], n[2]);
  constexpr double tolerance = 1e-2;
  if (std::abs(rotation.norm() - 1.0) > tolerance)
    throw InputError(place, "is not a pose: its quaternion has the length " + std::to_string(rotation.norm()) +
                                "; expected qx qy qz qw px py pz");
  Eigen::Isometry3d pose(rotation.normalized());
  pose.translation() = Eigen::Vector3d(n[4], n[5], n[6]);
  return pose;
}

OptionalPose json_matrix(const fs::path& file, const YAML::Node& node) {
  std::vector<double> numbers;
  for (const YAML::Node& row : node)
    for (const double number : yaml_numbers::numbers(file, row, "a row of transform_matrix", {4}))
      numbers.push_back(number);
  if (numbers.size() != 16 && numbers.size() != 12)
    throw InputError(yaml_numbers::location(file, node.Mark()), "is not a matrix of four rows of four numbers");
  return pose_of(numbers, yaml_numbers::location(file, node.Mark()));
}

Trajectory read_json(const fs::path& file, const std::vector<NumberedFrame>& frames, std::size_t image_count) {
  const YAML::Node root = yaml_numbers::load(file, "a JSON file with \"frames\" or \"poses\"");
  const YAML::Node listed = root.IsMap() ? root["frames"] : YAML::Node(), poses = root.IsMap() ? root["poses"] : listed;
  std::vector<OptionalPose> found;
  if (poses && poses.IsSequence()) {
    for (const YAML::Node& pose : poses)
      found.push_back(from_opengl(quaternion_pose(yaml_numbers::numbers(file, pose, "a pose", {7}),
                                                  yaml_numbers::location(file, pose.Mark()))));
    return of_images(found, frames, image_count, file);
  }
  if (!listed || !listed.IsSequence())
    throw InputError({file.string()}, "has neither \"frames\" with \"transform_matrix\" nor \"poses\"; expected " +
                                          std::string(layouts));
  std::map<FileNumbers, OptionalPose> by_number;
  for (const YAML::Node& frame : listed) {
    const YAML::Node matrix = frame.IsMap() ? frame["transform_matrix"] : YAML::Node();
    if (!matrix || !matrix.IsSequence())
      throw InputError(yaml_numbers::location(file, frame.Mark()), "has no \"transform_matrix\"");
    found.push_back(from_opengl(json_matrix(file, matrix)));
    const YAML::Node name = frame["file_path"];
    if (name && name.IsScalar()) by_number[numbers_of(fs::path(name.Scalar()).stem().string())] = found.back();
  }
  if (by_number.size() != found.size()) return of_images(found, frames, image_count, file);
  Trajectory truth;
  for (const NumberedFrame& frame : frames)
    if (const auto pose = by_number.find(frame.numbers); pose != by_number.end() && pose->second)
      truth.push_back({frame.timestamp, *pose->second});
  if (truth.empty())
    throw InputError({file.string()}, "names none of the images in \"file_path\"; expected their numbers");
  return truth;
}

}  // namespace

Trajectory read_frame_poses(const fs::path& path, const std::vector<NumberedFrame>& frames, std::size_t image_count) {
  std::error_code error;
  if (NumberPattern::is_pattern(path.filename().string())) return read_pattern(path, frames);
  if (fs::is_directory(path, error)) return read_folder(path, frames);
  if (path.extension() == ".npy") return read_array(path, frames, image_count);
  if (path.extension() == ".json") return read_json(path, frames, image_count);
  return read_lines(path, frames, image_count);
}

}  // namespace holdfast

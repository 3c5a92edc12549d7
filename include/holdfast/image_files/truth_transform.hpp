// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

/// How the recorded truth of a sequence becomes the pose of the camera, where motion capture tracked something else:
/// T_world_camera = left * T * right for each recorded T. Identities leave it as it was recorded.
struct TruthTransform {
  Eigen::Isometry3d left = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d right = Eigen::Isometry3d::Identity();

  bool is_identity() const;
  /// For reports: "raw" for an identity, else "transformed".
  const char* frame() const { return is_identity() ? "raw" : "transformed"; }
};

/// Makes a transform of two tables, each the four rows of a 4 x 4 matrix in metres, or empty for the identity. A
/// calibrated rotation is rarely orthonormal in its printed digits: the nearest rotation takes its place. Throws
/// InputError that names `place` for a table of another shape, a last row other than 0 0 0 1, and a matrix that is no
/// rotation (a reflection, or stretched by more than a quarter).
TruthTransform make_truth_transform(const RealTable& left, const RealTable& right, const std::string& place);

/// The transform that the page of a dataset gives for the truth of its recordings: of Bonn RGB-D Dynamic, whose motion
/// capture tracks markers. Recognised by the name of the folder (rgbd_bonn_*) or the numbers of the camera bonn.
std::optional<TruthTransform> known_truth_transform(const std::string& folder, const Camera& camera);

/// What turns the recorded truth of a sequence in TUM layout into that of the camera.
struct TruthChoice {
  bool is_raw = false;    ///< the truth as recorded is wanted
  RealTable left, right;  ///< tables of make_truth_transform(), for a transform that the user gives
  std::string place;      ///< of the settings, for errors: "source.tum"
};
/// The identity for `is_raw`; else the given transform; else the known one of the dataset, unless the file `truth` has
/// the header that Holdfast writes (trajectory_header), because its poses are those of the camera already. Throws as
/// make_truth_transform().
TruthTransform choose_truth_transform(const TruthChoice& choice, const std::filesystem::path& truth,
                                      const Camera& camera);

/// Applies the transform to each pose.
Trajectory transformed(const TruthTransform& transform, Trajectory truth);

}  // namespace holdfast

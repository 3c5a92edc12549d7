// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/choice.hpp"

namespace holdfast {

template <class Settings>
class ParameterTable;

/// Correction of calibration errors of a stereo pair: none, by the configured errors, or by online estimates with the
/// configured errors as initial values.
enum class SelfCalibration { off, fixed, estimated };

template <>
inline constexpr Choice<SelfCalibration> choice_table<SelfCalibration>[] = {
    {"off", SelfCalibration::off}, {"fixed", SelfCalibration::fixed}, {"estimated", SelfCalibration::estimated}};

/// Dense disparity of a pair: none, or semi-global matching.
enum class DenseStereoMethod { off, sgbm };

template <>
inline constexpr Choice<DenseStereoMethod> choice_table<DenseStereoMethod>[] = {{"off", DenseStereoMethod::off},
                                                                                {"sgbm", DenseStereoMethod::sgbm}};

/// The `stereo` section of a configuration: depth of features from a stereo pair, dense depth, and self-calibration.
struct StereoSettings {
  double minimum_depth = 0.4;  ///< [m]; nearer surfaces have no depth
  double row_tolerance = 2.0;  ///< px at level 0, times the scale of the feature: of keypoints, and of rectification
  /// Maximum descriptor distance of a match; 0 = halfway between the extractor's strict and loose distance, 75 bits for
  /// ORB (Mur-Artal and Tardos 2017).
  double maximum_distance = 0.0;
  int patch_radius = 5;            ///< px; half the width of the patch by which the disparity is refined
  double minimum_disparity = 0.5;  ///< px; farther features have no depth

  DenseStereoMethod dense = DenseStereoMethod::sgbm;

  SelfCalibration self_calibration = SelfCalibration::estimated;
  // PairErrors: given, or first ones.
  double rotation_x = 0.0, rotation_y = 0.0, rotation_z = 0.0;  ///< [rad]
  double focal_ratio = 1.0;
  double column_offset = 0.0;  ///< [px]
  double radial = 0.0, decentring = 0.0;

  static void describe(ParameterTable<StereoSettings>& table);
};

}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class Optimizer;
template <class Settings>
class ParameterTable;

/// The optimizer `ceres`: what each value means, and its range, is in the reference (`holdfast modules ceres`).
struct CeresSettings {
  using Interface = Optimizer;
  static constexpr const char* module = "ceres";

  double chi_square_two = 5.991;
  double chi_square_three = 7.815;
  int pose_rounds = 4;
  int pose_iterations = 10;
  double function_tolerance = 1e-5;
  int dense_poses = 30;

  static void describe(ParameterTable<CeresSettings>& table);
};

}  // namespace holdfast

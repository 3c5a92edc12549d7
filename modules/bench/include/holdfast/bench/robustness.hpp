// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/bench/analysis.hpp"
#include "holdfast/evaluation/report.hpp"
#include "holdfast/evaluation/svg_plot.hpp"

namespace holdfast {

/// All sequences at one strength of a perturbation.
struct RobustnessPoint {
  double strength = 0.0;               ///< 0: unperturbed
  double error = Statistics::none;     ///< ATE RMSE [m]: median over sequences of the cells' medians
  double coverage = Statistics::none;  ///< mean over sequences of the cells' medians, 0 to 1
  std::size_t runs = 0;
  std::size_t counted = 0;  ///< runs whose errors are included
};

/// Error and coverage of a method over the strength of one perturbation.
struct RobustnessCurve {
  std::string kind;    ///< such as motion_blur
  std::string unit;    ///< of the strength; "" for a share
  std::string method;  ///< names of the values of all other axes, joined by '+'; "base" without other axes
  std::vector<RobustnessPoint> points;  ///< by strength
};

/// The curves of a matrix with the axis `perturbation`, by kind in the order of the axis, then by method in that of the
/// variants.
std::vector<RobustnessCurve> robustness_curves(const RunPlan& plan, const Analysis& analysis);

/// Every point of every curve, for programs.
ReportTable robustness_table(const std::vector<RobustnessCurve>& curves);
/// The curves of each kind as Markdown: one row per strength, one column per method.
std::string robustness_text(const std::vector<RobustnessCurve>& curves);

/// A plot of all methods for a kind.
struct RobustnessPlot {
  std::string name;  ///< of a file, without extension: motion_blur_error, motion_blur_coverage
  Plot plot;
};
std::vector<RobustnessPlot> robustness_plots(const std::vector<RobustnessCurve>& curves);

}  // namespace holdfast

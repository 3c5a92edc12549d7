// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/calibration/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "calibration_problem.hpp"
#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/median.hpp"

namespace holdfast {

namespace {

constexpr std::size_t fewest_views = 3;
constexpr std::size_t fewest_corners = 6;

/// A camera without distortion, in the middle of the image. Focal lengths as shares of the width: from a wide angle to
/// a telephoto lens.
std::vector<Camera> starts(int width, int height, Lens lens) {
  std::vector<double> shares = {0.5, 0.75, 1.1, 1.6, 2.4};
  if (lens == Lens::fisheye) shares = {0.25, 0.35, 0.5, 0.8};
  std::vector<Camera> cameras;
  for (const double share : shares) {
    Camera camera;
    camera.width = width, camera.height = height;
    camera.fx = camera.fy = share * width;
    camera.cx = 0.5 * (width - 1), camera.cy = 0.5 * (height - 1);
    camera.distortion.lens = lens;
    cameras.push_back(camera);
  }
  return cameras;
}

/// The views of a list that count.
std::vector<CalibrationProblem::View> views_of_problem(const std::vector<CalibratedView>& views,
                                                       const CalibrationBoard& board) {
  std::vector<CalibrationProblem::View> result;
  for (const CalibratedView& view : views) {
    if (!view.is_used) continue;
    CalibrationProblem::View added;
    for (const int corner : view.view.corners) added.points.push_back(board.corner(corner));
    added.pixels = view.view.pixels;
    result.push_back(std::move(added));
  }
  return result;
}

/// The camera that explains the views best.
CalibrationProblem solve(const std::vector<CalibratedView>& views, const CalibrationBoard& board, int width, int height,
                         const CalibrationOptions& options) {
  const std::vector<CalibrationProblem::View> prepared = views_of_problem(views, board);
  std::optional<CalibrationProblem> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Camera& start : starts(width, height, options.lens)) {
    CalibrationProblem problem(start, options.coefficients, prepared);
    problem.find_poses();
    constexpr int first_steps = 12, focal_centre_and_k1 = 5;
    const double cost = problem.minimise(first_steps, focal_centre_and_k1);
    if (!(cost < least)) continue;
    least = cost;
    best = problem;
  }
  if (!best) throw Error("no camera explains the views: is the number of corners of the board right?");
  // With a better camera, the other one of two poses that look alike may be the right one.
  constexpr int rounds = 3, steps = 60;
  for (int round = 0; round < rounds; ++round) {
    CalibrationProblem problem = *best;
    if (round > 0) problem.find_poses();
    const double cost = problem.minimise(steps);
    if (round > 0 && !(cost < least * (1.0 - 1e-6))) break;
    least = cost;
    best = problem;
  }
  return *best;
}

/// Sets pose, residuals and error of a view. One that was left out gets the pose that suits it best.
void judge(const Camera& camera, const CalibrationBoard& board, CalibratedView& view) {
  CalibrationProblem::View one;
  for (const int corner : view.view.corners) one.points.push_back(board.corner(corner));
  one.pixels = view.view.pixels;
  CalibrationProblem problem(camera, 4, {one});
  problem.find_poses();
  constexpr int steps = 20, none = 0;
  problem.minimise(steps, none);
  view.T_camera_board = problem.views().front().T_camera_board;
  view.residuals = CalibrationProblem::residuals(camera, problem.views().front());
  double sum = 0.0;
  for (const Eigen::Vector2d& difference : view.residuals) sum += difference.squaredNorm();
  view.rms = view.residuals.empty() ? std::numeric_limits<double>::infinity()
                                    : std::sqrt(sum / static_cast<double>(view.residuals.size()));
  view.tilt = std::acos(std::min(1.0, std::abs(view.T_camera_board.linear()(2, 2))));
}

/// Marks the views that disagree with the others. Returns whether there was one.
bool leave_out(std::vector<CalibratedView>& views) {
  std::vector<double> errors;
  for (const CalibratedView& view : views)
    if (view.is_used) errors.push_back(view.rms);
  const double limit = std::max(0.5, 3.0 * upper_median(errors));
  std::size_t out = views.size() - errors.size();
  bool is_changed = false;
  // The worst first, for at most a quarter can go.
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return views[a].rms > views[b].rms; });
  for (const std::size_t i : order) {
    if (!views[i].is_used || views[i].rms <= limit) continue;
    if (4 * (out + 1) > views.size() || views.size() - out - 1 < fewest_views) break;
    views[i].is_used = false;
    ++out;
    is_changed = true;
  }
  return is_changed;
}

void add_numbers(const CalibrationProblem& problem, Calibration& result) {
  double sum = 0.0;
  std::size_t corners = 0;
  for (const CalibratedView& view : result.views) {
    if (!view.is_used) continue;
    for (const Eigen::Vector2d& difference : view.residuals) sum += difference.squaredNorm();
    corners += view.residuals.size();
  }
  result.rms = std::sqrt(sum / static_cast<double>(corners));
  const auto unknowns = problem.names().size() + 6 * result.used_count();
  const double freedom = std::max(1.0, static_cast<double>(2 * corners) - static_cast<double>(unknowns));
  const double scatter = std::sqrt(sum / freedom);
  const Eigen::VectorXd deviations = problem.unit_deviations();
  for (std::size_t i = 0; i < problem.names().size(); ++i) {
    const double unit = deviations[static_cast<Eigen::Index>(i)];
    result.numbers.push_back({problem.names()[i], CalibrationProblem::value(result.camera, problem.names()[i]),
                              std::isfinite(unit) ? unit * scatter : unit});
  }
}

}  // namespace

std::size_t Calibration::used_count() const {
  return static_cast<std::size_t>(
      std::count_if(views.begin(), views.end(), [](const CalibratedView& view) { return view.is_used; }));
}

const CalibratedNumber& Calibration::number(const std::string& name) const {
  for (const CalibratedNumber& number : numbers)
    if (number.name == name) return number;
  HOLDFAST_CHECK(false, name);
  return numbers.front();
}

Calibration calibrate(const std::vector<BoardView>& views, const CalibrationBoard& board, int width, int height,
                      const CalibrationOptions& options) {
  Calibration result;
  for (const BoardView& view : views)
    if (view.corners.size() >= fewest_corners) result.views.emplace_back().view = view;
  if (result.views.size() < fewest_views)
    throw Error("found " + counted(result.views.size(), "view") +
                " with six corners or more; expected at least 3, better 20, from different sides");
  constexpr int most_rounds = 4;
  for (int round = 0;; ++round) {
    const CalibrationProblem problem = solve(result.views, board, width, height, options);
    result.camera = problem.camera();
    for (CalibratedView& view : result.views) judge(result.camera, board, view);
    if (!options.keep_all_views && round < most_rounds && leave_out(result.views)) continue;
    add_numbers(problem, result);
    return result;
  }
}

}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_problem.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <utility>

#include "holdfast/core/check.hpp"
#include "holdfast/geometry/so3.hpp"

namespace holdfast {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using Block = Eigen::Matrix<double, 2, 6>;
using Wide = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// The number of a camera that a configuration knows by this name.
double& number_of(Camera& camera, const std::string& name) {
  Distortion& d = camera.distortion;
  const std::pair<const char*, double*> numbers[] = {
      {"fx", &camera.fx}, {"fy", &camera.fy}, {"cx", &camera.cx}, {"cy", &camera.cy}, {"k1", &d.k1}, {"k2", &d.k2},
      {"p1", &d.p1},      {"p2", &d.p2},      {"k3", &d.k3},      {"k4", &d.k4},      {"k5", &d.k5}, {"k6", &d.k6}};
  for (const auto& [known, number] : numbers)
    if (name == known) return *number;
  HOLDFAST_CHECK(false, name);
  return camera.fx;
}

std::vector<std::string> estimated_numbers(Lens lens, int coefficients) {
  std::vector<std::string> names = {"fx", "fy", "cx", "cy"};
  if (lens == Lens::fisheye)
    names.insert(names.end(), {"k1", "k2", "k3", "k4"});
  else
    names.insert(names.end(), {"k1", "k2", "p1", "p2"});
  if (lens != Lens::fisheye && coefficients >= 5) names.insert(names.end(), {"k3"});
  if (lens != Lens::fisheye && coefficients >= 8) names.insert(names.end(), {"k4", "k5", "k6"});
  return names;
}

/// Raw image position of a point in the camera frame, in front of the camera.
Eigen::Vector2d raw_position(const Camera& camera, const Eigen::Vector3d& point) {
  return camera.distort(camera.project(point));
}

bool is_in_front(const Eigen::Vector3d& point) { return point.z() > 1e-6 * point.norm(); }

/// Derivatives of the raw image position, by central differences: the problem is small, and every lens alike.
struct Derivatives {
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_numbers;
  Block by_pose;  ///< of the rotation and translation that are applied from the left
};

Derivatives derivatives(const Camera& camera, const Eigen::Vector3d& point, const std::vector<std::string>& names,
                        int free) {
  Derivatives result;
  result.by_numbers.resize(2, free);
  for (int i = 0; i < free; ++i) {
    const double step = i < 4 ? 0.1 : 1e-5;  // pixels; coefficients, in which the position is nearly linear
    Camera below = camera, above = camera;
    number_of(below, names[static_cast<std::size_t>(i)]) -= step;
    number_of(above, names[static_cast<std::size_t>(i)]) += step;
    result.by_numbers.col(i) = (raw_position(above, point) - raw_position(below, point)) / (2.0 * step);
  }
  Eigen::Matrix<double, 2, 3> by_point;
  const double step = 1e-5 * point.z();
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d change = step * Eigen::Vector3d::Unit(axis);
    by_point.col(axis) = (raw_position(camera, point + change) - raw_position(camera, point - change)) / (2.0 * step);
  }
  result.by_pose.leftCols<3>() = -by_point * geometry::hat(point);
  result.by_pose.rightCols<3>() = by_point;
  return result;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Eigen::Matrix<double, 6, 1>& step) {
  Eigen::Isometry3d change = Eigen::Isometry3d::Identity();
  change.linear() = geometry::exp_so3(step.head<3>()).toRotationMatrix();
  change.translation() = step.tail<3>();
  Eigen::Isometry3d result = change * pose;
  result.linear() = Eigen::Quaterniond(result.linear()).normalized().toRotationMatrix();
  return result;
}

}  // namespace

/// Normal equations: A and a of the numbers, C and c of each pose, B between them.
struct CalibrationProblem::Equations {
  Eigen::MatrixXd A;
  Eigen::VectorXd a;
  std::vector<Wide> B;
  std::vector<Eigen::Matrix<double, 6, 6>> C;
  std::vector<Eigen::Matrix<double, 6, 1>> c;

  /// The equations of the numbers alone, with the diagonals made larger by a factor.
  void eliminate(double damping, Eigen::MatrixXd& reduced, Eigen::VectorXd& right) const {
    reduced = A;
    reduced.diagonal() *= 1.0 + damping;
    right = a;
    if (A.rows() == 0) return;  // Eigen 3.4 takes the address of the first element of an empty right-hand side
    for (std::size_t v = 0; v < C.size(); ++v) {
      const auto inverse = damped(v, damping).ldlt();
      reduced -= B[v] * inverse.solve(B[v].transpose());
      right -= B[v] * inverse.solve(c[v]);
    }
  }
  Eigen::Matrix<double, 6, 6> damped(std::size_t v, double damping) const {
    Eigen::Matrix<double, 6, 6> result = C[v];
    result.diagonal() *= 1.0 + damping;
    return result;
  }
};

CalibrationProblem::CalibrationProblem(const Camera& start, int coefficients, std::vector<View> views)
    : camera_(start), names_(estimated_numbers(start.distortion.lens, coefficients)), views_(std::move(views)) {}

double CalibrationProblem::value(const Camera& camera, const std::string& name) {
  Camera copy = camera;
  return number_of(copy, name);
}

void CalibrationProblem::find_poses() {
  for (View& view : views_) {
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> rays;
    for (std::size_t i = 0; i < view.points.size(); ++i) {
      points.emplace_back(view.points[i].x(), view.points[i].y(), 0.0);
      const Eigen::Vector2d pixel = camera_.undistort(view.pixels[i]);
      const Eigen::Vector2d ray = camera_.normalised(pixel.x(), pixel.y());
      rays.emplace_back(ray.x(), ray.y());
    }
    // Of a plane far away two poses look alike (Collins and Bartoli 2014); that counts which agrees better.
    std::vector<cv::Mat> rotations, translations;
    cv::solvePnPGeneric(points, rays, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                        cv::SOLVEPNP_IPPE);
    double best = infinity;
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      const cv::Vec3d r = rotations[i], t = translations[i];
      View candidate = view;
      candidate.T_camera_board.linear() = geometry::exp_so3(Eigen::Vector3d(r[0], r[1], r[2])).toRotationMatrix();
      candidate.T_camera_board.translation() = Eigen::Vector3d(t[0], t[1], t[2]);
      double sum = infinity;
      if (const auto differences = residuals(camera_, candidate); !differences.empty()) {
        sum = 0.0;
        for (const Eigen::Vector2d& difference : differences) sum += difference.squaredNorm();
      }
      if (!(sum < best)) continue;
      best = sum;
      view.T_camera_board = candidate.T_camera_board;
    }
  }
}

std::vector<Eigen::Vector2d> CalibrationProblem::residuals(const Camera& camera, const View& view) {
  std::vector<Eigen::Vector2d> result;
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    const Eigen::Vector3d point = view.T_camera_board * view.points[i];
    if (!is_in_front(point)) return {};
    result.push_back(view.pixels[i] - raw_position(camera, point));
  }
  return result;
}

double CalibrationProblem::cost(const Camera& camera, const std::vector<View>& views) const {
  double sum = 0.0;
  for (const View& view : views) {
    const std::vector<Eigen::Vector2d> differences = residuals(camera, view);
    if (differences.empty()) return infinity;
    for (const Eigen::Vector2d& difference : differences) sum += difference.squaredNorm();
  }
  return std::isfinite(sum) ? sum : infinity;
}

CalibrationProblem::Equations CalibrationProblem::equations(int free) const {
  Equations e;
  e.A.setZero(free, free);
  e.a.setZero(free);
  e.B.assign(views_.size(), Wide::Zero(free, 6));
  e.C.assign(views_.size(), Eigen::Matrix<double, 6, 6>::Zero());
  e.c.assign(views_.size(), Eigen::Matrix<double, 6, 1>::Zero());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const View& view = views_[v];
    for (std::size_t i = 0; i < view.points.size(); ++i) {
      const Eigen::Vector3d point = view.T_camera_board * view.points[i];
      const Derivatives d = derivatives(camera_, point, names_, free);
      const Eigen::Vector2d difference = view.pixels[i] - raw_position(camera_, point);
      e.A += d.by_numbers.transpose() * d.by_numbers;
      e.a += d.by_numbers.transpose() * difference;
      e.B[v] += d.by_numbers.transpose() * d.by_pose;
      e.C[v] += d.by_pose.transpose() * d.by_pose;
      e.c[v] += d.by_pose.transpose() * difference;
    }
  }
  return e;
}

double CalibrationProblem::minimise(int steps, int free) {
  double current = cost(camera_, views_), damping = 1e-3;
  if (!std::isfinite(current)) return infinity;
  for (int step = 0; step < steps; ++step) {
    const Equations e = equations(free);
    bool is_better = false;
    double gain = 0.0;
    while (!is_better && damping < 1e12) {
      Eigen::MatrixXd reduced;
      Eigen::VectorXd right;
      e.eliminate(damping, reduced, right);
      const Eigen::VectorXd change = reduced.ldlt().solve(right);
      Camera camera = camera_;
      for (int i = 0; i < free; ++i) number_of(camera, names_[static_cast<std::size_t>(i)]) += change[i];
      std::vector<View> views = views_;
      for (std::size_t v = 0; v < views.size(); ++v) {
        const Eigen::Matrix<double, 6, 1> pose_change =
            e.damped(v, damping).ldlt().solve(e.c[v] - e.B[v].transpose() * change);
        views[v].T_camera_board = moved(views[v].T_camera_board, pose_change);
      }
      const double next = camera.fx > 0.0 && camera.fy > 0.0 ? cost(camera, views) : infinity;
      is_better = next < current;
      if (!is_better) {
        damping *= 4.0;
        continue;
      }
      gain = (current - next) / current;
      current = next;
      camera_ = camera;
      views_ = std::move(views);
      damping = std::max(1e-12, damping * 0.2);
    }
    if (!is_better || gain < 1e-12) break;
  }
  return current;
}

Eigen::VectorXd CalibrationProblem::unit_deviations() const {
  const int count = static_cast<int>(names_.size());
  Eigen::MatrixXd reduced;
  Eigen::VectorXd right;
  equations(count).eliminate(0.0, reduced, right);
  // Pixels and coefficients differ by orders of magnitude: brought to equal size first.
  const Eigen::VectorXd size = reduced.diagonal().cwiseAbs().cwiseSqrt().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled = size.cwiseInverse().asDiagonal() * reduced * size.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  constexpr double undetermined = 1e-10;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(count);
  for (int i = 0; i < count; ++i) {
    const Eigen::VectorXd direction = solver.eigenvectors().col(i);
    const double information = solver.eigenvalues()[i];
    for (int k = 0; k < count; ++k) {
      const double share = direction[k] * direction[k];
      if (information > undetermined)
        result[k] += share / information;
      else if (share > 1e-6)
        result[k] = infinity;
    }
  }
  return result.cwiseSqrt().cwiseQuotient(size);
}

}  // namespace holdfast

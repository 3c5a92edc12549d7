// SPDX-License-Identifier: BSD-3-Clause
#include "weak_ties.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace holdfast {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Between clusters whose relative pose is less certain, ties are the better measurement [m], [rad].
constexpr double max_position_deviation = 0.1, max_rotation_deviation = 0.02;
/// Of poses within a cluster [m], [rad], and of velocities where a link begins [m/s].
constexpr double cluster_position = 0.005, cluster_rotation = 0.002, velocity_deviation = 0.005;
constexpr double max_deviations = 3.0;

/// Numbers clusters from 0 in the order of their first pose.
std::vector<std::uint32_t> numbered(std::span<const std::uint32_t> cluster) {
  std::map<std::uint32_t, std::uint32_t> numbers;
  std::vector<std::uint32_t> result;
  for (const std::uint32_t name : cluster)
    result.push_back(numbers.try_emplace(name, static_cast<std::uint32_t>(numbers.size())).first->second);
  return result;
}

/// For each point, the first pose of the cluster that observes it most often, the older one of two.
std::vector<std::uint32_t> find_homes(const BundleProblem& problem, std::span<const std::uint32_t> cluster) {
  struct Views {
    int count = 0;
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
  };
  std::vector<std::map<std::uint32_t, Views>> views(problem.points.size());
  for (const BundleProblem::Observation& observation : problem.observations) {
    Views& seen = views[observation.point][cluster[observation.pose]];
    ++seen.count;
    seen.first = std::min(seen.first, observation.pose);
  }
  std::vector<std::uint32_t> homes(problem.points.size(), 0);
  for (std::size_t i = 0; i < views.size(); ++i) {
    Views best;
    for (const auto& [name, seen] : views[i])
      if (seen.count > best.count || (seen.count == best.count && seen.first < best.first)) best = seen;
    if (best.count > 0) homes[i] = best.first;
  }
  return homes;
}

}  // namespace

/// The sum of deviations along the path of links with the smallest sum (Floyd and Warshall); errors of successive links
/// are not independent.
std::vector<std::vector<WeakTies::Deviation>> WeakTies::deviations_between(const BundleProblem& problem,
                                                                           std::span<const std::uint32_t> cluster,
                                                                           std::size_t count,
                                                                           const MapInertia& estimates) {
  std::vector<std::vector<Deviation>> table(count, std::vector<Deviation>(count, {infinite, infinite}));
  for (std::size_t i = 0; i < count; ++i) table[i][i] = {cluster_position, cluster_rotation};
  for (const BundleFactors::Inertial& link : problem.factors.inertial) {
    const std::uint32_t a = cluster[problem.factors.motions[link.first].pose];
    const std::uint32_t b = cluster[problem.factors.motions[link.second].pose];
    if (a == b) continue;
    const geometry::Matrix15d& covariance = link.measured.covariance();
    const double time = link.measured.duration(), half_square = 0.5 * time * time;
    const double measured = covariance.diagonal().segment<3>(geometry::inertial::position).maxCoeff();
    const double turned = covariance.diagonal().segment<3>(geometry::inertial::rotation).maxCoeff();
    const Deviation deviation{std::hypot(std::hypot(std::sqrt(measured), velocity_deviation * time),
                                         half_square * estimates.accelerometer_deviation,
                                         half_square * estimates.gravity_deviation * problem.factors.gravity.norm()) /
                                  problem.factors.scale,
                              std::hypot(std::sqrt(turned), estimates.gyroscope_deviation * time)};
    if (deviation.position < table[a][b].position) table[a][b] = table[b][a] = deviation;
  }
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) {
        const Deviation sum{table[i][k].position + table[k][j].position, table[i][k].rotation + table[k][j].rotation};
        if (i != j && i != k && j != k && sum.position < table[i][j].position) table[i][j] = sum;
      }
  return table;
}

void WeakTies::take_out(BundleProblem& problem, std::span<const std::uint32_t> names, const MapInertia& estimates) {
  constexpr std::size_t max_clusters = 300;  // the table of deviations grows with the cube
  ties_.clear(), rejected_.clear();
  cluster_ = numbered(names);
  const std::size_t count = cluster_.empty() ? 0 : 1 + *std::max_element(cluster_.begin(), cluster_.end());
  if (count < 2 || count > max_clusters) return;
  homes_ = find_homes(problem, cluster_);
  const auto table = deviations_between(problem, cluster_, count, estimates);
  std::erase_if(problem.observations, [&](const BundleProblem::Observation& observation) {
    const std::uint32_t home = homes_[observation.point];
    if (cluster_[observation.pose] == cluster_[home]) return false;
    const Deviation& deviation = table[cluster_[observation.pose]][cluster_[home]];
    if (!(deviation.position <= max_position_deviation && deviation.rotation <= max_rotation_deviation)) return false;
    ties_.push_back({observation, deviation});
    return true;
  });
}

/// By point, the standard deviation of its distance along the ray of its home [m], by the best single observation
/// within the home's cluster: by its disparity, or by its parallax to the home. Infinite where nothing tells the
/// distance.
std::vector<double> WeakTies::depth_deviations(const BundleProblem& problem) const {
  const Camera& camera = *problem.camera;
  std::vector<double> information(problem.points.size(), 0.0);
  for (const BundleProblem::Observation& seen : problem.observations) {
    const std::uint32_t home = homes_[seen.point];
    if (cluster_[seen.pose] != cluster_[home] || seen.outlier) continue;
    const Eigen::Isometry3d& pose = problem.poses[seen.pose].T_camera_world;
    const Eigen::Vector3d in_camera = pose * problem.points[seen.point];
    if (!(in_camera.z() > 0.0)) continue;
    const Eigen::Vector3d along = pose.linear() * home_ray(problem, home, seen.point);
    const double parallax = along.cross(in_camera.normalized()).norm(), inverse_depth = 1.0 / in_camera.z();
    double moved = camera.fx * parallax * inverse_depth;  // [px/m]
    if (!std::isnan(seen.right_x))
      moved = std::max(moved, camera.baseline * camera.fx * inverse_depth * inverse_depth * std::abs(along.z()));
    information[seen.point] = std::max(information[seen.point], moved * moved * seen.inverse_sigma2);
  }
  std::vector<double> deviations;
  for (const double known : information) deviations.push_back(known > 0.0 ? 1.0 / std::sqrt(known) : infinite);
  return deviations;
}

Eigen::Vector3d WeakTies::home_ray(const BundleProblem& problem, std::uint32_t home, std::uint32_t point) {
  return (problem.points[point] - problem.poses[home].T_camera_world.inverse().translation()).normalized();
}

/// Whether each coordinate is within three deviations, of the pixel, of the poses and of the point along the ray of the
/// keyframe that places it.
bool WeakTies::agrees(const BundleProblem& problem, const Tie& tie, double depth_deviation) const {
  const Camera& camera = *problem.camera;
  const BundleProblem::Observation& seen = tie.observation;
  const Eigen::Isometry3d& pose = problem.poses[seen.pose].T_camera_world;
  const Eigen::Vector3d in_camera = pose * problem.points[seen.point];
  if (!(in_camera.z() > 0.0) || !in_camera.allFinite()) return false;
  const double inverse_depth = 1.0 / in_camera.z(), pixel = 1.0 / std::sqrt(seen.inverse_sigma2);
  const Eigen::Vector3d along = pose.linear() * home_ray(problem, homes_[seen.point], seen.point);
  const double parallax = along.cross(in_camera.normalized()).norm();
  const double moved = std::hypot(tie.deviation.position, parallax > 0.0 ? parallax * depth_deviation : 0.0);
  const double deviation = std::hypot(pixel, camera.fx * moved * inverse_depth, camera.fx * tie.deviation.rotation);
  const double x = camera.fx * in_camera.x() * inverse_depth + camera.cx;
  const double y = camera.fy * in_camera.y() * inverse_depth + camera.cy;
  if (!(std::hypot(x - seen.x, y - seen.y) <= max_deviations * deviation)) return false;
  if (std::isnan(seen.right_x)) return true;
  const double bf = camera.baseline * camera.fx, disparity_error = bf * inverse_depth - (seen.x - seen.right_x);
  const double farther = std::hypot(tie.deviation.position, std::abs(along.z()) * depth_deviation);
  return std::abs(disparity_error) <=
         max_deviations * std::hypot(2.0 * pixel, bf * inverse_depth * inverse_depth * farther);
}

void WeakTies::put_back_agreeing(BundleProblem& problem) {
  const std::vector<double> depth_deviation = depth_deviations(problem);
  for (const Tie& tie : ties_)
    (agrees(problem, tie, depth_deviation[tie.observation.point]) ? problem.observations : rejected_)
        .push_back(tie.observation);
}

void WeakTies::put_back_all(BundleProblem& problem) {
  for (const Tie& tie : ties_) problem.observations.push_back(tie.observation);
}

std::size_t WeakTies::add_rejected(BundleProblem& problem) {
  for (BundleProblem::Observation& observation : rejected_) {
    observation.outlier = true;
    problem.observations.push_back(observation);
  }
  return rejected_.size();
}

}  // namespace holdfast

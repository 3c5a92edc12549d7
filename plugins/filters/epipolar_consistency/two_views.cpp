// SPDX-License-Identifier: BSD-3-Clause
#include "two_views.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "holdfast/geometry/ransac.hpp"

namespace holdfast::epipolar_consistency_plugin {

namespace {
constexpr std::size_t min_pairs = 30;    // with fewer, the support of a fundamental matrix is not significant
constexpr std::size_t max_chosen = 250;  // more increase the run time but not the accuracy
constexpr int homography_iterations = 100;
constexpr int max_refits = 4;

using Row = Eigen::Matrix<double, 9, 1>;
using System = Eigen::Matrix<double, 8, 9, Eigen::RowMajor>;
using Normal = Eigen::Matrix<double, 9, 9>;

Eigen::Matrix3d as_matrix(const Row& v) {
  Eigen::Matrix3d result;
  result << v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8];
  return result;
}

/// The null vector of eight equations by Gaussian elimination with row exchange; nothing if the null space has more
/// than one dimension.
std::optional<Row> null_vector(System& a) {
  std::array<int, 9> column{0, 1, 2, 3, 4, 5, 6, 7, 8};
  for (int k = 0; k < 8; ++k) {
    int row = 0, pivot = 0;
    if (const double largest = a.block(k, k, 8 - k, 9 - k).cwiseAbs().maxCoeff(&row, &pivot); !(largest > 1e-9))
      return std::nullopt;
    if (row > 0) a.row(k).swap(a.row(k + row));
    if (pivot > 0) a.col(k).swap(a.col(k + pivot)), std::swap(column[k], column[k + pivot]);
    for (int i = k + 1; i < 8; ++i) a.row(i).tail(8 - k) -= a(i, k) / a(k, k) * a.row(k).tail(8 - k);
  }
  Row solution;
  solution[8] = 1.0;
  for (int k = 7; k >= 0; --k) solution[k] = -a.row(k).tail(8 - k).dot(solution.tail(8 - k).transpose()) / a(k, k);
  Row result;
  for (std::size_t k = 0; k < 9; ++k) result[column[k]] = solution[static_cast<Eigen::Index>(k)];
  return result.normalized();
}

Row epipolar_row(const PointPairs& p, std::size_t i) {
  const double ax = p.ax[i], ay = p.ay[i], bx = p.bx[i], by = p.by[i];
  Row row;
  row << bx * ax, bx * ay, bx, by * ax, by * ay, by, ax, ay, 1.0;
  return row;
}

std::array<Row, 2> homography_rows(const PointPairs& p, std::size_t i) {
  const double ax = p.ax[i], ay = p.ay[i], bx = p.bx[i], by = p.by[i];
  std::array<Row, 2> rows;
  rows[0] << ax, ay, 1.0, 0, 0, 0, -bx * ax, -bx * ay, -bx;
  rows[1] << 0, 0, 0, ax, ay, 1.0, -by * ax, -by * ay, -by;
  return rows;
}

Row smallest_direction(const Normal& normal) {
  const Eigen::SelfAdjointEigenSolver<Normal> solver(normal);
  return solver.eigenvectors().col(0);
}

/// Least squares of rank 2 over the pairs within the threshold (Hartley and Zisserman, section 11.1.1).
Eigen::Matrix3d refit_fundamental(const PointPairs& pairs, const std::vector<float>& distance2, float threshold2) {
  Normal normal = Normal::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (distance2[i] <= threshold2) {
      const Row row = epipolar_row(pairs, i);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
    }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(as_matrix(smallest_direction(normal)),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d values = svd.singularValues();
  values[2] = 0.0;
  return svd.matrixU() * values.asDiagonal() * svd.matrixV().transpose();
}

Eigen::Matrix3d refit_homography(const PointPairs& pairs, const std::vector<float>& distance2, float threshold2) {
  Normal normal = Normal::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (distance2[i] <= threshold2)
      for (const Row& row : homography_rows(pairs, i)) normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
  return as_matrix(smallest_direction(normal));
}

int count_within(const std::vector<float>& distance2, float threshold2) {
  int count = 0;
  for (const float value : distance2) count += value <= threshold2 ? 1 : 0;
  return count;
}

float truncated_sum(const std::vector<float>& distance2, float threshold2) {
  float sum = 0.0F;
  for (const float value : distance2) sum += std::min(value, threshold2);
  return sum;
}

/// How a search is drawn and when it ends.
struct SearchLimits {
  float threshold2;    ///< squared distance of a pair that fits [px^2]
  int max_iterations;  ///< samples, at most
  double confidence;   ///< of having drawn a sample without outliers
};

/// What a search does with a model: solve(sample) gives a model of a minimal sample, measure(model, pairs, distance2)
/// the squared distances of all pairs, refit(pairs, distance2, threshold2) a model of those that fit.
template <class Solve, class Measure, class Refit>
struct ModelFunctions {
  Solve solve;
  Measure measure;
  Refit refit;
};
template <class Solve, class Measure, class Refit>
ModelFunctions(Solve, Measure, Refit) -> ModelFunctions<Solve, Measure, Refit>;

/// RANSAC with a truncated quadratic cost (MSAC; Torr and Zisserman, CVIU 78, 2000, equation 17) and local refinement
/// of every new best model (Chum, Matas and Kittler, DAGM 2003). Returns the number of inliers of the best model;
/// `distance2` is scratch memory.
template <std::size_t sample_size, class Functions>
int search(const PointPairs& pairs, const SearchLimits& limits, const Functions& model_of, Random& random,
           std::vector<float>& distance2, Eigen::Matrix3d& best) {
  int best_count = 0, needed = limits.max_iterations;
  float best_cost = std::numeric_limits<float>::infinity();
  const auto keep_if_better = [&](const Eigen::Matrix3d& model) {
    model_of.measure(model, pairs, distance2);
    const float cost = truncated_sum(distance2, limits.threshold2);
    if (!(cost < best_cost)) return false;
    best_cost = cost, best_count = count_within(distance2, limits.threshold2), best = model;
    return true;
  };
  for (int iteration = 0; iteration < needed; ++iteration) {
    const auto sample = geometry::sample_without_repeat<sample_size>(random, static_cast<std::uint32_t>(pairs.size()));
    const std::optional<Row> solution = model_of.solve(sample);
    if (!solution || !keep_if_better(as_matrix(*solution))) continue;
    for (int k = 0; k < max_refits && keep_if_better(model_of.refit(pairs, distance2, limits.threshold2)); ++k) {
    }
    const double inlier_ratio = best_count / static_cast<double>(pairs.size());
    needed = std::min(needed, geometry::ransac_iterations(inlier_ratio, static_cast<int>(sample_size),
                                                          limits.confidence, limits.max_iterations));
  }
  return best_count;
}
}  // namespace

void epipolar_distances2(const Eigen::Matrix3d& fundamental, const PointPairs& pairs, std::vector<float>& distance2) {
  const Eigen::Matrix3f f = (fundamental / fundamental.norm()).cast<float>();
  distance2.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const float x = pairs.ax[i], y = pairs.ay[i];
    const float a = f(0, 0) * x + f(0, 1) * y + f(0, 2), b = f(1, 0) * x + f(1, 1) * y + f(1, 2),
                c = f(2, 0) * x + f(2, 1) * y + f(2, 2);
    const float value = a * pairs.bx[i] + b * pairs.by[i] + c;
    // At the epipole the line is undefined, and every point satisfies the constraint.
    distance2[i] = value * value / std::max(a * a + b * b, 1e-12F);
  }
}

void transfer_distances2(const Eigen::Matrix3d& homography, const PointPairs& pairs, std::vector<float>& distance2) {
  const Eigen::Matrix3f h = (homography / homography.norm()).cast<float>();
  distance2.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const float x = pairs.ax[i], y = pairs.ay[i];
    const float u = h(0, 0) * x + h(0, 1) * y + h(0, 2), v = h(1, 0) * x + h(1, 1) * y + h(1, 2),
                w = h(2, 0) * x + h(2, 1) * y + h(2, 2);
    const float inverse = std::abs(w) > 1e-6F ? 1.0F / w : 1e6F;
    const float dx = u * inverse - pairs.bx[i], dy = v * inverse - pairs.by[i];
    distance2[i] = dx * dx + dy * dy;
  }
}

void TwoViews::choose_trusted(const PointPairs& pairs) {
  std::size_t trusted = 0;
  for (const std::uint8_t value : pairs.trusted) trusted += value;
  chosen_.clear();
  // Evenly sampled from the list: every pair whose fraction of the total reaches the next integer.
  const std::size_t wanted = std::min(trusted, max_chosen);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs.trusted[i] == 0) continue;
    if ((seen + 1) * wanted / trusted > seen * wanted / trusted)
      chosen_.add(pairs.ax[i], pairs.ay[i], pairs.bx[i], pairs.by[i], true);
    ++seen;
  }
}

bool TwoViews::find_fundamental(Random& random) {
  const auto threshold2 = static_cast<float>(options_.threshold * options_.threshold);
  const auto solve = [&](const std::array<std::uint32_t, 8>& sample) {
    System system;
    for (int k = 0; k < 8; ++k) system.row(k) = epipolar_row(chosen_, sample[static_cast<std::size_t>(k)]);
    return null_vector(system);
  };
  const int count =
      search<8>(chosen_, {threshold2, options_.iterations, options_.confidence},
                ModelFunctions{solve, epipolar_distances2, refit_fundamental}, random, work_, fundamental_);
  support_ = count / static_cast<double>(chosen_.size());
  return support_ >= options_.support;
}

bool TwoViews::find_homography(Random& random) {
  epipolar_distances2(fundamental_, chosen_, work_);
  const auto threshold2 = static_cast<float>(options_.threshold * options_.threshold);
  supporting_.clear();
  for (std::size_t i = 0; i < chosen_.size(); ++i)
    if (work_[i] <= threshold2) supporting_.add(chosen_.ax[i], chosen_.ay[i], chosen_.bx[i], chosen_.by[i], true);
  const auto parallax2 = static_cast<float>(options_.parallax * options_.parallax);
  const auto solve = [&](const std::array<std::uint32_t, 4>& sample) {
    System system;
    for (int k = 0; k < 4; ++k) {
      const std::array<Row, 2> rows = homography_rows(supporting_, sample[static_cast<std::size_t>(k)]);
      system.row(2 * k) = rows[0], system.row(2 * k + 1) = rows[1];
    }
    return null_vector(system);
  };
  const int without =
      search<4>(supporting_, {parallax2, homography_iterations, options_.confidence},
                ModelFunctions{solve, transfer_distances2, refit_homography}, random, work_, homography_);
  parallax_share_ = 1.0 - without / static_cast<double>(supporting_.size());
  return parallax_share_ >= options_.parallax_share;
}

Verdict TwoViews::estimate(const PointPairs& pairs, Random& random) {
  support_ = parallax_share_ = 0.0;
  choose_trusted(pairs);
  if (chosen_.size() < min_pairs) return Verdict::few_points;
  if (!find_fundamental(random)) return Verdict::no_support;
  if (!find_homography(random)) return Verdict::no_parallax;
  epipolar_distances2(fundamental_, pairs, distance2_);
  return Verdict::usable;
}

}  // namespace holdfast::epipolar_consistency_plugin

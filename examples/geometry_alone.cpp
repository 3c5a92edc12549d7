// SPDX-License-Identifier: BSD-3-Clause
// Holdfast's geometry and matching on somebody else's types: this program has its own camera, keypoints, descriptors,
// landmarks and poses, and links nothing but Eigen. It triangulates landmarks from two views, finds the pose of a third
// view by PnP with RANSAC among wrong matches, searches for the other landmarks around their predicted pixels, and
// refines the pose by motion-only adjustment. It ends with 0 if both poses and the matches are right.
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "holdfast/geometry/pnp.hpp"
#include "holdfast/geometry/triangulation.hpp"
#include "holdfast/matching/guided_search.hpp"

namespace own {

/// One focal length, and the principal point as a vector.
struct Lens {
  float focal_length;
  Eigen::Vector2f centre;
};
/// A descriptor of eight numbers.
using Code = std::array<float, 8>;
struct Keypoint {
  float u, v;
};
/// A camera image reduced to its keypoints; descriptors in an array of their own.
struct Image {
  Lens lens;
  std::vector<Keypoint> keypoints;
  std::vector<Code> codes;
};
using Pose = Eigen::Matrix<double, 3, 4>;  ///< takes world points to the camera

/// Triangulated points, each with the descriptor by which it is recognised.
struct Landmarks {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Code> codes;
};

/// A camera to be localised: match (k, l) says that keypoint k shows landmark l.
struct Localisation {
  struct Match {
    std::uint32_t keypoint, landmark;
    bool fits = false;
  };
  const Image* image = nullptr;
  const Landmarks* landmarks = nullptr;
  std::vector<Match> matches;
  Pose pose = Pose::Identity();
};

Eigen::Isometry3d to_isometry(const Pose& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = pose.leftCols<3>();
  result.translation() = pose.col(3);
  return result;
}
Pose to_pose(const Eigen::Isometry3d& pose) { return pose.matrix().topRows<3>(); }

}  // namespace own

// What Holdfast has to know of these types.

template <>
struct holdfast::geometry::CameraTraits<own::Lens> {
  static Pinhole pinhole(const own::Lens& lens) {
    return {lens.focal_length, lens.focal_length, lens.centre.x(), lens.centre.y()};
  }
};

template <>
struct holdfast::geometry::PoseProblemTraits<own::Localisation> {
  using Problem = own::Localisation;
  static Pinhole pinhole(const Problem& problem) { return pinhole_of(problem.image->lens); }
  static std::size_t size(const Problem& problem) { return problem.matches.size(); }
  static Eigen::Vector3d point(const Problem& problem, std::size_t i) {
    return problem.landmarks->positions[problem.matches[i].landmark];
  }
  static Eigen::Vector2d pixel(const Problem& problem, std::size_t i) {
    const own::Keypoint& keypoint = problem.image->keypoints[problem.matches[i].keypoint];
    return {keypoint.u, keypoint.v};
  }
  static Eigen::Isometry3d pose(const Problem& problem) { return own::to_isometry(problem.pose); }
  static void set_pose(Problem& problem, const Eigen::Isometry3d& pose) { problem.pose = own::to_pose(pose); }
  static void set_inlier(Problem& problem, std::size_t i, bool inlier) { problem.matches[i].fits = inlier; }
};

template <>
struct holdfast::matching::DescriptorTraits<std::span<const own::Code>> {
  using Codes = std::span<const own::Code>;
  using Distance = float;
  static std::size_t size(const Codes& codes) { return codes.size(); }
  static void distances(const Codes& queries, std::uint32_t query, const Codes& references,
                        std::span<const std::uint32_t> candidates, float* distances) {
    for (const std::uint32_t candidate : candidates) {
      float sum = 0.0F;
      for (std::size_t k = 0; k < queries[query].size(); ++k)
        sum += std::abs(queries[query][k] - references[candidate][k]);
      *distances++ = sum;
    }
  }
};

template <>
struct holdfast::matching::ViewTraits<own::Image> {
  using Image = own::Image;
  using Descriptors = std::span<const own::Code>;
  static std::size_t size(const Image& image) { return image.keypoints.size(); }
  static float x(const Image& image, std::uint32_t i) { return image.keypoints[i].u; }
  static float y(const Image& image, std::uint32_t i) { return image.keypoints[i].v; }
  static float right_x(const Image&, std::uint32_t) { return std::numeric_limits<float>::quiet_NaN(); }
  static float angle(const Image&, std::uint32_t) { return 0.0F; }
  static int octave(const Image&, std::uint32_t) { return 0; }
  static Descriptors descriptors(const Image& image) { return image.codes; }
  static void near(const Image& image, float x, float y, float radius, std::vector<std::uint32_t>& found) {
    for (std::uint32_t i = 0; i < image.keypoints.size(); ++i)
      if (std::abs(image.keypoints[i].u - x) <= radius && std::abs(image.keypoints[i].v - y) <= radius)
        found.push_back(i);
  }
  static bool covers(const Image&, float x, float y) { return x >= 0.0F && y >= 0.0F && x < 640.0F && y < 480.0F; }
  static Pinhole camera(const Image& image) { return geometry::pinhole_of(image.lens); }
  static int predict_level(const Image&, double, double) { return 0; }
  static float scale(const Image&, int) { return 1.0F; }
  static float inverse_sigma2(const Image&, int) { return 1.0F; }
};

template <>
struct holdfast::matching::PointTraits<own::Landmarks> {
  using Landmarks = own::Landmarks;
  static std::size_t size(const Landmarks& landmarks) { return landmarks.positions.size(); }
  static Eigen::Vector3f position(const Landmarks& landmarks, std::uint32_t i) {
    return landmarks.positions[i].cast<float>();
  }
  static Eigen::Vector3f direction(const Landmarks& landmarks, std::uint32_t i) {
    return landmarks.positions[i].normalized().cast<float>();
  }
  static float min_distance(const Landmarks&, std::uint32_t) { return 0.5F; }
  static float max_distance(const Landmarks&, std::uint32_t) { return 10.0F; }
};

namespace {

namespace geometry = holdfast::geometry;
namespace matching = holdfast::matching;

constexpr std::uint32_t landmark_count = 150, first_matches = 60, wrong_matches = 25;

/// The room that the cameras see, with noise of half a pixel.
class World {
 public:
  explicit World(const own::Lens& lens) : lens_(lens) {
    std::uniform_real_distribution<double> across(-1.0, 1.0), along(2.0, 4.0);
    std::uniform_real_distribution<float> value(0.0F, 1.0F);
    for (std::uint32_t i = 0; i < landmark_count; ++i) {
      points_.emplace_back(across(random_), across(random_), along(random_));
      own::Code& code = codes_.emplace_back();
      for (float& number : code) number = value(random_);
    }
  }

  own::Image look(const own::Pose& pose) {
    std::normal_distribution<float> pixel_noise(0.0F, 0.5F), code_noise(0.0F, 0.02F);
    own::Image image{lens_, {}, codes_};
    for (const Eigen::Vector3d& point : points_) {
      const Eigen::Vector2f pixel = geometry::pinhole_of(lens_).project(pose * point.homogeneous()).cast<float>();
      image.keypoints.push_back({pixel.x() + pixel_noise(random_), pixel.y() + pixel_noise(random_)});
    }
    for (own::Code& code : image.codes)
      for (float& number : code) number += code_noise(random_);
    return image;
  }

 private:
  own::Lens lens_;
  std::mt19937 random_{1};
  std::vector<Eigen::Vector3d> points_;
  std::vector<own::Code> codes_;
};

own::Pose pose_at(double x, double y, double turn) {
  own::Pose pose;
  pose << Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix(), Eigen::Vector3d(x, y, 0.1);
  return pose;
}

/// Distance of two camera positions [mm].
double distance(const own::Pose& a, const own::Pose& b) {
  return 1e3 * (own::to_isometry(a).inverse().translation() - own::to_isometry(b).inverse().translation()).norm();
}

own::Landmarks triangulate(const own::Image& a, const own::Pose& pose_a, const own::Image& b, const own::Pose& pose_b) {
  own::Landmarks landmarks{{}, a.codes};
  for (std::size_t i = 0; i < a.keypoints.size(); ++i) {
    const geometry::PointView view_a{own::to_isometry(pose_a), {a.keypoints[i].u, a.keypoints[i].v}, 1.0};
    const geometry::PointView view_b{own::to_isometry(pose_b), {b.keypoints[i].u, b.keypoints[i].v}, 1.0};
    landmarks.positions.push_back(geometry::triangulate(a.lens, view_a, view_b).point);
  }
  return landmarks;
}

/// Matches every landmark that the image should show from a pose with the keypoint around its predicted pixel.
std::vector<own::Localisation::Match> search(const own::Image& image, const own::Landmarks& landmarks,
                                             const own::Pose& pose) {
  const matching::ViewProjection<own::Image> projection(image, pose.leftCols<3>(), pose.col(3));
  matching::SearchWindows windows;
  matching::add_windows(
      image, projection, landmarks, {.radius = 8.0F, .frontal_radius = 8.0F}, [](std::uint32_t) { return true; },
      windows);
  matching::GuidedSearch<own::Image> guided_search;
  std::vector<own::Localisation::Match> matches;
  for (const auto& match :
       guided_search.match(image, {windows, landmarks.codes}, {.max_distance = 1.0F, .ratio = 0.8F}))
    matches.push_back({match.feature, match.source});
  return matches;
}

}  // namespace

int main() {
  World world({520.0F, {320.0F, 240.0F}});
  const own::Pose left = pose_at(0.0, 0.0, 0.0), right = pose_at(-0.8, 0.0, 0.1), truth = pose_at(-0.3, 0.1, -0.1);
  const own::Landmarks landmarks = triangulate(world.look(left), left, world.look(right), right);
  const own::Image image = world.look(truth);

  own::Localisation localisation;
  localisation.image = &image;
  localisation.landmarks = &landmarks;
  for (std::uint32_t i = 0; i < first_matches; ++i)
    localisation.matches.push_back({i, i < wrong_matches ? (i + 7) % landmark_count : i});
  const geometry::PoseSummary found = geometry::find_pose(localisation);
  const double first_error = distance(localisation.pose, truth);
  std::printf("PnP with RANSAC: %d of %u matches agree, %u are wrong; %.1f mm from the true position\n", found.inliers,
              first_matches, wrong_matches, first_error);

  localisation.matches = search(image, landmarks, localisation.pose);
  std::size_t right_matches = 0;
  for (const auto& match : localisation.matches) right_matches += match.keypoint == match.landmark;
  const geometry::PoseSummary adjusted = geometry::adjust_pose(localisation);
  const double second_error = distance(localisation.pose, truth);
  std::printf("guided search and adjustment: %zu of %zu matches are right, %d agree; %.1f mm from the true position\n",
              right_matches, localisation.matches.size(), adjusted.inliers, second_error);

  const bool is_right = found.usable && first_error < 20.0 && adjusted.usable && second_error < 10.0 &&
                        right_matches + 15 > landmark_count && right_matches + 3 > localisation.matches.size();
  return is_right ? 0 : 1;
}

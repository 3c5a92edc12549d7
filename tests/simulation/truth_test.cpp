// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "holdfast/simulation/simulator.hpp"
#include "support/same_bytes.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::Contains;
using testing::Not;

// Who is who in the scene below; things follow in the order of the room.
constexpr int carrier = 1, pusher = 2, sitter = 3;

/// A box is carried before the camera from 1 s on; then somebody pushes a chair; a third sits down twice, the second
/// time talking with his hands. The camera sees them all from the back of the room, without sensor effects.
Scene busy_office() {
  Scene scene;
  scene.duration = 34.0;
  scene.camera.path = PathKind::waypoints;
  scene.camera.waypoints = {
      .places = {{2.6, 0.9, 1.5}, {3.4, 0.9, 1.4}}, .closed = false, .speed = 0.2, .target = Vector3d(3.0, 3.6, 0.8)};
  scene.people.resize(3);
  PersonPlan& carries = scene.people[carrier - 1];
  carries.at = {1.8, 3.0};
  carries.start = 1.0;
  carries.repeat = false;
  carries.actions = {Carry{.thing = "box 3", .to = {{2.3, 3.05}, {3.6, 3.05}}, .put_at = {4.7, 3.1, 0.0}, .speed = 0.6},
                     Walk{{{4.6, 1.5}}, 1.0}};
  PersonPlan& pushes = scene.people[pusher - 1];
  pushes.at = {1.3, 3.0};
  pushes.start = 20.0;
  pushes.repeat = false;
  pushes.actions = {Push{.thing = "chair 1", .to = {{2.2, 2.3}}, .speed = 0.4}};
  PersonPlan& sits = scene.people[sitter - 1];
  sits.at = {4.1, 3.1};
  sits.start = -10.0;
  sits.repeat = false;
  sits.actions = {Sit{"chair 2", 14.0, false}, Sit{"chair 2", 10.0, true}};
  scene.colour_sensor.noise = 0.0;
  scene.depth_sensor = {.noise = 0.0,
                        .quantisation = false,
                        .holes = false,
                        .minimum_depth = 0.0,
                        .maximum_depth = 100.0,
                        .edge_holes = 0.0};
  return scene;
}

/// A known camera with a smaller image of the same view.
Camera small(const char* name, int divisor) {
  Camera camera = *find_camera(name);
  camera.width /= divisor, camera.height /= divisor;
  camera.fx /= divisor, camera.fy /= divisor;
  camera.cx = (camera.cx + 0.5) / divisor - 0.5, camera.cy = (camera.cy + 0.5) / divisor - 0.5;
  return camera;
}

bool same_truth(const SensorFrame& a, const SensorFrame& b) {
  return test::same_bytes(a.depth, b.depth) && test::same_bytes(a.truth->object_mask, b.truth->object_mask) &&
         test::same_bytes(a.truth->class_labels, b.truth->class_labels) &&
         a.truth->moving_objects == b.truth->moving_objects &&
         a.truth->T_world_camera->matrix() == b.truth->T_world_camera->matrix();
}

double quantile(std::vector<double> values, double share) {
  const auto nth = values.begin() + static_cast<long>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

const NumberedObject& numbered(const Simulator& simulator, const std::string& name) {
  const auto& all = simulator.numbered_objects();
  return *std::find_if(all.begin(), all.end(),
                       [&](const NumberedObject& candidate) { return simulator.object(candidate).name == name; });
}

const Object& object(const Simulator& simulator, std::string_view name) {
  return simulator.object(numbered(simulator, std::string(name)));
}

std::uint64_t at(double time) { return static_cast<std::uint64_t>(std::lround(30.0 * time)); }

/// From when to when a thing is away from where it was before and where it is after [s].
std::pair<double, double> journey(const Object& thing, double duration) {
  const auto away = [&](double time, double from) {
    const Isometry3d step = thing.pose(from).inverse() * thing.pose(time);
    return step.translation().norm() > 1e-3 || Eigen::AngleAxisd(step.linear()).angle() > 1e-2;
  };
  double from = 0.0, to = duration;
  while (from < duration && !away(from, 0.0)) from += 0.05;
  while (to > 0.0 && !away(to, duration)) to -= 0.05;
  return {from, to};
}

/// While the box is carried, while it is put down, while the chair is pushed.
std::vector<std::uint64_t> telling_frames(const Simulator& simulator) {
  const auto [lifted, put] = journey(object(simulator, "box 3"), 34.0);
  const auto [pushed, left] = journey(object(simulator, "chair 1"), 34.0);
  return {at(0.4 * lifted + 0.6 * put), at(put - 0.5), at(0.4 * pushed + 0.6 * left)};
}

double pelvis_height(const Simulator& simulator, int number, double time) {
  const Object& body = simulator.object(simulator.numbered_objects()[static_cast<std::size_t>(number) - 1]);
  return (body.pose(time) * body.bones(time)[index(Bone::pelvis)]).translation().z();
}

double distance_to_triangle(const Vector3d& point, const Eigen::Matrix3d& corners) {
  const Vector3d cross = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
  if (cross.squaredNorm() < 1e-24) return 1e9;
  const Vector3d normal = cross.normalized();
  double outside = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vector3d from = corners.col(i), to = corners.col((i + 1) % 3);
    outside = std::max(outside, -normal.dot((to - from).normalized().cross(point - from)));
  }
  return std::max(std::abs(normal.dot(point - corners.col(0))), outside);
}

/// The posed triangles of all numbered objects in the camera's frame, by the cells of the image that they touch.
class NumberedSurfaces {
 public:
  NumberedSurfaces(const Simulator& simulator, std::uint64_t frame)
      : camera_(simulator.camera()),
        columns_(camera_.width / cell + 1),
        rows_(camera_.height / cell + 1),
        cells_(static_cast<std::size_t>(columns_) * rows_) {
    const Isometry3d T_camera_world = simulator.T_world_camera(frame).inverse();
    std::vector<PosedVertex> posed;
    for (const NumberedObject& each : simulator.numbered_objects()) {
      const Object& object = simulator.object(each);
      pose_vertices(object, simulator.timestamp(frame), posed);
      for (const Triangle& triangle : object.mesh.triangles) {
        Face face;
        face.number = each.number;
        int corner = 0;
        for (const std::uint32_t i : {triangle.a, triangle.b, triangle.c})
          face.corners.col(corner++) = T_camera_world * posed[i].position.cast<double>();
        face.shown = face.corners.determinant() > 1e-15;  // else turned away
        if (face.shown) face.inverse = face.corners.inverse();
        add(face);
      }
    }
  }

  /// Whether a point that is seen at a raw pixel is within a distance of the surface of an object.
  bool near(int x, int y, const Vector3d& point, int number, double tolerance) const {
    const std::vector<std::size_t>& here = at(x, y);
    return std::any_of(here.begin(), here.end(), [&](std::size_t i) {
      return faces_[i].number == number && distance_to_triangle(point, faces_[i].corners) <= tolerance;
    });
  }

  /// Number and depth of what the ray (x, y, 1) of a pixel meets first; 0 when nothing numbered is there.
  std::pair<int, double> first(int x, int y, const Vector3d& ray) const {
    std::pair<int, double> result{0, 1e9};
    for (const std::size_t i : at(x, y)) {
      const Face& face = faces_[i];
      if (!face.shown) continue;
      const Vector3d shares = face.inverse * ray;
      if (shares.minCoeff() < 0.0) continue;
      const double depth = 1.0 / shares.sum();
      if (depth > 0.05 && depth < result.second) result = {face.number, depth};
    }
    return result;
  }

 private:
  static constexpr int cell = 4;  // [px]

  struct Face {
    Eigen::Matrix3d corners, inverse;
    int number = 0;
    bool shown = false;
  };

  void add(const Face& face) {
    Eigen::AlignedBox2d box;
    for (int i = 0; i < 3; ++i)
      box.extend(face.corners(2, i) > 0.05 ? camera_.distort(camera_.project(face.corners.col(i))) : Vector2d(0, 0));
    if (face.corners.row(2).minCoeff() <= 0.05) box.extend(Vector2d(camera_.width, camera_.height));
    const auto column = [&](double x) { return std::clamp(static_cast<int>(x) / cell, 0, columns_ - 1); };
    const auto row = [&](double y) { return std::clamp(static_cast<int>(y) / cell, 0, rows_ - 1); };
    for (int y = row(box.min().y() - 1.5); y <= row(box.max().y() + 1.5); ++y)
      for (int x = column(box.min().x() - 1.5); x <= column(box.max().x() + 1.5); ++x)
        cells_[static_cast<std::size_t>(y) * columns_ + x].push_back(faces_.size());
    faces_.push_back(face);
  }
  const std::vector<std::size_t>& at(int x, int y) const {
    return cells_[static_cast<std::size_t>(y / cell) * columns_ + x / cell];
  }

  const Camera& camera_;
  int columns_, rows_;
  std::vector<Face> faces_;
  std::vector<std::vector<std::size_t>> cells_;  // numbers of faces
};

/// Depth at a position between pixels that all show the same surface; 0 elsewhere. Inverse depth is linear on planes.
double depth_between(const cv::Mat& depth, const Vector2d& position) {
  const int x = static_cast<int>(std::floor(position.x())), y = static_cast<int>(std::floor(position.y()));
  if (x < 0 || y < 0 || x + 1 >= depth.cols || y + 1 >= depth.rows) return 0.0;
  const double right = position.x() - x, down = position.y() - y;
  double inverse = 0.0, least = 1e9, most = 0.0;
  for (const int dy : {0, 1})
    for (const int dx : {0, 1}) {
      const double value = 1.0 / depth.at<float>(y + dy, x + dx);
      least = std::min(least, value), most = std::max(most, value);
      inverse += (dx ? right : 1.0 - right) * (dy ? down : 1.0 - down) * value;
    }
  return most < 1.03 * least ? 1.0 / inverse : 0.0;
}

/// Differences in depth between the pixels of one frame with a number, moved with T_to_from into another frame (camera
/// to camera), and what is seen there of the same number [m].
std::vector<double> warped_differences(const Camera& camera, const SensorFrame& from, const SensorFrame& to, int number,
                                       const Isometry3d& T_to_from) {
  std::vector<double> differences;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      if (from.truth->object_mask.at<std::uint8_t>(y, x) != number) continue;
      const Vector3d point = T_to_from * camera.back_project(x, y, from.depth.at<float>(y, x));
      if (point.z() < 0.1) continue;
      const Vector2d pixel = camera.project(point);
      const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
      if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
      if (to.truth->object_mask.at<std::uint8_t>(v, u) != number) continue;
      const double depth = depth_between(to.depth, pixel);
      if (depth > 0.0) differences.push_back(std::abs(depth - point.z()));
    }
  return differences;
}

// Without distortion the ray through a pixel's centre tells exactly which object is there and how far.
TEST(Truth, EveryPixelShowsTheObjectThatItsRayMeetsFirst) {
  Simulator simulator(busy_office(), small("tum_fr3", 2));
  const Camera& camera = simulator.camera();
  std::array<int, 256> pixels{};
  for (const std::uint64_t index : telling_frames(simulator)) {
    const SensorFrame frame = simulator.frame(index);
    const NumberedSurfaces surfaces(simulator, index);
    int wrong_number = 0, wrong_depth = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const int number = frame.truth->object_mask.at<std::uint8_t>(y, x);
        const double depth = frame.depth.at<float>(y, x);
        ++pixels[static_cast<std::size_t>(number)];
        const auto [first, nearest] = surfaces.first(x, y, camera.back_project(x, y, 1.0));
        if (number == 0)  // nothing numbered is nearer than the static world
          wrong_number += nearest < depth - 1e-5;
        else if (number != first)
          ++wrong_number;
        else
          wrong_depth += std::abs(nearest - depth) > 1e-5;
      }
    EXPECT_EQ(wrong_number, 0) << "frame " << index;
    EXPECT_EQ(wrong_depth, 0) << "frame " << index;
  }
  for (const NumberedObject& each : simulator.numbered_objects())
    EXPECT_GT(pixels[each.number], 500) << simulator.object(each).name;
}

TEST(Truth, EveryPixelOfAnObjectLiesOnItsPosedSurfaceWithDistortionToo) {
  Simulator simulator(busy_office(), small("tum_fr1", 4));
  const Camera& camera = simulator.camera();
  std::array<int, 256> pixels{};
  for (const std::uint64_t index : telling_frames(simulator)) {
    const SensorFrame frame = simulator.frame(index);
    const cv::Mat cosine = simulator.render(index).cosine;
    const NumberedSurfaces surfaces(simulator, index);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const int number = frame.truth->object_mask.at<std::uint8_t>(y, x);
        if (number == 0) continue;
        ++pixels[static_cast<std::size_t>(number)];
        const double depth = frame.depth.at<float>(y, x);
        const Vector2d pixel = camera.undistort({x, y});
        // Visibility is found in the undistorted plane: up to a quarter of a pixel beyond an edge.
        const double pixel_size = depth / camera.fx / std::max(0.1F, cosine.at<float>(y, x));
        EXPECT_TRUE(surfaces.near(x, y, camera.back_project(pixel.x(), pixel.y(), depth), number, 0.4 * pixel_size))
            << "frame " << index << ", object " << number << " at " << x << ' ' << y;
      }
  }
  for (const NumberedObject& each : simulator.numbered_objects())
    EXPECT_GT(pixels[each.number], 100) << simulator.object(each).name;
}

TEST(Truth, DepthOfOneFrameAgreesWithAnotherOnWhatIsStaticAndOnWhatMovesRigidly) {
  Simulator simulator(busy_office(), small("tum_fr3", 2));
  const Camera& camera = simulator.camera();
  for (const char* thing : {"box 3", "chair 1"}) {
    const Object& moved = object(simulator, thing);
    const auto [start, end] = journey(moved, 34.0);
    const std::uint64_t one = at(0.3 * start + 0.7 * end), other = one + 9;
    const SensorFrame from = simulator.frame(one), to = simulator.frame(other);
    const Isometry3d T_to_world = simulator.T_world_camera(other).inverse(),
                     T_world_from = simulator.T_world_camera(one);

    const std::vector<double> still = warped_differences(camera, from, to, 0, T_to_world * T_world_from);
    ASSERT_GT(still.size(), 20000U);
    EXPECT_LT(quantile(still, 0.5), 1e-5) << thing;
    EXPECT_LT(quantile(still, 0.9), 1e-4) << thing;  // surfaces of all directions: a wrong pose shows in some

    const Isometry3d motion = moved.pose(to.timestamp) * moved.pose(from.timestamp).inverse();
    EXPECT_GT((motion.translation()).norm(), 0.05) << thing;
    const int number = numbered(simulator, thing).number;
    const std::vector<double> rigid = warped_differences(camera, from, to, number, T_to_world * motion * T_world_from);
    ASSERT_GT(rigid.size(), 200U) << thing;
    EXPECT_LT(quantile(rigid, 0.5), 1e-5) << thing;
    if (moved.class_name == "chair") {  // it rolls towards the camera: without its motion there would be no agreement
      EXPECT_GT(quantile(warped_differences(camera, from, to, number, T_to_world * T_world_from), 0.5), 2e-2);
    }
  }
}

TEST(Truth, LabelsAndMaskTellTheSameStory) {
  Simulator simulator(busy_office(), small("tum_fr1", 2));
  const std::vector<std::string>& names = simulator.class_names();
  ASSERT_EQ(simulator.numbered_objects().size(), 5U);
  for (const double time : {0.0, 6.0, 24.0}) {
    const SensorFrame frame = simulator.frame(at(time));
    int wrong = 0, numbered = 0;
    for (int y = 0; y < frame.depth.rows; ++y)
      for (int x = 0; x < frame.depth.cols; ++x) {
        const int number = frame.truth->object_mask.at<std::uint8_t>(y, x);
        const int label = frame.truth->class_labels.at<std::uint8_t>(y, x);
        ASSERT_LT(label, static_cast<int>(names.size()));
        ASSERT_LE(number, 5);
        wrong += !(frame.depth.at<float>(y, x) > 0.0F);  // the room is closed
        if (number == 0) {
          wrong += label == 0 || names[label] == "person";
        } else {
          ++numbered;
          wrong += names[label] != simulator.object(simulator.numbered_objects()[number - 1]).class_name;
        }
      }
    EXPECT_EQ(wrong, 0) << time;
    EXPECT_GT(numbered, 2000) << time;
  }
}

TEST(Truth, TellsWhatMovesAtTheMoment) {
  Simulator simulator(busy_office(), small("tum_fr3", 10));
  const auto moving = [&](double time) { return simulator.frame(at(time)).truth->moving_objects; };
  const int box = numbered(simulator, "box 3").number, chair = numbered(simulator, "chair 1").number;

  const auto [lifted, put] = journey(object(simulator, "box 3"), 34.0);
  EXPECT_GT(lifted, 2.0);
  EXPECT_LT(put, 21.0);
  EXPECT_LT((object(simulator, "box 3").pose(put + 0.1).translation() - Vector3d(4.7, 3.1, 0.0)).norm(), 1e-3);
  for (const double time : {0.0, 0.5, lifted - 0.2, put + 0.2, put + 2.0, 33.0})
    EXPECT_THAT(moving(time), Not(Contains(box))) << time;
  int under_way = 0;  // the carrier stops to turn
  for (int i = 1; i < 10; ++i) {
    const std::vector<std::uint8_t> all = moving(lifted + 0.1 * i * (put - lifted));
    under_way += static_cast<int>(std::count(all.begin(), all.end(), box));
  }
  EXPECT_GE(under_way, 6);

  const auto [pushed, left] = journey(object(simulator, "chair 1"), 34.0);
  EXPECT_GT(pushed, 20.0);
  for (const double time : {0.0, 10.0, pushed - 0.2, left + 0.2})
    EXPECT_THAT(moving(time), Not(Contains(chair))) << time;
  EXPECT_THAT(moving(0.5 * (pushed + left)), testing::AllOf(Contains(chair), Contains(pusher)));

  // Who waits only breathes; who sits likewise, unless he talks with his hands.
  EXPECT_THAT(moving(0.5), Not(Contains(carrier)));
  EXPECT_THAT(moving(10.0), Not(Contains(pusher)));
  std::vector<std::pair<double, double>> seated;
  for (double time = 0.0; time < 34.0; time += 0.1)
    if (pelvis_height(simulator, sitter, time) < 0.7) {
      if (seated.empty() || time - seated.back().second > 0.15) seated.emplace_back(time, time);
      seated.back().second = time;
    }
  ASSERT_EQ(seated.size(), 2U);
  int while_silent = 0, while_talking = 0;
  for (const double share : {0.25, 0.35, 0.45, 0.5, 0.55, 0.65, 0.7, 0.75}) {
    const auto at_share = [&](std::size_t k) {
      const std::vector<std::uint8_t> all = moving(seated[k].first + share * (seated[k].second - seated[k].first));
      return std::count(all.begin(), all.end(), sitter) > 0;
    };
    while_silent += at_share(0), while_talking += at_share(1);
  }
  EXPECT_EQ(while_silent, 0);
  EXPECT_GE(while_talking, 6);
  EXPECT_THAT(moving(seated[0].second + 0.2), Contains(sitter));  // stands up
  // Numbers rise, and nobody is named twice.
  const std::vector<std::uint8_t> all = moving(0.5 * (lifted + put));
  EXPECT_TRUE(std::adjacent_find(all.begin(), all.end(), std::greater_equal<>()) == all.end());
}

TEST(Truth, FramesAreTheSameBytesInAnyOrder) {
  Scene scene = busy_office();
  scene.colour_sensor = {.noise = 2.0, .exposure_change = 0.4, .vignetting = 0.2, .shutter = 0.01};
  scene.depth_sensor = {};
  Simulator one(scene, small("tum_fr1", 4)), other(scene, small("tum_fr1", 4));
  std::vector<SensorFrame> frames;
  for (const std::uint64_t index : {150, 151, 720}) frames.push_back(one.frame(index));
  for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) {
    const SensorFrame again = other.frame(frame->index);
    EXPECT_TRUE(test::same_bytes(again.colour, frame->colour)) << frame->index;
    EXPECT_TRUE(same_truth(again, *frame)) << frame->index;
  }
  EXPECT_FALSE(test::same_bytes(frames[0].truth->object_mask, frames[1].truth->object_mask));
}

double sharpness(const cv::Mat& colour) {
  double sum = 0.0;
  for (int y = 0; y < colour.rows; ++y)
    for (int x = 1; x < colour.cols; ++x)
      sum += std::pow(colour.at<cv::Vec3b>(y, x)[1] - colour.at<cv::Vec3b>(y, x - 1)[1], 2);
  return sum / (colour.rows * (colour.cols - 1));
}

TEST(Truth, DarknessAndAnOpenShutterChangeColourAlone) {
  Scene scene = busy_office();
  scene.depth_sensor = {};
  scene.camera.path = PathKind::rpy;
  scene.camera.style.speed = 2.0;
  Simulator plain(scene, small("tum_fr3", 4));
  scene.lights_out = {{.from = 10.0, .to = 11.0}};
  scene.colour_sensor.shutter = 0.06;
  Simulator special(scene, small("tum_fr3", 4));
  double sharp_edges = 0.0, blurred_edges = 0.0;
  for (const std::uint64_t index : {200, 300, 329, 330}) {
    const SensorFrame sharp = plain.frame(index), frame = special.frame(index);
    EXPECT_TRUE(same_truth(sharp, frame)) << index;
    EXPECT_GT(cv::countNonZero(frame.depth), 0.7 * 160 * 120) << index;
    const cv::Scalar light = cv::mean(frame.colour), full = cv::mean(sharp.colour);
    if (index >= 300 && index < 330) {
      EXPECT_LT(light[0] + light[1] + light[2], 3.0) << index;
    } else {
      EXPECT_NEAR(light[1], full[1], 0.05 * full[1]) << index;
      sharp_edges += sharpness(sharp.colour), blurred_edges += sharpness(frame.colour);
    }
  }
  EXPECT_LT(blurred_edges, 0.9 * sharp_edges);
}

}  // namespace
}  // namespace holdfast::simulation

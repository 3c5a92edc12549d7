// SPDX-License-Identifier: BSD-3-Clause
#include "motion_objects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "holdfast/geometry/so3.hpp"
#include "support/box_world.hpp"

namespace holdfast::motion_objects_plugin {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::BoxWorld;

constexpr double frame_interval = 1.0 / 30.0;

Camera camera() {
  Camera camera = *find_camera("tum_fr3");
  camera.distortion = {};
  return camera;
}

/// A textured ball before nothing, as an image in blocks.
depth_blocks::DepthView ball(const BlockGrid& grid, const Vector3f& centre, const Eigen::Matrix3f& R_world_ball,
                             std::vector<std::uint32_t>* owner, std::uint32_t name) {
  constexpr float radius = 0.45F;
  depth_blocks::DepthView view;
  view.depth.assign(static_cast<std::size_t>(grid.size()), 0.0F);
  view.grey.assign(view.depth.size(), 0.0F);
  if (owner != nullptr) owner->assign(view.depth.size(), 0);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const Vector3f ray(grid.ray_x[static_cast<std::size_t>(column)], grid.ray_y[static_cast<std::size_t>(row)], 1.0F);
      const float a = ray.squaredNorm(), b = ray.dot(centre), c = centre.squaredNorm() - radius * radius;
      const float root = b * b - a * c;
      if (root <= 0.0F) continue;
      const std::size_t block = static_cast<std::size_t>(row * grid.columns + column);
      view.depth[block] = (b - std::sqrt(root)) / a;
      const Vector3f on_ball = R_world_ball.transpose() * (view.depth[block] * ray - centre);
      view.grey[block] = 128.0F + 50.0F * std::sin(12.0F * on_ball.x()) + 50.0F * std::sin(10.0F * on_ball.y() + 1.0F);
      if (owner != nullptr) (*owner)[block] = name;
    }
  return view;
}

TEST(RigidAlignment, FindsTheMotionOfATexturedBall) {
  const depth_blocks::ViewMaker maker(camera());
  const BlockGrid& grid = maker.grid();
  constexpr std::uint32_t name = 7;
  const Vector3f centre_then(0.05F, -0.1F, 2.0F);
  std::vector<std::uint32_t> owner;
  const auto then = ball(grid, centre_then, Eigen::Matrix3f::Identity(), &owner, name);
  const RigidAlignment alignment(grid, {0.008F, 0.004F});
  for (const Vector3f& moved : {Vector3f(0.06F, 0.02F, -0.04F), Vector3f(-0.05F, 0.03F, 0.05F), Vector3f(0, 0, 0)}) {
    const Vector3d turned(0.05, -0.08, 0.06);
    const Eigen::Matrix3f R = geometry::exp_so3(turned).toRotationMatrix().cast<float>();
    const Vector3f centre_now = centre_then + moved;
    const auto now = ball(grid, centre_now, R, nullptr, name);
    ObjectPoints points;
    points.centre = centre_now;
    for (int block = 0; block < grid.size(); ++block) {
      const std::size_t i = static_cast<std::size_t>(block);
      if (now.depth[i] <= 0.0F) continue;
      points.points.emplace_back(now.depth[i] * grid.ray_x[i % static_cast<std::size_t>(grid.columns)],
                                 now.depth[i] * grid.ray_y[i / static_cast<std::size_t>(grid.columns)], now.depth[i]);
      points.grey.push_back(now.grey[i]);
    }
    const AlignmentResult result = alignment.align(points, then, {owner, name}, {}, {});
    EXPECT_GT(result.inliers, 100);
    EXPECT_LT((result.motion.translation + moved).norm(), 0.006F) << moved.transpose();
    const Vector3d back = geometry::log_so3(Eigen::Matrix3d(result.motion.rotation.cast<double>()));
    EXPECT_LT((back + turned).norm(), 0.025) << moved.transpose();
    EXPECT_LT(result.covariance.diagonal().maxCoeff(), 0.01F * 0.01F);
    // What belongs to something else does not count.
    const AlignmentResult other = alignment.align(points, then, {owner, name + 1}, {}, {});
    EXPECT_EQ(other.inliers, 0);
    EXPECT_LT(other.motion.translation.norm(), 1e-4F);
    EXPECT_GT(other.covariance.diagonal().minCoeff(), 0.5F);
  }
}

/// Frames of a world of boxes that change with time, of which an earlier filter suspects those with a label.
class MotionObjectsTest : public testing::Test {
 protected:
  using WorldAt = std::function<BoxWorld(double time)>;
  using PoseAt = std::function<Isometry3d(double time)>;

  struct Seen {
    double time;
    Frame frame;
    StaticEvidence evidence;
    std::vector<std::uint8_t> labels;
    const std::vector<MovingObject>& objects() const { return evidence.objects(); }
  };

  /// The frame index must rise by one from call to call.
  Seen show(MotionObjects& filter, const BoxWorld& world, const Isometry3d& T_world_camera, double time,
            const std::vector<std::string>* classes = nullptr) {
    Seen seen;
    seen.time = time;
    seen.frame = world.frame(T_world_camera, time, 20);
    seen.frame.index = next_index_++;
    world.view(T_world_camera, &seen.labels);
    const std::size_t before = seen.frame.size();
    seen.evidence.reset(before, seen.labels.size());
    seen.evidence.begin_stage("earlier");
    for (std::size_t i = 0; i < seen.labels.size(); ++i)
      if (seen.labels[i] != 0) seen.evidence.add_cell(i, -4.0F);
    seen.evidence.begin_stage("motion_objects");
    SensorFrame image;
    image.colour = colour_;
    if (classes != nullptr) {
      seen.frame.coarse.mask.labels = seen.labels;
      seen.frame.coarse.mask.confidence.assign(seen.labels.size(), 255);
      if (are_instances_) {
        seen.frame.coarse.mask.instances.assign(seen.labels.begin(), seen.labels.end());
        for (std::uint8_t& label : seen.frame.coarse.mask.labels) label = label == 0 ? 0 : 1;
      }
    }
    filter.apply({.sensor_frame = image,
                  .frame = seen.frame,
                  .previous = previous_.camera ? &previous_ : nullptr,
                  .map = map_,
                  .T_camera_world = &seen.frame.T_camera_world,
                  .classes = classes},
                 seen.evidence);
    previous_ = seen.frame;
    return seen;
  }
  std::vector<Seen> run(MotionObjects& filter, const WorldAt& world, const PoseAt& pose, double duration,
                        const std::vector<std::string>* classes = nullptr) {
    std::vector<Seen> all;
    for (double time = 0.0; time < duration; time += frame_interval)
      all.push_back(show(filter, world(time), pose(time), time, classes));
    return all;
  }
  static BoxWorld room() {
    BoxWorld world;
    world.camera = camera();
    world.wall_z = 4.0;
    return world;
  }
  static Isometry3d still(double) { return Isometry3d::Identity(); }
  static Isometry3d wandering(double time) {
    Isometry3d pose(Eigen::AngleAxisd(0.06 * std::sin(2.0 * time), Vector3d::UnitY()));
    pose.translation() = Vector3d(0.1 * std::sin(1.5 * time), 0.05 * std::sin(2.5 * time), 0.1 * time);
    return pose;
  }
  MotionObjects filter() const {
    CreationContext context;
    context.camera = camera();
    return MotionObjects({}, context);
  }

  bool are_instances_ = false;  ///< labels of the world are instances of one class in the masks
  Map map_;
  cv::Mat colour_{480, 640, CV_8UC3, cv::Scalar::all(100)};
  Frame previous_;
  std::uint64_t next_index_ = 0;
};

TEST_F(MotionObjectsTest, WhatMovesIsReportedWithItsVelocityWhateverTheCameraDoes) {
  const Vector3d velocity(0.4, 0.0, -0.2);
  const auto world = [&](double time) {
    BoxWorld result = room();
    result.boxes.push_back(BoxWorld::box(Vector3d(-0.6, 0.1, 2.6) + time * velocity, {0.25, 0.4, 0.2}));
    return result;
  };
  for (const PoseAt& pose : {PoseAt(still), PoseAt(wandering)}) {
    auto tracker = filter();
    const std::vector<Seen> all = run(tracker, world, pose, 2.0);
    for (const Seen& seen : all) {
      if (seen.time < 0.2) {
        EXPECT_TRUE(seen.objects().empty()) << seen.time;
      }
      if (seen.time < 1.0) continue;
      ASSERT_EQ(seen.objects().size(), 1U) << seen.time;
      const MovingObject& object = seen.objects().front();
      EXPECT_EQ(object.id, 1U);
      EXPECT_TRUE(object.moving);
      EXPECT_EQ(object.class_name, "");
      EXPECT_EQ(object.last_seen, seen.time);
      EXPECT_LT((object.velocity - velocity).norm(), 0.1) << seen.time << ": " << object.velocity.transpose();
      // The middle of what is seen lies on the front.
      const Vector3d front = Vector3d(-0.6, 0.1, 2.4) + seen.time * velocity;
      EXPECT_LT((object.T_world_object.translation() - front).norm(), 0.08) << seen.time;
      EXPECT_NEAR(object.box.sizes().x(), 0.5F, 0.15F);
      EXPECT_NEAR(object.box.sizes().y(), 0.8F, 0.15F);
      EXPECT_LT(Eigen::AngleAxisd(object.T_world_object.linear()).angle(), 0.15);
      int on = 0, said_on = 0, said_off = 0;
      for (std::size_t i = 0; i < seen.frame.size(); ++i) {
        const auto cell = seen.frame.coarse.grid.cell_of(seen.frame.x[i], seen.frame.y[i]);
        const bool moves = seen.labels[static_cast<std::size_t>(cell)] != 0;
        const float said = seen.evidence.measurement(i);
        EXPECT_LE(said, 0.0F);
        on += moves ? 1 : 0;
        if (said < 0.0F) ++(moves ? said_on : said_off);
      }
      EXPECT_GE(said_on, 0.8 * on);
      EXPECT_LE(said_off, 0.4 * on);  // at the outline: a block has one depth
    }
  }
}

TEST_F(MotionObjectsTest, WhatOnlyCouldMoveIsNoObject) {
  const auto world = [](double) {
    BoxWorld result = room();
    result.boxes = {BoxWorld::box({-0.5, 0.1, 2.0}, {0.25, 0.4, 0.2}), BoxWorld::box({0.6, 0.3, 2.6}, {0.3, 0.5, 0.2})};
    return result;
  };
  auto tracker = filter();
  for (const Seen& seen : run(tracker, world, wandering, 1.5)) {
    EXPECT_TRUE(seen.objects().empty()) << seen.time;
    EXPECT_TRUE(seen.evidence.contributions().empty()) << seen.time;
  }
  EXPECT_EQ(tracker.tracks().size(), 2U);
}

TEST_F(MotionObjectsTest, TwoThatPassEachOtherKeepTheirIds) {
  const auto world = [](double time) {
    BoxWorld result = room();
    result.boxes = {BoxWorld::box({-0.7 + 0.6 * time, 0.0, 1.7}, {0.15, 0.4, 0.1}),
                    BoxWorld::box({0.8 - 0.6 * time, 0.0, 2.5}, {0.2, 0.5, 0.1})};
    return result;
  };
  auto tracker = filter();
  std::set<std::uint32_t> ids;
  std::uint32_t near = 0, far = 0;
  for (const Seen& seen : run(tracker, world, still, 2.5))
    for (const MovingObject& object : seen.objects()) {
      ids.insert(object.id);
      const bool is_near = object.T_world_object.translation().z() < 2.0;
      std::uint32_t& expected = is_near ? near : far;
      if (expected == 0) expected = object.id;
      EXPECT_EQ(object.id, expected) << seen.time;
      if (object.last_seen == seen.time) {
        EXPECT_NEAR(object.velocity.x(), is_near ? 0.6 : -0.6, seen.time < 0.5 ? 0.4 : 0.2) << seen.time;
      }
    }
  EXPECT_EQ(ids.size(), 2U);
  EXPECT_NE(near, far);
}

TEST_F(MotionObjectsTest, WhatComesToRestIsStaticAgainAndKeepsItsId) {
  const auto world = [](double time) {
    BoxWorld result = room();
    const double moved = time < 1.0 ? time : time < 4.0 ? 1.0 : time - 3.0;
    result.boxes.push_back(BoxWorld::box({-0.4 + 0.4 * moved, 0.1, 2.2}, {0.25, 0.4, 0.2}));
    return result;
  };
  auto tracker = filter();
  for (const Seen& seen : run(tracker, world, still, 5.1)) {
    if (seen.time < 0.6) continue;
    ASSERT_EQ(seen.objects().size(), 1U) << seen.time;
    EXPECT_EQ(seen.objects().front().id, 1U);
    const auto& statements = seen.evidence.contributions();
    if (seen.time > 0.6 && seen.time < 0.95) {
      EXPECT_TRUE(!statements.empty() && statements.front().log_odds < 0.0F) << seen.time;
    }
    if (seen.time > 1.5 && seen.time < 1.9) {
      EXPECT_FALSE(seen.objects().front().moving);
      EXPECT_TRUE(statements.empty());
    }
    if (seen.time > 3.0 && seen.time < 4.0) {
      EXPECT_LT(seen.objects().front().speed(), 0.03);
      EXPECT_TRUE(!statements.empty() && statements.front().log_odds > 0.0F) << seen.time;
    }
    if (seen.time > 4.9) {
      EXPECT_TRUE(seen.objects().front().moving) << seen.time;
    }
  }
}

TEST_F(MotionObjectsTest, MasksNameObjectsAndTellThemApart) {
  // A person carries a box before the body: one surface goes on in the other, and both move alike.
  const std::vector<std::string> classes{"background", "person", "box"};
  const auto world = [](double time) {
    BoxWorld result = room();
    const double x = -0.5 + 0.4 * time;
    result.boxes = {BoxWorld::box({x, 0.0, 2.2}, {0.2, 0.7, 0.15}, 1),
                    BoxWorld::box({x + 0.4, 0.1, 2.2}, {0.2, 0.2, 0.15}, 2)};
    return result;
  };
  auto tracker = filter();
  const Seen last = run(tracker, world, still, 1.2, &classes).back();
  ASSERT_EQ(last.objects().size(), 2U);
  std::set<std::string> names;
  for (const MovingObject& object : last.objects()) names.insert(object.class_name);
  EXPECT_EQ(names, (std::set<std::string>{"person", "box"}));
}

TEST_F(MotionObjectsTest, InstancesOfOneClassAreToldApart) {
  // Two people side by side, of one class: one surface goes on in the other, and both move alike.
  const std::vector<std::string> classes{"background", "person"};
  const auto world = [](double time) {
    BoxWorld result = room();
    const double x = -0.5 + 0.4 * time;
    result.boxes = {BoxWorld::box({x, 0.0, 2.2}, {0.2, 0.7, 0.15}, 1),
                    BoxWorld::box({x + 0.4, 0.1, 2.2}, {0.2, 0.6, 0.15}, 2)};
    return result;
  };
  are_instances_ = true;
  auto tracker = filter();
  std::set<std::pair<std::uint32_t, int>> ids;  // of objects, with their instances
  for (const Seen& seen : run(tracker, world, still, 1.2, &classes)) {
    if (seen.time < 0.8) continue;
    EXPECT_EQ(seen.objects().size(), 2U) << seen.time;
    for (const MovingObject& object : seen.objects()) {
      ids.insert({object.id, object.instance});
      EXPECT_EQ(object.class_name, "person");
    }
  }
  ASSERT_EQ(ids.size(), 2U);
  EXPECT_EQ(ids.begin()->second + ids.rbegin()->second, 3) << "each has an instance of its own";
}

TEST_F(MotionObjectsTest, HiddenObjectsCoastAreForgottenAndTheirIdsNotUsedAgain) {
  const auto world = [](double time) {
    BoxWorld result = room();
    const bool gone = time >= 1.0 && time < 2.8;
    if (!gone) result.boxes.push_back(BoxWorld::box({-0.4 + 0.4 * time, 0.1, 2.2}, {0.2, 0.4, 0.2}));
    return result;
  };
  auto tracker = filter();
  for (const Seen& seen : run(tracker, world, still, 3.8)) {
    if (seen.time > 1.02 && seen.time < 1.8) {
      ASSERT_EQ(seen.objects().size(), 1U) << seen.time;
      EXPECT_LT(seen.objects().front().last_seen, 1.01);
      EXPECT_GT(seen.objects().front().T_world_object.translation().x(), -0.02);
      EXPECT_TRUE(seen.evidence.contributions().empty());
    }
    if (seen.time > 2.1 && seen.time < 2.9) {
      EXPECT_TRUE(seen.objects().empty()) << seen.time;
    }
    if (seen.time > 3.6) {
      ASSERT_EQ(seen.objects().size(), 1U);
      EXPECT_EQ(seen.objects().front().id, 2U);
    }
  }
}

TEST_F(MotionObjectsTest, ObjectsMoveWithAMapThatIsCorrected) {
  const auto world = [](double time) {
    BoxWorld result = room();
    result.boxes.push_back(BoxWorld::box({-0.6 + 0.4 * time, 0.1, 2.2}, {0.25, 0.4, 0.2}));
    return result;
  };
  auto tracker = filter();
  const Seen before = run(tracker, world, still, 1.0).back();
  ASSERT_EQ(before.objects().size(), 1U);
  Isometry3d T_new_old(Eigen::AngleAxisd(0.3, Vector3d::UnitY()));
  T_new_old.translation() = Vector3d(0.5, 0.2, -0.3);
  previous_.T_camera_world = previous_.T_camera_world * T_new_old.inverse();
  Seen after;
  for (int i = 1; i < 4; ++i) {
    // What the camera sees is as before; only the poses' world is another.
    const double time = before.time + i * frame_interval;
    after = Seen();
    after.frame = world(time).frame(Isometry3d::Identity(), time, 20);
    after.frame.index = next_index_++;
    after.frame.T_camera_world = T_new_old.inverse();
    world(time).view(Isometry3d::Identity(), &after.labels);
    after.evidence.reset(after.frame.size(), after.labels.size());
    for (std::size_t cell = 0; cell < after.labels.size(); ++cell)
      if (after.labels[cell] != 0) after.evidence.add_cell(cell, -4.0F);
    after.evidence.begin_stage("motion_objects");
    SensorFrame image;
    image.colour = colour_;
    tracker.apply({.sensor_frame = image,
                   .frame = after.frame,
                   .previous = &previous_,
                   .map = map_,
                   .T_camera_world = &after.frame.T_camera_world},
                  after.evidence);
    previous_ = after.frame;
  }
  ASSERT_EQ(after.objects().size(), 1U);
  EXPECT_EQ(after.objects().front().id, before.objects().front().id);
  const Vector3d expected = T_new_old * Vector3d(before.objects().front().T_world_object.translation() +
                                                 3 * frame_interval * Vector3d(0.4, 0, 0));
  EXPECT_LT((after.objects().front().T_world_object.translation() - expected).norm(), 0.03);
  EXPECT_LT((after.objects().front().velocity - T_new_old.linear() * Vector3d(0.4, 0, 0)).norm(), 0.06);
}

TEST_F(MotionObjectsTest, SaysNothingOfWhatItCannotSee) {
  auto tracker = filter();
  // Nothing but a wall, all of it suspected.
  for (int i = 0; i < 20; ++i) {
    BoxWorld world = room();
    world.boxes.push_back(BoxWorld::box({0, 0, 3.5}, {9, 9, 0.5}));
    const Seen seen = show(tracker, world, wandering(i * frame_interval), i * frame_interval);
    EXPECT_TRUE(seen.objects().empty());
    EXPECT_TRUE(seen.evidence.contributions().empty());
  }
  // No depth at all, no view, no evidence, no pose.
  const auto apply = [&](const std::function<void(Frame&, StaticEvidence&)>& change, bool with_pose) {
    Frame frame = room().frame(Isometry3d::Identity(), 10.0 + static_cast<double>(next_index_), 20);
    frame.index = next_index_++;
    StaticEvidence evidence(frame.size(), frame.coarse.depth.size());
    evidence.begin_stage("motion_objects");
    for (std::size_t i = 0; i < frame.coarse.depth.size(); ++i) evidence.add_cell(i, -4.0F);
    change(frame, evidence);
    SensorFrame image;
    image.colour = colour_;
    tracker.apply({.sensor_frame = image,
                   .frame = frame,
                   .map = map_,
                   .T_camera_world = with_pose ? &frame.T_camera_world : nullptr},
                  evidence);
    EXPECT_TRUE(evidence.objects().empty());
    EXPECT_TRUE(evidence.contributions().empty());
  };
  for (int i = 0; i < 3; ++i) {
    apply([](Frame& frame, StaticEvidence&) { std::fill(frame.coarse.depth.begin(), frame.coarse.depth.end(), 0.0F); },
          true);
    apply([](Frame& frame, StaticEvidence&) { frame.coarse = {}; }, true);
    apply([](Frame& frame, StaticEvidence& evidence) { evidence.reset(frame.size(), 0); }, true);
    apply([](Frame&, StaticEvidence&) {}, false);
  }
}

TEST_F(MotionObjectsTest, SameFramesSameObjects) {
  const auto world = [](double time) {
    BoxWorld result = room();
    result.boxes = {BoxWorld::box({-0.5 + 0.5 * time, 0.0, 1.8}, {0.2, 0.4, 0.1}),
                    BoxWorld::box({0.5 - 0.3 * time, 0.1, 2.4}, {0.3, 0.5, 0.2})};
    return result;
  };
  std::vector<double> values[2];
  for (std::vector<double>& each : values) {
    next_index_ = 0;
    previous_ = {};
    auto tracker = filter();
    for (const Seen& seen : run(tracker, world, wandering, 1.0))
      for (const MovingObject& object : seen.objects()) {
        for (int i = 0; i < 16; ++i) each.push_back(object.T_world_object.matrix().data()[i]);
        for (int i = 0; i < 3; ++i) each.push_back(object.velocity[i]);
      }
  }
  EXPECT_GT(values[0].size(), 200U);
  EXPECT_EQ(values[0], values[1]);
}

}  // namespace
}  // namespace holdfast::motion_objects_plugin

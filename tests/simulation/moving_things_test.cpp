// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/camera_path.hpp"
#include "holdfast/simulation/renderer.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

TextureArea white(World& world) { return world.add_texture(cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(100))); }

TextureArea speckled(World& world) {
  cv::Mat picture(64, 64, CV_8UC3);
  Random random(5);
  for (int i = 0; i < picture.rows * picture.cols * 3; ++i) picture.data[i] = static_cast<std::uint8_t>(random.next());
  return world.add_texture(picture);
}

// A tube of 1 m along z that one bone bends forward at half its height.
Object tube(const TextureArea& area) {
  Object object;
  object.name = object.class_name = "tube";
  constexpr std::uint32_t rings = 12, facets = 14;
  for (std::uint32_t ring = 0; ring <= rings; ++ring)
    for (std::uint32_t i = 0; i <= facets; ++i) {
      const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / facets;
      const float up = static_cast<float>(ring) / rings;
      const Vector3f out(std::cos(angle), std::sin(angle), 0.0F);
      object.mesh.vertices.push_back({Vector3f(0, 0, up) + 0.15F * out, out,
                                      area.width * static_cast<float>(i) / facets, area.height * (1.0F - up), 1.0F});
      const float share = std::clamp(4.0F * up - 1.5F, 0.0F, 1.0F);
      object.mesh.skin.push_back({{0, 1, 0, 0}, {1.0F - share, share, 0.0F, 0.0F}});
    }
  for (std::uint32_t ring = 0; ring < rings; ++ring)
    for (std::uint32_t i = 0; i < facets; ++i) {
      const std::uint32_t d = ring * (facets + 1) + i, a = d + facets + 1;
      object.mesh.triangles.push_back({a, a + 1, d + 1, area.texture, 0});
      object.mesh.triangles.push_back({a, d + 1, d, area.texture, 0});
    }
  object.mesh.surface_count = 1;
  object.mesh.rest.assign(2, Isometry3d::Identity());
  object.mesh.rest[1].translation().z() = 0.5;
  object.bones = [](double time) {
    BonePoses poses;
    poses.fill(Isometry3d::Identity());
    poses[1] = Translation3d(0, 0, 0.5) * AngleAxisd(0.5 * time, Vector3d::UnitX());
    return poses;
  };
  object.motion = [](double time) {
    return Translation3d(0.2 * time, 2.0, -0.5) * AngleAxisd(0.7 * time, Vector3d::UnitZ());
  };
  return object;
}

struct Hit {
  double depth = 0.0;
  int object = 0;
};

// The nearest front face that the ray (x, y, 1) of the camera meets, by trying every triangle.
class BruteForce {
 public:
  BruteForce(const World& world, const Isometry3d& T_world_camera, double time) {
    const Isometry3d T_camera_world = T_world_camera.inverse();
    std::vector<PosedVertex> posed;
    for (std::size_t k = 0; k < world.objects.size(); ++k) {
      const Object& object = world.objects[k];
      pose_vertices(object, time, posed);
      for (const Triangle& triangle : object.mesh.triangles) {
        Eigen::Matrix3d corners;
        int column = 0;
        for (const std::uint32_t i : {triangle.a, triangle.b, triangle.c})
          corners.col(column++) = T_camera_world * posed[i].position.cast<double>();
        if (corners.determinant() > 1e-12) triangles_.push_back({corners.inverse(), static_cast<int>(k) + 1});
      }
    }
  }
  Hit along(const Vector3d& ray) const {
    Hit nearest;
    for (const auto& [inverse, object] : triangles_) {
      const Vector3d shares = inverse * ray;
      if (shares.minCoeff() < 0.0) continue;
      const double depth = 1.0 / shares.sum();
      if (depth > 0.05 && (nearest.object == 0 || depth < nearest.depth)) nearest = {depth, object};
    }
    return nearest;
  }

 private:
  struct Face {
    Eigen::Matrix3d inverse;
    int object;
  };
  std::vector<Face> triangles_;
};

// Every `step`-th pixel has depth and number of what its ray meets first.
void expect_brute_force(const World& world, const Camera& camera, const Isometry3d& T_world_camera, double time,
                        int step, int least_seen) {
  Renderer renderer(world, camera);
  const RenderedFrame frame = renderer.render(T_world_camera, time);
  const BruteForce truth(world, T_world_camera, time);
  int seen = 0;
  for (int y = 0; y < camera.height; y += step)
    for (int x = 0; x < camera.width; x += step) {
      const Hit hit = truth.along(camera.back_project(x, y, 1.0));
      ASSERT_EQ(frame.object_ids.at<std::uint16_t>(y, x), hit.object) << x << ' ' << y << " at " << time;
      ASSERT_NEAR(frame.depth.at<float>(y, x), hit.depth, 2e-6 * (1.0 + hit.depth)) << x << ' ' << y << " at " << time;
      seen += hit.object != 0;
    }
  EXPECT_GE(seen, least_seen);
}

TEST(MovingThings, SkinnedMeshIsDrawnWhereItsVerticesArePosed) {
  World world;
  world.objects.push_back(tube(speckled(world)));
  for (const double time : {0.0, 0.8, 1.7})
    expect_brute_force(world, *find_camera("tum_fr3"), look_at({0, 0, 0.3}, {0.1, 2, 0}), time, 3, 2000);
}

TEST(MovingThings, VerticesFollowTheirBones) {
  World world;
  const Object object = tube(white(world));
  std::vector<PosedVertex> posed, some;
  pose_vertices(object, 1.0, posed);
  const Isometry3d bone = object.motion(1.0) * object.bones(1.0)[1] * object.mesh.rest[1].inverse();
  const Vertex& top = object.mesh.vertices.back();
  EXPECT_LT((posed.back().position.cast<double>() - bone * top.position.cast<double>()).norm(), 1e-6);
  EXPECT_LT((posed.back().normal.cast<double>() - bone.linear() * top.normal.cast<double>()).norm(), 1e-6);
  const Vertex& foot = object.mesh.vertices.front();
  EXPECT_LT((posed.front().position.cast<double>() - object.motion(1.0) * foot.position.cast<double>()).norm(), 1e-6);
  pose_vertices(object, 1.0, some, 10);
  ASSERT_EQ(some.size(), (posed.size() + 9) / 10);
  EXPECT_EQ(some[3].position, posed[30].position);
}

TEST(MovingThings, CullingNeverChangesThePicture) {
  World world;
  const TextureArea area = white(world);
  Random random(11);
  const auto anywhere = [&random](double size) {
    const double z = random.uniform(-size, size), y = random.uniform(-size, size), x = random.uniform(-size, size);
    return Vector3d(x, y, z);
  };
  for (int i = 0; i < 150; ++i) {
    Object& box = world.objects.emplace_back();
    box.name = box.class_name = "box";
    const float size = static_cast<float>(random.uniform(0.05, 0.5));
    add_box(box.mesh, {Vector3f::Constant(-size), Vector3f(size, size, 0.5F * size)},
            {area, area, area, area, area, area}, 1.0F);
    const Vector3d place = anywhere(3);
    box.T_world_object = Translation3d(place) * AngleAxisd(random.uniform(0, 6), Vector3d(1, 2, 3).normalized());
    if (i % 2 == 0) {  // half of them as things that move
      const Isometry3d pose = box.T_world_object;
      box.motion = [pose](double time) { return Translation3d(time, 0, 0) * pose; };
    }
  }
  for (int i = 0; i < 5; ++i) {
    const Vector3d eye = anywhere(2);
    const Vector3d target = anywhere(2);
    expect_brute_force(world, *find_camera("tum_fr3"), look_at(eye, target), 0.3 * i, 9, 100);
  }
}

TEST(MovingThings, LightChangesAsAThingTurns) {
  World world;
  const TextureArea area = white(world);
  world.ambient = 0.3F;
  world.lamps = {{{-1.0F, 0.5F, 0.0F}, 0.9F}};
  Object& sheet = world.objects.emplace_back();
  sheet.name = sheet.class_name = "sheet";
  add_rectangle(sheet.mesh, {-0.3F, 0, 0.3F}, {0.6F, 0, 0}, {0, 0, -0.6F}, area, 0.02F);
  sheet.motion = [](double time) { return Translation3d(0, 1.5, 0) * AngleAxisd(time, Vector3d::UnitZ()); };
  bake_light(world);
  Renderer renderer(world, *find_camera("icl_nuim"));
  std::vector<int> greys;
  for (const double time : {-0.9, -0.3, 0.0, 0.6, 1.2}) {
    const RenderedFrame frame = renderer.render(look_at({0, 0, 0}, {0, 1, 0}), time);
    const Vector3f normal = (AngleAxisd(time, Vector3d::UnitZ()) * -Vector3d::UnitY()).cast<float>();
    const Vector3f to_lamp = world.lamps[0].position - Vector3f(0, 1.5F, 0);
    const float cosine = std::max(0.0F, normal.dot(to_lamp.normalized()));
    const float light = 0.3F + 0.9F * cosine / (0.5F + 0.5F * to_lamp.squaredNorm());
    const int grey = frame.colour.at<cv::Vec3b>(240, 320)[1];
    EXPECT_NEAR(grey, 100.0F * light, 1.5F) << time;
    greys.push_back(grey);
  }
  EXPECT_GT(greys.front(), greys.back() + 15);
}

TEST(MovingThings, ShadeTheFloorBelowThem) {
  World world;
  const TextureArea area = white(world);
  world.ambient = 1.0F;
  Object& floor = world.objects.emplace_back();
  floor.name = floor.class_name = "floor";
  add_rectangle(floor.mesh, {-3, 5, 0}, {6, 0, 0}, {0, -5, 0}, area);
  Object& box = world.objects.emplace_back();
  box.name = box.class_name = "box";
  add_box(box.mesh, {Vector3f(-0.2F, -0.2F, 0.02F), Vector3f(0.2F, 0.2F, 0.4F)}, {area, area, area, area, area, area});
  box.motion = [](double time) { return Isometry3d(Translation3d(time, 2.0, time < 1.5 ? 0.0 : 0.5)); };
  const Camera camera = *find_camera("icl_nuim");
  Renderer renderer(world, camera);
  const Isometry3d T_world_camera = look_at({0, 0, 1.2}, {0, 2, 0});
  const auto grey_before_it = [&](double time, double place) {
    const Vector2d pixel = camera.project(T_world_camera.inverse() * Vector3d(place, 1.77, 0.0));
    const cv::Point where(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
    const RenderedFrame frame = renderer.render(T_world_camera, time);
    EXPECT_EQ(frame.object_ids.at<std::uint16_t>(where), 1);
    return static_cast<int>(frame.colour.at<cv::Vec3b>(where)[1]);
  };
  EXPECT_LT(grey_before_it(0.0, 0.0), 95);
  EXPECT_EQ(grey_before_it(0.0, 0.8), 100);
  EXPECT_LT(grey_before_it(0.8, 0.8), 95);  // it goes along
  EXPECT_EQ(grey_before_it(0.8, 0.0), 100);
  EXPECT_EQ(grey_before_it(1.6, 0.8), 100);  // lifted
}

TEST(MovingThings, OwnSolidsDimTheAmbientLight) {
  World world;
  const TextureArea area = white(world);
  Object& table = world.objects.emplace_back();
  table.name = table.class_name = "table";
  add_box(table.mesh, {Vector3f(-0.5F, -0.5F, 0.3F), Vector3f(0.5F, 0.5F, 0.4F)}, {area, area, area, area, area, area});
  add_rectangle(table.mesh, {-0.2F, 0.2F, 0.2F}, {0.4F, 0, 0}, {0, -0.4F, 0}, area);  // a shelf below the top
  table.motion = [](double) { return Isometry3d::Identity(); };
  bake_light(world);
  for (const Vertex& vertex : table.mesh.vertices) {
    if (vertex.position.z() > 0.39F && vertex.normal.z() > 0.5F) {
      EXPECT_NEAR(vertex.light, 1.0F, 1e-4F);
    }
    if (vertex.position.z() < 0.25F) {
      EXPECT_LT(vertex.light, 0.6F);
    }
  }
}

// A box that goes to the right at 0.2 m/s before a wall.
World box_before_wall() {
  World world;
  const TextureArea area = speckled(world);
  Object& wall = world.objects.emplace_back();
  wall.class_name = wall.name = "wall";
  add_rectangle(wall.mesh, {-2, 2, 2}, {4, 0, 0}, {0, 0, -4}, area, 0.5F);
  Object& box = world.objects.emplace_back();
  box.class_name = box.name = "box";
  add_box(box.mesh, {Vector3f(-0.1F, -0.1F, -0.1F), Vector3f(0.1F, 0.1F, 0.1F)}, {area, area, area, area, area, area});
  box.motion = [](double time) { return Isometry3d(Translation3d(0.2 * time, 1.0, 0.0)); };
  return world;
}

TEST(MotionBlur, IsTheMeanOfSharpFramesAndLeavesTheRestAlone) {
  const World world = box_before_wall();
  const Camera camera = *find_camera("tum_fr3");
  Renderer renderer(world, camera);
  const Isometry3d still = look_at({0, 0, 0}, {0, 1, 0});
  // Its front, at 0.9 m, goes 535 * 0.2 / 0.9 px/s: 4.76 px, four parts; 3.57 px, three.
  for (const auto& [exposure, count] : {std::pair(0.04, 4), {0.03, 3}, {0.01, 1}}) {
    const RenderedFrame blurred = renderer.render([&](double) { return still; }, 0.5, exposure);
    cv::Mat sum = cv::Mat::zeros(camera.height, camera.width, CV_16UC3);
    for (int k = 0; k < count; ++k) {
      const double then = 0.5 + exposure * ((k + 0.5) / count - 0.5);
      cv::add(sum, renderer.render(still, then).colour, sum, cv::noArray(), CV_16U);
    }
    for (int i = 0; i < camera.height * camera.width * 3; ++i)
      ASSERT_EQ(blurred.colour.data[i], (sum.ptr<std::uint16_t>()[i] + count / 2) / count) << i << " of " << count;
    const RenderedFrame sharp = renderer.render(still, 0.5);
    EXPECT_EQ(cv::norm(blurred.depth, sharp.depth, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(blurred.cosine, sharp.cosine, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(blurred.object_ids, sharp.object_ids, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(blurred.colour, sharp.colour, cv::NORM_INF) == 0.0, count == 1);
  }
}

TEST(MotionBlur, FollowsTheCamera) {
  World world = box_before_wall();
  world.objects.pop_back();
  Renderer renderer(world, *find_camera("tum_fr3"));
  const auto turning = [](double time) {
    return look_at({0, 0, 0}, {0, 1, 0}) * AngleAxisd(0.5 * time, Vector3d::UnitY());
  };
  const RenderedFrame sharp = renderer.render(turning, 0.0, 0.0), blurred = renderer.render(turning, 0.0, 0.03);
  // Smeared by 8 px, half a texel.
  const auto roughness = [](const cv::Mat& image) {
    return cv::norm(image.colRange(1, 640), image.colRange(0, 639), cv::NORM_L1);
  };
  EXPECT_LT(roughness(blurred.colour), 0.9 * roughness(sharp.colour));
  EXPECT_NEAR(cv::mean(blurred.colour)[0], cv::mean(sharp.colour)[0], 2.0);
  EXPECT_EQ(cv::norm(sharp.colour, renderer.render(turning(0.0), 0.0).colour, cv::NORM_INF), 0.0);
}

TEST(MovesAt, TellsWhatMovesFasterThanTenCentimetresPerSecond) {
  World world;
  Object object = tube(white(world));
  EXPECT_TRUE(moves_at(object, 0.4));
  const auto rest = object.bones(0.3);
  object.bones = [rest](double) { return rest; };
  object.motion = [](double time) { return Isometry3d(Translation3d(0, 0.12 * std::min(time, 2.0), 0)); };
  EXPECT_TRUE(moves_at(object, 1.0));
  EXPECT_FALSE(moves_at(object, 3.0));
  object.motion = [](double time) { return Isometry3d(Translation3d(0, 0.08 * time, 0)); };
  EXPECT_FALSE(moves_at(object, 1.0));
  object.motion = nullptr;
  EXPECT_FALSE(moves_at(object, 1.0));
  // Turning on the spot moves the surface; only the upper half bends here.
  object.bones = tube(white(world)).bones;
  EXPECT_TRUE(moves_at(object, 1.0));
  object.bones = nullptr;
  EXPECT_FALSE(moves_at(object, 1.0));
}

}  // namespace
}  // namespace holdfast::simulation

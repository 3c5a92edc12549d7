// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/person.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "holdfast/simulation/camera_path.hpp"
#include "holdfast/simulation/renderer.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector3f;

Quaterniond about_x(double angle) { return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitX())); }

struct Made {
  World world;
  Skeleton skeleton;
  Object object;

  explicit Made(std::uint64_t seed, Physique physique = {}) : skeleton(physique) {
    object = make_person(world, "somebody", skeleton, random_look(Random(seed)), Random(seed + 1000));
  }

  // The mesh in a posture, as plain triangles.
  Mesh posed(const Posture& posture) const {
    Object person = object;
    person.bones = [&](double) { return skeleton.place(posture); };
    std::vector<PosedVertex> corners;
    pose_vertices(person, 0.0, corners);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      person.mesh.vertices[i].position = corners[i].position;
      person.mesh.vertices[i].normal = corners[i].normal;
    }
    return person.mesh;
  }
};

Posture sitting(const Skeleton& skeleton) {
  Posture posture = skeleton.standing();
  const auto turn = [&](Bone bone, double angle) { posture.rotations[index(bone)] = about_x(angle); };
  turn(Bone::left_thigh, -1.5708), turn(Bone::right_thigh, -1.5708);
  turn(Bone::left_shin, 1.5708), turn(Bone::right_shin, 1.5708);
  turn(Bone::left_forearm, -1.5708), turn(Bone::right_forearm, -1.5708);
  skeleton.stand_on_floor(posture);
  return posture;
}

// Outwards and of unit length times twice the area.
Vector3f area_vector(const Mesh& mesh, const Triangle& triangle) {
  const Vector3f& a = mesh.vertices[triangle.a].position;
  return (mesh.vertices[triangle.c].position - a).cross(mesh.vertices[triangle.b].position - a);
}

float distance_to_segment(const Vector3f& point, const Vector3f& from, const Vector3f& to) {
  const Vector3f along = to - from;
  const float t = std::clamp((point - from).dot(along) / along.squaredNorm(), 0.0F, 1.0F);
  return (from + t * along - point).norm();
}

TEST(Person, WeightsSumToOneAndNameNearBones) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Made made(seed);
    const Mesh& mesh = made.object.mesh;
    ASSERT_EQ(mesh.skin.size(), mesh.vertices.size());
    ASSERT_EQ(mesh.rest.size(), bone_count);
    EXPECT_TRUE(mesh.solids.empty());
    EXPECT_EQ(made.object.class_name, "person");
    const BonePoses rest = made.skeleton.place(made.skeleton.standing());
    for (std::size_t i = 0; i < mesh.skin.size(); ++i) {
      float sum = 0.0F;
      for (int k = 0; k < 4; ++k) {
        const float weight = mesh.skin[i].weights[k];
        ASSERT_GE(weight, 0.0F);
        ASSERT_LT(mesh.skin[i].bones[k], bone_count);
        sum += weight;
        if (weight < 0.5F) continue;
        const auto bone = static_cast<Bone>(mesh.skin[i].bones[k]);
        const Vector3f joint = rest[index(bone)].translation().cast<float>();
        ASSERT_LT((mesh.vertices[i].position - joint).norm(), made.skeleton.length(bone) + 0.30)
            << "vertex " << i << " of bone " << index(bone);
      }
      ASSERT_NEAR(sum, 1.0F, 1e-5F);
    }
  }
}

TEST(Person, StandsOnTheFloorAsTallAsAsked) {
  for (const double height : {1.55, 1.75, 1.95})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Made made(seed, {height, 1.0});
      float low = 10.0F, high = 0.0F;
      for (const Vertex& vertex : made.object.mesh.vertices)
        low = std::min(low, vertex.position.z()), high = std::max(high, vertex.position.z());
      EXPECT_NEAR(low, 0.0, 0.01);
      EXPECT_NEAR(high, height, 0.03 * height) << "seed " << seed;
    }
}

TEST(Person, GirthMakesBroader) {
  const auto breadth = [](double girth) {
    const Made made(3, {1.75, girth});
    float widest = 0.0F;
    for (const Vertex& vertex : made.object.mesh.vertices)
      if (std::abs(vertex.position.z() - 1.05F) < 0.05F && std::abs(vertex.position.x()) < 0.25F)
        widest = std::max(widest, std::abs(vertex.position.y()));
    return widest;
  };
  EXPECT_GT(breadth(1.3), 1.15F * breadth(0.9));
}

TEST(Person, SurfacesFaceOutwards) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Made made(seed);
    const Mesh& mesh = made.object.mesh;
    std::map<std::uint32_t, double> volumes;
    std::map<std::uint32_t, Vector3f> middles;
    std::map<std::uint32_t, int> counts;
    for (const Triangle& triangle : mesh.triangles) {
      if (!counts[triangle.surface]++) middles[triangle.surface] = Vector3f::Zero();
      middles[triangle.surface] += mesh.vertices[triangle.a].position;
    }
    for (auto& [surface, middle] : middles) middle /= static_cast<float>(counts[surface]);
    int against = 0;
    for (const Triangle& triangle : mesh.triangles) {
      const Vector3f outwards = area_vector(mesh, triangle);
      ASSERT_LT(triangle.surface, mesh.surface_count);
      ASSERT_LT(triangle.texture, made.world.textures.size());
      volumes[triangle.surface] += outwards.dot(mesh.vertices[triangle.a].position - middles[triangle.surface]) / 6.0;
      for (const std::uint32_t corner : {triangle.a, triangle.b, triangle.c}) {
        ASSERT_NEAR(mesh.vertices[corner].normal.norm(), 1.0F, 1e-4F);
        against += outwards.dot(mesh.vertices[corner].normal) < -1e-7F;
      }
    }
    for (const auto& [surface, volume] : volumes) EXPECT_GT(volume, 0.0) << "surface " << surface << " seed " << seed;
    // Only where a hem turns in do a corner's triangles look different ways.
    EXPECT_LT(against, static_cast<int>(mesh.triangles.size()) / 10);
  }
}

TEST(Person, BendsWithoutTearing) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Made made(seed);
    const Mesh& rest = made.object.mesh;
    const Posture posture = sitting(made.skeleton);
    const Mesh bent = made.posed(posture);
    for (const Triangle& triangle : rest.triangles) {
      const std::uint32_t corners[] = {triangle.a, triangle.b, triangle.c, triangle.a};
      for (int k = 0; k < 3; ++k) {
        const float before = (rest.vertices[corners[k]].position - rest.vertices[corners[k + 1]].position).norm();
        const float after = (bent.vertices[corners[k]].position - bent.vertices[corners[k + 1]].position).norm();
        // A knee's skin is drawn out by a quarter of a turn around half the limb.
        ASSERT_LT(after, 2.6F * before + 0.05F) << "seed " << seed << " vertex " << corners[k];
      }
    }
    // Every part stays with its bones.
    const BonePoses poses = made.skeleton.place(posture);
    for (std::size_t i = 0; i < bent.vertices.size(); ++i) {
      float nearest = 10.0F;
      for (int bone = 1; bone < bone_count; ++bone) {
        const Vector3f from = poses[index(parent(static_cast<Bone>(bone)))].translation().cast<float>();
        nearest = std::min(
            nearest, distance_to_segment(bent.vertices[i].position, from, poses[bone].translation().cast<float>()));
      }
      ASSERT_LT(nearest, 0.32F) << "seed " << seed << " vertex " << i;
    }
  }
}

TEST(Person, RestPostureMovesNothing) {
  const Made made(5);
  const Mesh same = made.posed(made.skeleton.standing());
  for (std::size_t i = 0; i < same.vertices.size(); ++i)
    ASSERT_NEAR((same.vertices[i].position - made.object.mesh.vertices[i].position).norm(), 0.0F, 1e-5F);
}

// Sums of texels and of vertices that change with any of them.
std::uint64_t fingerprint(const Made& made) {
  std::uint64_t sum = 1469598103934665603ULL;
  const auto add = [&](std::uint64_t value) { sum = (sum ^ value) * 1099511628211ULL; };
  for (const Texture& texture : made.world.textures)
    for (int y = 0; y < texture.height(); ++y)
      for (int x = 0; x < texture.width(); ++x) {
        const float u[4] = {static_cast<float>(x) + 0.5F}, v[4] = {static_cast<float>(y) + 0.5F};
        float colours[16];
        texture.sample(u, v, 1, {}, colours);
        for (int channel = 0; channel < 3; ++channel) add(std::bit_cast<std::uint32_t>(colours[channel]));
      }
  for (const Vertex& vertex : made.object.mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) add(std::bit_cast<std::uint32_t>(vertex.position[axis]));
  return sum;
}

TEST(Person, SameSeedSamePersonOtherSeedOther) {
  EXPECT_EQ(fingerprint(Made(7)), fingerprint(Made(7)));
  EXPECT_NE(fingerprint(Made(7)), fingerprint(Made(8)));
}

// The person as a still, evenly lit thing, 2 m before a camera. People in photographs of that scale have about 100
// corners in 10,000 pixels, a man recorded by a Kinect 65.
TEST(Person, ShowsCornersToTrack) {
  std::vector<double> densities;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Made made(seed);
    made.object.mesh.skin.clear();
    for (Vertex& vertex : made.object.mesh.vertices) vertex.light = 0.85F;  // as in a lit room
    made.world.objects.push_back(made.object);
    const Camera camera = *find_camera("tum_fr3");
    Renderer renderer(made.world, camera);
    const RenderedFrame frame = renderer.render(look_at({0, -2.0, 0.95}, {0, 0, 0.95}), 0.0);
    cv::Mat grey, inside;
    cv::cvtColor(frame.colour, grey, cv::COLOR_BGR2GRAY);
    cv::erode(frame.object_ids == 1, inside, cv::Mat::ones(7, 7, CV_8U));
    const int area = cv::countNonZero(inside);
    ASSERT_GT(area, 15000);
    std::vector<cv::KeyPoint> corners;
    cv::FAST(grey, corners, 20);
    const auto count = std::count_if(corners.begin(), corners.end(), [&](const cv::KeyPoint& corner) {
      return inside.at<std::uint8_t>(cv::Point(corner.pt)) > 0;
    });
    densities.push_back(1e4 * static_cast<double>(count) / area);
  }
  std::sort(densities.begin(), densities.end());
  EXPECT_GT(densities[2], 8.0);
  EXPECT_LT(densities[2], 110.0);
}

}  // namespace
}  // namespace holdfast::simulation

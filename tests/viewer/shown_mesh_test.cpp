// SPDX-License-Identifier: BSD-3-Clause
#include "shown_mesh.hpp"

#include <gmock/gmock.h>

#include "viewer/socket_client.hpp"

namespace holdfast::viewer {
namespace {

using test::ReceivedMessage;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::IsEmpty;

/// So many triangles side by side, at a height.
SurfacePatch patch_at(int cube, std::size_t triangles = 1, float height = 0.0F) {
  SurfacePatch patch{{cube, 0, 0}, {}, {}};
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto first = static_cast<std::uint16_t>(3 * i);
    for (const auto& [x, y] : {std::pair{0.0F, 0.0F}, {1.0F, 0.0F}, {0.0F, 1.0F}})
      patch.vertices.push_back({{static_cast<float>(cube) + x, y, height}, {0, 0, 1}, 10, 20, 30, 2});
    patch.triangles.push_back({first, static_cast<std::uint16_t>(first + 1), static_cast<std::uint16_t>(first + 2)});
  }
  return patch;
}

ReceivedMessage told(const ShownMesh& mesh, MeshProgress& progress) {
  Message message;
  mesh.describe(progress, message);
  return ReceivedMessage(message.bytes());
}

TEST(ShownMeshTest, TellsAPatchOnceAndAgainWhenItLooksDifferent) {
  ShownMesh mesh;
  MeshProgress progress;
  EXPECT_FALSE(mesh.has_more(progress));
  mesh.add({patch_at(0), patch_at(1)}, 0);
  ReceivedMessage message = told(mesh, progress);
  EXPECT_EQ(message.json["new_mesh"], true);
  EXPECT_THAT(message.array<std::uint32_t>("patch_slots"), ElementsAre(0, 1));
  EXPECT_THAT(message.array<std::uint32_t>("patch_sizes"), ElementsAre(3, 1, 3, 1));
  const std::vector<std::uint8_t> tints = message.array<std::uint8_t>("patch_tints");
  EXPECT_THAT(std::vector<std::uint8_t>(tints.begin(), tints.begin() + 8),
              ElementsAre(128, 128, 255, 2, 10, 20, 30, 255));
  EXPECT_THAT(message.array<std::uint16_t>("patch_corners"), ElementsAre(0, 1, 2, 0, 1, 2));
  EXPECT_FALSE(mesh.has_more(progress));

  mesh.add({patch_at(0, 1, 1e-3F), patch_at(1, 1, 0.02F)}, 0);  // the first one has moved by too little
  message = told(mesh, progress);
  EXPECT_FALSE(message.json.contains("new_mesh"));
  EXPECT_THAT(message.array<std::uint32_t>("patch_slots"), ElementsAre(1));
  EXPECT_EQ(message.array<float>("patch_places")[2], 0.02F);

  mesh.add({patch_at(0, 0)}, 0);  // it is gone
  message = told(mesh, progress);
  EXPECT_THAT(message.array<std::uint32_t>("patch_sizes"), ElementsAre(0, 0));
  EXPECT_EQ(mesh.triangle_count(), 1U);
}

TEST(ShownMeshTest, TellsManyPatchesInSeveralMessages) {
  ShownMesh mesh;
  std::vector<SurfacePatch> patches;
  for (int i = 0; i < 100; ++i) patches.push_back(patch_at(i, 1000));
  mesh.add(std::move(patches), 0);
  MeshProgress progress;
  std::size_t triangles = 0;
  int messages = 0;
  for (; progress.number == 0 || mesh.has_more(progress); ++messages) {
    const std::size_t count = told(mesh, progress).array<std::uint16_t>("patch_corners").size() / 3;
    EXPECT_LE(count, ShownMesh::most_in_message + 1000);
    triangles += count;
  }
  EXPECT_EQ(triangles, 100'000U);
  EXPECT_EQ(messages, 5);
}

TEST(ShownMeshTest, WantsCoarserPatchesRatherThanTooManyTriangles) {
  ShownMesh mesh;
  MeshProgress progress;
  const auto add = [&](int first, int count, int coarseness) {
    std::vector<SurfacePatch> patches;
    for (int i = 0; i < count; ++i) patches.push_back(patch_at(first + i, 1000));
    mesh.add(std::move(patches), coarseness);
  };
  add(0, 299, 0);
  EXPECT_EQ(mesh.coarseness(), 0);
  add(299, 2, 0);
  EXPECT_EQ(mesh.coarseness(), 1);
  while (mesh.has_more(progress)) told(mesh, progress);
  add(301, 1, 0);
  EXPECT_FALSE(mesh.has_more(progress)) << "finer than wanted";
  add(0, 75, 1);
  EXPECT_EQ(told(mesh, progress).json["new_mesh"], true);
  EXPECT_EQ(mesh.triangle_count(), 75'000U);
  add(75, 300, 1);
  EXPECT_EQ(mesh.coarseness(), ShownMesh::coarsest);
  add(0, 400, 2);
  EXPECT_EQ(mesh.triangle_count(), ShownMesh::most_triangles);
  mesh.add({patch_at(0, 0), patch_at(500, 10)}, 2);
  EXPECT_EQ(mesh.triangle_count(), ShownMesh::most_triangles - 990) << "there is room again";
}

TEST(ShownMeshTest, TheMeshOfARunThatHasEndedReplacesAll) {
  ShownMesh mesh;
  MeshProgress progress;
  mesh.add({patch_at(0), patch_at(1)}, 0);
  told(mesh, progress);
  mesh.replace({patch_at(5), patch_at(5, 2)});
  const ReceivedMessage message = told(mesh, progress);
  EXPECT_EQ(message.json["new_mesh"], true);
  EXPECT_THAT(message.array<std::uint32_t>("patch_sizes"), ElementsAre(3, 1, 6, 2));
}

}  // namespace
}  // namespace holdfast::viewer

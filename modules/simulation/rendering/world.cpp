// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/world.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "holdfast/core/error.hpp"

namespace holdfast::simulation {

TextureArea World::add_texture(const cv::Mat& picture) {
  textures.emplace_back(picture);
  return {static_cast<std::uint32_t>(textures.size() - 1), 0.0F, 0.0F, static_cast<float>(picture.cols),
          static_cast<float>(picture.rows)};
}

void pose_vertices(const Object& object, double time, std::vector<PosedVertex>& posed, std::size_t stride) {
  const Mesh& mesh = object.mesh;
  posed.resize((mesh.vertices.size() + stride - 1) / stride);
  const Eigen::Isometry3d T_world_object = object.pose(time);
  if (!object.bones) {
    const Eigen::Isometry3f pose = T_world_object.cast<float>();
    for (std::size_t i = 0; i < posed.size(); ++i) {
      const Vertex& vertex = mesh.vertices[i * stride];
      posed[i] = {pose * vertex.position, pose.linear() * vertex.normal};
    }
    return;
  }
  HOLDFAST_CHECK(mesh.skin.size() == mesh.vertices.size() && mesh.rest.size() <= bone_count,
                 object.name << ": " << mesh.vertices.size() << " vertices, skin of " << mesh.skin.size() << ", "
                             << mesh.rest.size() << " bones");
  using Matrix34f = Eigen::Matrix<float, 3, 4>;
  const BonePoses bones = object.bones(time);
  std::array<Matrix34f, bone_count> from_rest;
  for (std::size_t bone = 0; bone < mesh.rest.size(); ++bone)
    from_rest[bone] = (T_world_object * bones[bone] * mesh.rest[bone].inverse()).affine().cast<float>();
  for (std::size_t i = 0; i < posed.size(); ++i) {
    const Vertex& vertex = mesh.vertices[i * stride];
    const SkinWeights& skin = mesh.skin[i * stride];
    Matrix34f blend = skin.weights[0] * from_rest[skin.bones[0]];
    for (int k = 1; k < 4; ++k)
      if (skin.weights[k] > 0.0F) blend += skin.weights[k] * from_rest[skin.bones[k]];
    posed[i].position = blend.leftCols<3>() * vertex.position + blend.col(3);
    posed[i].normal = (blend.leftCols<3>() * vertex.normal).normalized();
  }
}

bool moves_at(const Object& object, double time) {
  if (!object.moves() || object.mesh.vertices.empty()) return false;
  constexpr double half_interval = 1.0 / 60.0;
  constexpr float fastest = 0.1F * 2.0F * static_cast<float>(half_interval);  // that counts as still [m]
  const std::size_t stride = std::max<std::size_t>(1, object.mesh.vertices.size() / 64);
  std::vector<PosedVertex> before, after;
  pose_vertices(object, time - half_interval, before, stride);
  pose_vertices(object, time + half_interval, after, stride);
  for (std::size_t i = 0; i < before.size(); ++i)
    if ((after[i].position - before[i].position).squaredNorm() > fastest * fastest) return true;
  return false;
}

std::vector<std::string> class_names(const World& world) {
  std::set<std::string> names;
  for (const Object& object : world.objects) names.insert(object.class_name);
  std::vector<std::string> result = {"background"};
  result.insert(result.end(), names.begin(), names.end());
  return result;
}

}  // namespace holdfast::simulation

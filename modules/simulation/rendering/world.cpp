// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/world.hpp"

#include <algorithm>
#include <set>

namespace holdfast::simulation {

TextureArea World::add_texture(const cv::Mat& picture) {
  textures.emplace_back(picture);
  return {static_cast<std::uint32_t>(textures.size() - 1), 0.0F, 0.0F, static_cast<float>(picture.cols),
          static_cast<float>(picture.rows)};
}

std::vector<std::string> class_names(const World& world) {
  std::set<std::string> names;
  for (const Object& object : world.objects) names.insert(object.class_name);
  std::vector<std::string> result = {"background"};
  result.insert(result.end(), names.begin(), names.end());
  return result;
}

}  // namespace holdfast::simulation

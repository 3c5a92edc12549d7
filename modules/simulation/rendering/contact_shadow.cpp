// SPDX-License-Identifier: BSD-3-Clause
#include "contact_shadow.hpp"

#include <algorithm>
#include <array>

namespace holdfast::simulation {

void add_contact_shadows(const Object& object, const std::vector<PosedVertex>& posed,
                         std::vector<ContactShadow>& shadows) {
  constexpr float margin = 0.08F;   // of half shade around the thing [m]
  constexpr float darkest = 0.55F;  // right below it
  std::array<Eigen::AlignedBox3f, 256> low;
  const bool bends = object.mesh.skin.size() == posed.size() && object.bones;
  for (std::size_t i = 0; i < posed.size(); ++i)
    if (posed[i].position.z() < ContactShadow::reach)
      low[bends ? object.mesh.skin[i].bones[0] : 0].extend(posed[i].position);
  for (const Eigen::AlignedBox3f& box : low) {
    if (box.isEmpty() || box.max().z() < 0.0F) continue;
    const Eigen::Vector3f middle = box.center(), half = 0.5F * box.sizes();
    const float above = std::max(0.0F, box.min().z());
    shadows.push_back({middle.x(), middle.y(), 1.0F / (1.2F * half.x() + margin), 1.0F / (1.2F * half.y() + margin),
                       darkest * (1.0F - above / ContactShadow::reach)});
  }
}

}  // namespace holdfast::simulation

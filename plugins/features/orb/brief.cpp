// SPDX-License-Identifier: BSD-3-Clause
#include "brief.hpp"

#include <cmath>
#include <numbers>

namespace holdfast::orb_plugin {

const std::array<BriefTest, 256>& brief_pattern() {
  static constexpr std::array<BriefTest, 256> pattern = {{
#include "pattern.inl"
  }};
  return pattern;
}

void SteeredPattern::build(std::ptrdiff_t stride) {
  if (stride == stride_) return;
  stride_ = stride;
  offsets_.resize(static_cast<std::size_t>(steps) * 512);
  std::int32_t* out = offsets_.data();
  for (int step = 0; step < steps; ++step, out += 512) {
    const double angle = 2 * std::numbers::pi * step / steps, cosine = std::cos(angle), sine = std::sin(angle);
    const auto offset = [&](int x, int y) {
      return static_cast<std::int32_t>(std::lround(cosine * x - sine * y) +
                                       stride * std::lround(sine * x + cosine * y));
    };
    for (std::size_t i = 0; i < 256; ++i) {
      const BriefTest& test = brief_pattern()[i];
      out[i] = offset(test.x1, test.y1);
      out[256 + i] = offset(test.x2, test.y2);
    }
  }
}

const std::int32_t* SteeredPattern::offsets(float angle) const {
  constexpr float steps_per_radian = steps / (2 * std::numbers::pi_v<float>);
  const int step = static_cast<int>(angle * steps_per_radian + 0.5F) % steps;
  return offsets_.data() + static_cast<std::size_t>(step) * 512;
}

}  // namespace holdfast::orb_plugin

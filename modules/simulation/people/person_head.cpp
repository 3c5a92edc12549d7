// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "person_builder.hpp"

#include "full_turn.hpp"

namespace holdfast::simulation {

using Eigen::Vector3f;

namespace {
constexpr float chin = 0.868F, crown = 0.993F;  // of the bald skull, as shares of the height
constexpr float head_texels = 640.0F, hair_texels = 420.0F;
constexpr float head_centre = -0.008F;  // y of the head's axis

// A level of the head, in heights of the head: how high, half width, how far before and behind the axis.
struct HeadSection {
  float rise, width, front, back;
};
constexpr HeadSection head_sections[] = {
    {-0.035F, 0.0F, 0.20F, -0.20F},   {-0.010F, 0.105F, 0.375F, -0.02F}, {0.040F, 0.185F, 0.412F, 0.10F},
    {0.120F, 0.250F, 0.415F, 0.20F},  {0.220F, 0.290F, 0.418F, 0.31F},   {0.330F, 0.318F, 0.420F, 0.40F},
    {0.450F, 0.342F, 0.418F, 0.455F}, {0.550F, 0.355F, 0.416F, 0.480F},  {0.660F, 0.362F, 0.422F, 0.490F},
    {0.770F, 0.355F, 0.400F, 0.480F}, {0.860F, 0.322F, 0.345F, 0.435F},  {0.930F, 0.255F, 0.262F, 0.345F},
    {0.980F, 0.145F, 0.140F, 0.210F}, {1.000F, 0.0F, -0.04F, 0.04F}};
constexpr std::size_t head_section_count = std::size(head_sections);

HeadSection head_section_at(float rise) {
  std::size_t k = 0;
  while (k + 2 < head_section_count && head_sections[k + 1].rise < rise) ++k;
  const HeadSection &a = head_sections[k], &b = head_sections[k + 1];
  const float t = std::clamp((rise - a.rise) / (b.rise - a.rise), 0.0F, 1.0F);
  // Near the crown an ellipse, which a straight line would cut short.
  const float w = b.rise >= 1.0F ? 1.0F - std::sqrt(std::max(0.0F, 1.0F - t * t)) : t;
  const auto mix = [&](float HeadSection::*member) { return a.*member + w * (b.*member - a.*member); };
  return {rise, mix(&HeadSection::width), mix(&HeadSection::front), mix(&HeadSection::back)};
}

float bump(float value, float at, float size) { return std::exp(-std::pow((value - at) / size, 2.0F)); }

// Vertices, and so texels, stand twice as dense before as in the mean, where the face is.
float dense_before(float share) {
  return share + pictures::face_density * std::sin(full_turn<float> * share) / full_turn<float>;
}

// Distance from the middle of the face, as a share of a turn: 0 before, 0.5 behind.
float from_front(float share) { return std::abs(share - 0.5F); }

float between(std::initializer_list<std::pair<float, float>> table, float at) {
  const auto* next = std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.first >= at; });
  if (next == table.begin()) return next->second;
  if (next == table.end()) return (table.end() - 1)->second;
  const auto* before = next - 1;
  return before->second + (at - before->first) / (next->first - before->first) * (next->second - before->second);
}
}  // namespace

Vector3f PersonBuilder::head_point(float share, float rise, float outwards, bool curtain) const {
  const float scale = (crown - chin) * height_;
  const HeadSection section = head_section_at(curtain ? std::max(rise, 0.48F) : rise);
  const float sine = std::sin(full_turn<float> * share), cosine = std::cos(full_turn<float> * share);
  const float middle = 0.5F * (section.back - section.front), depth = 0.5F * (section.back + section.front);
  const float jaw = 1.0F - 0.07F * figure_ * smooth_step(0.45F, 0.10F, rise);
  const auto rounded = [](float value) { return std::copysign(std::pow(std::abs(value), 0.90F), value); };
  Vector3f point(-rounded(sine) * section.width * jaw, middle + rounded(cosine) * depth, rise);
  const float side = from_front(share);
  if (!curtain) {
    const float front = smooth_step(0.25F, 0.10F, side);
    float relief = 0.0F;
    // The nose rises from between the eyes to its tip and ends above the lip.
    const float ridge = smooth_step(0.60F, 0.38F, rise) * smooth_step(0.285F, 0.345F, rise);
    relief += 0.115F * ridge * bump(side, 0.0F, 0.030F);
    relief += 0.030F * bump(rise, 0.345F, 0.04F) * bump(side, 0.030F, 0.018F);
    relief -= 0.030F * bump(rise, 0.53F, 0.055F) * bump(side, 0.065F, 0.035F);
    relief += 0.012F * bump(rise, 0.625F, 0.035F) * bump(side, 0.060F, 0.060F);
    relief += 0.016F * bump(rise, 0.40F, 0.07F) * bump(side, 0.105F, 0.035F);
    relief += 0.020F * bump(rise, 0.205F, 0.045F) * bump(side, 0.0F, 0.045F);
    relief -= 0.012F * bump(rise, 0.125F, 0.025F) * bump(side, 0.0F, 0.04F);
    relief += 0.018F * bump(rise, 0.03F, 0.05F) * bump(side, 0.0F, 0.05F);
    point.y() -= front * relief;
  }
  // Outwards: from the axis, upwards near the crown.
  Vector3f away(point.x(), point.y() - middle, rise > 0.6F ? (rise - 0.6F) * 0.9F : 0.0F);
  away.normalize();
  if (section.width <= 0.0F) away = rise > 0.5F ? Vector3f::UnitZ() : Vector3f(-Vector3f::UnitZ());
  return Vector3f(0.0F, head_centre * height_, chin * height_) + scale * point + outwards * away;
}

void PersonBuilder::head() {
  constexpr int facets = 20;
  Grid grid;
  grid.columns = facets + 1;
  static constexpr float rises[] = {1.0F,  0.97F, 0.88F, 0.76F, 0.63F, 0.55F,  0.47F,  0.40F,
                                    0.34F, 0.28F, 0.21F, 0.13F, 0.04F, -0.01F, -0.035F};
  for (const float rise : rises) {
    grid.rows.push_back(1.0F - rise);
    for (int i = 0; i <= facets; ++i)
      grid.points.push_back(head_point(dense_before(static_cast<float>(i % facets) / facets), rise, 0.0F));
  }
  const auto weights = [this](const Vector3f& position) {
    return chain_weights(-position.z(), Bone::head, {{-0.872F * height_, 0.010F * height_, Bone::neck}});
  };
  const float scale = (crown - chin) * height_;
  const pictures::Face face{look_.skin,  look_.hair,    look_.figure < 0.5 ? 0.35 : 0.6,
                            look_.beard, look_.glasses, look_.hair_style == HairStyle::bald};
  const TextureArea area = paint(
      {2.45F * scale * head_texels, 1.035F * scale * head_texels}, head_texels,
      [&](cv::Size size, double, Random random) { return pictures::head(size, face, random); }, face_softness);
  add_grid(mesh_, grid, area, weights);
  for (const bool left : {true, false}) ear(left);
}

void PersonBuilder::ear(bool left) {
  const float scale = (crown - chin) * height_, outwards = left ? 1.0F : -1.0F;
  Loft loft;
  for (const auto& [rise, breadth, thickness] :
       {std::array{0.625F, 0.0F, 0.0F}, std::array{0.605F, 0.055F, 0.022F}, std::array{0.53F, 0.085F, 0.030F},
        std::array{0.44F, 0.060F, 0.026F}, std::array{0.375F, 0.030F, 0.018F}, std::array{0.36F, 0.0F, 0.0F}}) {
    Ring ring;
    // Leaning back, and standing off the head behind.
    ring.centre =
        Vector3f(outwards * (0.358F + 0.02F * (rise - 0.4F)) * scale,
                 head_centre * height_ + (0.075F + 0.15F * (rise - 0.5F)) * scale, chin * height_ + rise * scale);
    ring.across = Vector3f(1.0F, outwards * 0.0F, 0.0F);
    ring.behind = Vector3f(outwards * 0.35F, 1.0F, 0.0F).normalized();
    ring.width = thickness * scale, ring.front = ring.back = breadth * scale;
    loft.rings.push_back(ring);
  }
  loft.facets = 6;
  loft.weights = [](const Vector3f&) { return chain_weights(0.0F, Bone::head, {}); };
  add(loft, 400.0F,
      [&](cv::Size size, double texels, Random random) { return pictures::ear(size, look_.skin, texels, random); });
}

void PersonBuilder::hair() {
  if (look_.hair_style == HairStyle::bald) return;
  const HairStyle style = look_.hair_style;
  const bool lengthy = style == HairStyle::shoulder_length;
  const auto weights = [this](const Vector3f& position) {
    return chain_weights(-position.z(), Bone::head, {{-0.850F * height_, 0.030F * height_, Bone::chest}});
  };
  constexpr int facets = 18;
  const int rows = lengthy ? 12 : 9;
  const float scale = (crown - chin) * height_;
  // How far down hair goes, by the distance from the middle of the face.
  const auto hairline = [&](float side) {
    if (lengthy)
      return between({{0.0F, 0.83F}, {0.06F, 0.82F}, {0.11F, 0.72F}, {0.15F, 0.40F}, {0.18F, -0.35F}, {0.5F, -0.55F}},
                     side);
    if (style == HairStyle::bun)
      return between({{0.0F, 0.84F}, {0.09F, 0.80F}, {0.15F, 0.70F}, {0.20F, 0.58F}, {0.30F, 0.42F}, {0.5F, 0.16F}},
                     side);
    return between({{0.0F, 0.84F},
                    {0.07F, 0.83F},
                    {0.12F, 0.75F},
                    {0.16F, 0.68F},
                    {0.19F, 0.44F},
                    {0.225F, 0.42F},
                    {0.25F, 0.60F},
                    {0.31F, 0.52F},
                    {0.35F, 0.25F},
                    {0.5F, 0.14F}},
                   side);
  };
  const float thickness = style == HairStyle::cropped ? 0.008F
                          : style == HairStyle::curly ? 0.019F
                          : style == HairStyle::bun   ? 0.009F
                                                      : 0.017F;
  const float top = (1.0F - crown) * height_;  // ends at the full height
  Random lumps = random_.fork(801), edges = random_.fork(802);
  const float receding = style == HairStyle::cropped ? static_cast<float>(edges.uniform(-0.02, 0.05)) : 0.0F;
  std::vector<float> line;
  for (int i = 0; i < facets; ++i) {
    const float share = dense_before(static_cast<float>(i) / facets), side = from_front(share);
    float edge = hairline(side) + static_cast<float>(edges.uniform(-0.018, 0.018));
    edge += receding * smooth_step(0.16F, 0.10F, side) * (0.4F + smooth_step(0.02F, 0.08F, side));
    // A parting: hair falls over the forehead to one side.
    if (style == HairStyle::parted) edge -= 0.5F * (share - 0.47F) * smooth_step(0.13F, 0.07F, side);
    line.push_back(edge);
  }
  Grid grid;
  grid.columns = facets + 1;
  for (int row = 0; row <= rows; ++row) {
    const float down = static_cast<float>(row) / static_cast<float>(rows - 1);
    const bool last = row == rows;
    grid.rows.push_back(static_cast<float>(row));
    std::vector<Vector3f> points;
    for (int i = 0; i < facets; ++i) {
      const float share = dense_before(static_cast<float>(i) / facets), side = from_front(share);
      const float edge = line[static_cast<std::size_t>(i)];
      // Rows close at the crown, where it is round.
      const float bend = lengthy ? 1.9F : 1.35F;
      const float rise = row == 0 ? 1.0F : 1.0F + (edge - 1.0F) * std::pow(std::min(down, 1.0F), bend);
      // Thin at the hairline before, full above and behind.
      const float rim = smooth_step(1.05F, 0.55F, down), behind = smooth_step(0.10F, 0.30F, side);
      float out = thickness * (0.45F + 0.55F * std::max(rim, lengthy ? behind : 0.35F * behind));
      out = out * smooth_step(0.97F, 0.62F, rise) + std::min(top, 1.3F * thickness) * smooth_step(0.62F, 0.97F, rise);
      if (style == HairStyle::parted) out += 0.010F * smooth_step(0.72F, 0.88F, rise) * smooth_step(0.3F, 0.0F, side);
      const float lump = style == HairStyle::curly ? 0.006F : style == HairStyle::cropped ? 0.0015F : 0.003F;
      if (row > 0) out += lump * static_cast<float>(lumps.uniform(-1.0, 1.0)) * smooth_step(1.0F, 0.93F, rise);
      if (last) out = lengthy && side > 0.15F ? out - 0.02F : -0.006F;
      points.push_back(head_point(share, rise, out, lengthy && side > 0.14F));
    }
    if (row == 0) std::fill(points.begin(), points.end(), Vector3f(points.front().x(), head_centre * height_, height_));
    grid.points.insert(grid.points.end(), points.begin(), points.end());
    grid.points.push_back(points.front());
  }
  const float rows_long = lengthy ? 1.9F : 1.2F;
  const auto painter = [&](cv::Size size, double texels, Random random) {
    return pictures::hair(size, look_.hair, style == HairStyle::curly, texels, random);
  };
  const TextureArea area =
      paint({2.7F * scale * hair_texels, rows_long * scale * hair_texels}, hair_texels, painter, face_softness);
  add_grid(mesh_, grid, area, weights);
  if (lengthy) {  // fills the room behind the neck, which would be seen to be hollow
    Loft filling;
    for (const auto& [rise, width, depth] : {std::array{0.35F, 0.0F, 0.0F}, std::array{0.33F, 0.28F, 0.24F},
                                             std::array{-0.42F, 0.29F, 0.20F}, std::array{-0.44F, 0.0F, 0.0F}}) {
      Ring ring;
      ring.centre = Vector3f(0.0F, head_centre * height_ + 0.23F * scale, chin * height_ + rise * scale);
      ring.width = width * scale, ring.front = ring.back = depth * scale;
      filling.rings.push_back(ring);
    }
    filling.facets = 8;
    filling.weights = weights;
    add(filling, 0.5F * hair_texels, [&](cv::Size size, double texels, Random random) {
      return pictures::hair(size, look_.hair * 0.55, false, texels, random);
    });
  }
  if (style != HairStyle::bun) return;
  Loft bun;
  const Vector3f centre(0.0F, (0.50F * (crown - chin) + head_centre + 0.012F) * height_,
                        chin * height_ + 0.72F * scale);
  for (int k = 0; k <= 5; ++k) {
    const float angle = 0.5F * full_turn<float> * static_cast<float>(k) / 5.0F;
    Ring ring;
    ring.centre = centre + Vector3f(0.0F, 0.0F, 0.032F * std::cos(angle));
    ring.width = 0.036F * std::sin(angle), ring.front = ring.back = 0.032F * std::sin(angle);
    if (k == 0 || k == 5) ring.width = ring.front = ring.back = 0.0F;
    bun.rings.push_back(ring);
  }
  bun.facets = 8;
  bun.weights = weights;
  add(bun, hair_texels, painter);
}

}  // namespace holdfast::simulation

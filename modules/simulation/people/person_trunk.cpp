// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "person_builder.hpp"

namespace holdfast::simulation {

using Eigen::Vector3f;

namespace {
constexpr float trunk_cloth_texels = 420.0F;  // per metre

// Half sizes of the trunk, as shares of the height, for the average man and woman.
struct TrunkSection {
  float z, width, front, back;       // of men
  float width_change, front_change;  // what women's add
  float fat;                         // how far it grows with the girth
  float power;
};
constexpr TrunkSection sections[] = {
    {0.860F, 0.036F, 0.036F, 0.034F, -0.005F, -0.004F, 0.5F, 2.0F},
    {0.847F, 0.039F, 0.036F, 0.037F, -0.005F, -0.004F, 0.5F, 2.0F},
    {0.839F, 0.054F, 0.040F, 0.043F, -0.005F, -0.003F, 0.4F, 2.0F},
    {0.831F, 0.082F, 0.044F, 0.050F, -0.005F, -0.003F, 0.3F, 2.0F},
    {0.821F, 0.104F, 0.048F, 0.054F, -0.005F, -0.003F, 0.3F, 2.1F},
    {0.800F, 0.113F, 0.055F, 0.060F, -0.006F, -0.002F, 0.3F, 2.3F},
    {0.770F, 0.103F, 0.064F, 0.064F, -0.008F, 0.000F, 0.5F, 2.4F},
    {0.735F, 0.095F, 0.069F, 0.062F, -0.008F, 0.008F, 0.6F, 2.4F},
    {0.700F, 0.091F, 0.067F, 0.057F, -0.009F, 0.004F, 0.7F, 2.4F},
    {0.660F, 0.086F, 0.063F, 0.051F, -0.012F, -0.003F, 0.9F, 2.3F},
    {0.620F, 0.084F, 0.061F, 0.049F, -0.012F, -0.003F, 1.0F, 2.3F},
    {0.585F, 0.087F, 0.060F, 0.053F, -0.002F, -0.002F, 1.0F, 2.3F},
    {0.550F, 0.092F, 0.057F, 0.062F, 0.004F, -0.001F, 0.8F, 2.3F},
    {0.515F, 0.098F, 0.054F, 0.069F, 0.005F, -0.001F, 0.7F, 2.4F},
    {0.488F, 0.099F, 0.052F, 0.067F, 0.004F, -0.001F, 0.7F, 2.4F},
    {0.462F, 0.098F, 0.051F, 0.062F, 0.003F, -0.001F, 0.7F, 2.3F},
};
constexpr std::size_t section_count = std::size(sections);

TrunkSection section_at(float z) {
  std::size_t k = 0;
  while (k + 2 < section_count && sections[k + 1].z > z) ++k;
  const TrunkSection &a = sections[k], &b = sections[k + 1];
  const float t = std::clamp((z - a.z) / (b.z - a.z), 0.0F, 1.0F);
  const auto mix = [&](float TrunkSection::*member) { return a.*member + t * (b.*member - a.*member); };
  return {z,
          mix(&TrunkSection::width),
          mix(&TrunkSection::front),
          mix(&TrunkSection::back),
          mix(&TrunkSection::width_change),
          mix(&TrunkSection::front_change),
          mix(&TrunkSection::fat),
          mix(&TrunkSection::power)};
}

Ring trunk_ring(float z, float height, float girth, float figure, float loose) {
  const TrunkSection section = section_at(z);
  const float grow = 1.0F + section.fat * (girth - 1.0F);
  Ring ring;
  // The spine's curve: hollow in the small of the back, the neck before the shoulders.
  const float neck = smooth_step(0.81F, 0.86F, z), small_of_back = std::exp(-std::pow((z - 0.63F) / 0.06F, 2.0F));
  ring.centre = {0.0F, (0.004F * neck - 0.006F * small_of_back) * height, z * height};
  ring.width = (section.width + figure * section.width_change) * grow * height + loose;
  ring.front = (section.front + figure * section.front_change) * grow * height + loose;
  ring.front += std::max(0.0F, girth - 1.0F) * 0.05F * height * std::exp(-std::pow((z - 0.61F) / 0.06F, 2.0F));
  ring.back = section.back * grow * height + loose;
  ring.power = section.power;
  // The neck leaves the shoulders leaning forward, so that necklines lie lower before than behind.
  ring.behind = Vector3f(0.0F, 1.0F, 0.32F * neck).normalized();
  return ring;
}

// Distance of an angle from another, both shares of a turn.
float apart(float share, float from) { return std::abs(share - from - std::round(share - from)); }
}  // namespace

SkinWeights PersonBuilder::trunk_weights(const Vector3f& position) const {
  const float h = height_;
  SkinWeights weights = chain_weights(-position.z(), Bone::neck,
                                      {{-0.842F * h, 0.016F * h, Bone::chest},
                                       {-0.690F * h, 0.045F * h, Bone::abdomen},
                                       {-0.600F * h, 0.040F * h, Bone::pelvis}});
  // Shoulders follow the arms a little.
  const float reach = std::abs(joint(Bone::left_upper_arm).x());
  const float share = 0.45F * smooth_step(0.70F * reach, 1.15F * reach, std::abs(position.x())) *
                      smooth_step(0.73F * h, 0.77F * h, position.z());
  if (share > 0.0F && weights.weights[3] == 0.0F) {
    for (float& weight : weights.weights) weight *= 1.0F - share;
    weights.bones[3] = static_cast<std::uint8_t>(position.x() > 0.0F ? Bone::left_upper_arm : Bone::right_upper_arm);
    weights.weights[3] = share;
  }
  return weights;
}

std::vector<Ring> PersonBuilder::trunk_rings() const {
  const bool jacket = look_.top == Top::jacket;
  const float loose = jacket ? 0.016F : look_.top == Top::t_shirt ? 0.007F : 0.010F;
  const float hem = look_.tucked_in ? 0.575F : jacket ? 0.482F : 0.497F;
  const float over_trousers = look_.tucked_in ? 0.0F : 0.009F;
  std::vector<Ring> rings;
  // The neckline: what is worn above ends as an edge around the neck.
  const float neckline = look_.top == Top::t_shirt ? 0.8385F : 0.846F;
  const auto ring = [&](float z, float extra) {
    return trunk_ring(z, height_, girth_, figure_,
                      loose * (z > 0.83F ? 0.5F : 1.0F) + over_trousers * smooth_step(0.64F, 0.57F, z) + extra);
  };
  Ring inner = ring(neckline, -0.020F);
  inner.centre.z() -= 0.006F;
  rings.push_back(inner);
  rings.push_back(ring(neckline, 0.0F));
  for (const TrunkSection& section : sections)
    if (section.z < neckline - 0.004F && section.z > hem + (look_.tucked_in ? 0.035F : 0.012F))
      rings.push_back(ring(section.z, 0.0F));
  if (look_.tucked_in) rings.push_back(ring(0.600F, 0.002F));  // blouses over the belt
  rings.push_back(ring(hem, look_.tucked_in ? -0.020F : 0.003F));
  if (!look_.tucked_in) {
    rings.push_back(ring(hem, -0.012F));
    rings.back().centre.z() += 0.004F;
  }
  return rings;
}

void PersonBuilder::trunk() {
  Loft loft;
  loft.rings = trunk_rings();
  loft.facets = 16;
  loft.weights = [this](const Vector3f& position) { return trunk_weights(position); };
  const float bust = figure_ * 0.012F * height_;
  const Random waves = random_.fork(501);
  std::vector<float> wave(loft.rings.size() * 16);
  Random draw = waves;
  for (float& value : wave) value = static_cast<float>(draw.uniform(-1.0, 1.0));
  loft.bulge = [&, bust](float share, std::size_t k) {
    const float z = loft.rings[k].centre.z() / height_;
    const float breast = std::exp(-std::pow((z - 0.733F) / 0.026F, 2.0F)) *
                         std::exp(-std::pow(apart(share, share < 0.5F ? 0.41F : 0.59F) / 0.065F, 2.0F));
    const float blade = std::exp(-std::pow((z - 0.765F) / 0.03F, 2.0F)) *
                        std::exp(-std::pow(apart(share, share < 0.5F ? 0.10F : 0.90F) / 0.06F, 2.0F));
    const float buttock = std::exp(-std::pow((z - 0.505F) / 0.03F, 2.0F)) *
                          std::exp(-std::pow(apart(share, share < 0.5F ? 0.10F : 0.90F) / 0.07F, 2.0F));
    // Cloth hangs and gathers above the waist.
    const auto column = static_cast<std::size_t>(share * 16.0F + 0.5F) % 16;
    const float slack = (z < 0.57F ? 0.003F : 0.005F) * smooth_step(0.80F, 0.70F, z) *
                        (look_.tucked_in && z < 0.61F ? 0.0F : 1.0F) * wave[k * 16 + column];
    return bust * breast + 0.004F * height_ * (1.0F - 0.5F * figure_) * breast + 0.003F * height_ * blade +
           0.006F * height_ * buttock + slack;
  };
  const std::vector<float> rows = ring_rows(loft.rings);
  pictures::ShirtCut cut;
  cut.front = look_.top == Top::jacket  ? pictures::ShirtCut::Front::open
              : look_.top == Top::shirt ? pictures::ShirtCut::Front::buttons
                                        : pictures::ShirtCut::Front::closed;
  cut.under = look_.under_jacket;
  const auto row_of = [&](float z) {
    std::size_t k = 1;
    while (k + 1 < rows.size() && loft.rings[k].centre.z() > z * height_) ++k;
    return static_cast<double>(rows[k] / rows.back());
  };
  cut.neckline = static_cast<double>(rows[1] / rows.back());
  cut.shoulder = row_of(0.80F), cut.chest = row_of(0.735F), cut.waist = row_of(0.62F);
  cut.hem = look_.tucked_in ? 1.0 : static_cast<double>(rows[rows.size() - 2] / rows.back());
  add(loft, trunk_cloth_texels, [&](cv::Size size, double texels, Random random) {
    return pictures::shirt(size, look_.top_cloth, cut, texels, random);
  });
  collar();

  Loft neck;
  for (const auto& [z, width, depth, y] : {std::array{0.900F, 0.0290F, 0.033F, 0.000F},
                                           {0.880F, 0.0300F, 0.032F, 0.002F},
                                           {0.862F, 0.0300F, 0.031F, 0.005F},
                                           {0.850F, 0.0315F, 0.032F, 0.006F},
                                           {0.840F, 0.0430F, 0.035F, 0.004F},
                                           {0.832F, 0.0570F, 0.039F, 0.003F},
                                           {0.822F, 0.0680F, 0.042F, 0.002F}}) {
    Ring ring;
    const float grow = (1.0F - 0.12F * figure_) * (1.0F + 0.5F * (girth_ - 1.0F)) * height_;
    ring.centre = {0.0F, y * height_, z * height_};
    ring.width = width * grow, ring.front = ring.back = depth * grow;
    neck.rings.push_back(ring);
  }
  neck.facets = 10;
  neck.weights = [this](const Vector3f& position) {
    return chain_weights(
        -position.z(), Bone::head,
        {{-0.878F * height_, 0.018F * height_, Bone::neck}, {-0.840F * height_, 0.016F * height_, Bone::chest}});
  };
  add(neck, 300.0F, [&](cv::Size size, double texels, Random random) {
    return pictures::bare_neck(size, look_.skin, texels, random);
  });
}

void PersonBuilder::collar() {
  if (look_.top == Top::t_shirt) return;
  const float rise = look_.top == Top::pullover ? 0.004F : 0.012F;
  Loft loft;
  const auto ring = [&](float z, float extra) {
    Ring result = trunk_ring(0.847F, height_, girth_, figure_, extra);
    result.centre.z() = z * height_;
    return result;
  };
  loft.rings = {ring(0.843F, -0.020F), ring(0.845F + rise, -0.004F), ring(0.847F + rise, 0.002F), ring(0.840F, 0.014F),
                ring(0.836F, 0.009F)};
  loft.facets = 12;
  loft.weights = [this](const Vector3f& position) {
    return chain_weights(-position.z(), Bone::neck, {{-0.850F * height_, 0.022F * height_, Bone::chest}});
  };
  add(loft, trunk_cloth_texels, [&](cv::Size size, double texels, Random random) {
    return pictures::collar(size, look_.top_cloth, look_.top != Top::pullover, texels, random);
  });
}

std::vector<Ring> PersonBuilder::seat_rings() const {
  std::vector<Ring> rings;
  const auto ring = [&](float z, float extra) { return trunk_ring(z, height_, girth_, figure_, 0.004F + extra); };
  rings.push_back(ring(0.588F, -0.010F));
  rings.push_back(ring(0.592F, 0.0F));
  for (const float z : {0.570F, 0.550F, 0.530F, 0.510F, 0.490F}) rings.push_back(ring(z, 0.0F));
  return rings;
}

void PersonBuilder::seat() {
  Loft loft;
  loft.rings = seat_rings();
  loft.facets = 14;
  const bool skirt = look_.bottom == Bottom::skirt;
  if (skirt) {
    const float flare = 0.026F;
    for (int k = 1; k <= 6; ++k) {
      const float down = static_cast<float>(k) / 6.0F;
      Ring ring = loft.rings.back();
      if (k == 1) ring = trunk_ring(0.47F, height_, girth_, figure_, 0.006F);
      ring.centre.z() = (0.49F - 0.21F * down) * height_;
      ring.width += flare / 6.0F * height_ * 0.5F, ring.front += flare / 6.0F * height_, ring.back += 0.004F * height_;
      loft.rings.push_back(ring);
    }
    // Closed below, so that between the legs of somebody who sits no hollow is seen.
    const Ring hem = loft.rings.back();
    for (const float inside : {0.90F, 0.55F, 0.0F}) {
      Ring under = hem;
      under.width *= inside, under.front *= inside, under.back *= inside;
      under.centre.z() += inside > 0.8F ? 0.008F : 0.03F;
      loft.rings.push_back(under);
    }
  } else {
    Ring low = trunk_ring(0.472F, height_, girth_, figure_, 0.0F);
    low.width *= 0.88F, low.front *= 0.85F, low.back *= 0.85F;
    loft.rings.push_back(low);
    low.centre.z() = 0.460F * height_, low.width *= 0.6F, low.front *= 0.5F, low.back *= 0.6F;
    loft.rings.push_back(low);
    low.centre.z() = 0.457F * height_, low.width = low.front = low.back = 0.0F;
    loft.rings.push_back(low);
  }
  loft.weights = [this, skirt](const Vector3f& position) {
    if (skirt && position.z() < 0.53F * height_) return skirt_weights(position);
    return trunk_weights(position);
  };
  loft.bulge = [&](float share, std::size_t k) {
    const float z = loft.rings[k].centre.z() / height_;
    const float buttock = std::exp(-std::pow((z - 0.500F) / 0.032F, 2.0F)) *
                          std::exp(-std::pow(apart(share, share < 0.5F ? 0.10F : 0.90F) / 0.07F, 2.0F));
    // A skirt falls in folds.
    const float fold = skirt ? 0.010F * smooth_step(0.50F, 0.34F, z) * std::cos(share * 44.0F) : 0.0F;
    return 0.006F * height_ * buttock + fold;
  };
  const std::vector<float> rows = ring_rows(loft.rings);
  const double hem = static_cast<double>(rows[rows.size() - std::min<std::size_t>(rows.size(), 4)] / rows.back());
  add(loft, trunk_cloth_texels, [&](cv::Size size, double texels, Random random) {
    if (skirt) return pictures::skirt(size, look_.bottom_cloth, hem, texels, random);
    return pictures::trouser_seat(size, look_.bottom_cloth, look_.tucked_in, texels, random);
  });
}

SkinWeights PersonBuilder::skirt_weights(const Vector3f& position) const {
  const float h = height_;
  const float left = smooth_step(-0.045F * h, 0.045F * h, position.x());
  const float thighs = smooth_step(0.54F * h, 0.46F * h, position.z());
  SkinWeights weights;
  weights.bones = {static_cast<std::uint8_t>(Bone::pelvis), static_cast<std::uint8_t>(Bone::left_thigh),
                   static_cast<std::uint8_t>(Bone::right_thigh), 0};
  weights.weights = {1.0F - thighs, thighs * left, thighs * (1.0F - left), 0.0F};
  return weights;
}

}  // namespace holdfast::simulation

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "person_builder.hpp"

namespace holdfast::simulation {

using Eigen::Vector3f;

namespace {
constexpr float cloth_texels = 400.0F, skin_texels = 300.0F, shoe_texels = 400.0F;  // per metre
constexpr float inner_seam_of_left = 0.25F, inner_seam_of_right = 0.75F;

// A section of a limb, as shares of the height: how far below the upper joint, half sizes, and where its centre lies.
struct LimbSection {
  float down, width, front, back, forward;
};

// Straight arm; 0 at the shoulder, the elbow at 0.186, the wrist at 0.332.
constexpr LimbSection arm_sections[] = {
    {-0.004F, 0.025F, 0.027F, 0.027F, 0.0F},   {0.018F, 0.0285F, 0.033F, 0.032F, 0.0F},
    {0.050F, 0.0285F, 0.0325F, 0.031F, 0.0F},  {0.090F, 0.0265F, 0.030F, 0.029F, 0.0F},
    {0.130F, 0.0245F, 0.027F, 0.027F, 0.0F},   {0.165F, 0.0230F, 0.0235F, 0.025F, 0.0F},
    {0.186F, 0.0230F, 0.0225F, 0.025F, 0.0F},  {0.207F, 0.0240F, 0.0240F, 0.0235F, 0.0F},
    {0.240F, 0.0235F, 0.0245F, 0.0225F, 0.0F}, {0.280F, 0.0190F, 0.0205F, 0.0190F, 0.0F},
    {0.315F, 0.0150F, 0.0175F, 0.0165F, 0.0F}, {0.335F, 0.0140F, 0.0175F, 0.0165F, 0.0F}};
// Straight leg; 0 at the hip, the knee at 0.245, the ankle at 0.491.
constexpr LimbSection leg_sections[] = {
    {-0.020F, 0.034F, 0.036F, 0.042F, 0.0F},      {0.005F, 0.042F, 0.046F, 0.056F, 0.0F},
    {0.040F, 0.0460F, 0.051F, 0.060F, 0.0F},      {0.080F, 0.0455F, 0.051F, 0.055F, 0.0F},
    {0.130F, 0.0430F, 0.047F, 0.047F, 0.0F},      {0.220F, 0.0325F, 0.0365F, 0.0325F, 0.0F},
    {0.245F, 0.0315F, 0.0355F, 0.0315F, 0.0F},    {0.270F, 0.0300F, 0.0310F, 0.0340F, 0.0F},
    {0.315F, 0.0310F, 0.0280F, 0.0390F, -0.002F}, {0.360F, 0.0285F, 0.0255F, 0.0355F, -0.003F},
    {0.410F, 0.0225F, 0.0220F, 0.0270F, -0.004F}, {0.490F, 0.0190F, 0.0210F, 0.0220F, -0.003F}};

template <std::size_t count>
LimbSection limb_at(const LimbSection (&sections)[count], float down) {
  std::size_t k = 0;
  while (k + 2 < count && sections[k + 1].down < down) ++k;
  const LimbSection &a = sections[k], &b = sections[k + 1];
  const float t = std::clamp((down - a.down) / (b.down - a.down), 0.0F, 1.0F);
  const auto mix = [&](float LimbSection::*member) { return a.*member + t * (b.*member - a.*member); };
  return {down, mix(&LimbSection::width), mix(&LimbSection::front), mix(&LimbSection::back),
          mix(&LimbSection::forward)};
}

Ring limb_ring(const LimbSection& section, const Vector3f& joint, float height, float grow, float loose) {
  Ring ring;
  ring.centre = joint + height * Vector3f(0.0F, -section.forward, -section.down);
  ring.width = section.width * height * grow + loose;
  ring.front = section.front * height * grow + loose, ring.back = section.back * height * grow + loose;
  ring.power = 2.1F;
  return ring;
}

// Turned in at the end, so that no edge is seen to be a shell.
void close_hem(std::vector<Ring>& rings, float inset) {
  Ring ring = rings.back();
  ring.width -= inset, ring.front -= inset, ring.back -= inset, ring.centre.z() += 0.006F;
  rings.push_back(ring);
}

// Wrinkles that change the outline, each vertex its own.
std::function<float(float, std::size_t)> wrinkles(Random random, std::size_t rings, int facets, float size) {
  std::vector<float> values(rings * static_cast<std::size_t>(facets));
  for (float& value : values) value = size * static_cast<float>(random.uniform(-1.0, 1.0));
  return [values = std::move(values), facets](float share, std::size_t k) {
    const auto column = static_cast<std::size_t>(share * static_cast<float>(facets) + 0.5F) % facets;
    return values[k * static_cast<std::size_t>(facets) + column];
  };
}
}  // namespace

SkinWeights PersonBuilder::arm_weights(bool left, const Vector3f& position) const {
  const float h = height_, shoulder = joint(Bone::left_upper_arm).z();
  const auto bone = [&](Bone of_left, Bone of_right) { return left ? of_left : of_right; };
  return chain_weights(shoulder - position.z(), Bone::chest,
                       {{-0.004F * h, 0.026F * h, bone(Bone::left_upper_arm, Bone::right_upper_arm)},
                        {0.186F * h, 0.026F * h, bone(Bone::left_forearm, Bone::right_forearm)},
                        {0.332F * h, 0.012F * h, bone(Bone::left_hand, Bone::right_hand)}});
}

SkinWeights PersonBuilder::leg_weights(bool left, const Vector3f& position) const {
  const float h = height_, hip = joint(Bone::left_thigh).z();
  const auto bone = [&](Bone of_left, Bone of_right) { return left ? of_left : of_right; };
  return chain_weights(hip - position.z(), Bone::pelvis,
                       {{0.010F * h, 0.034F * h, bone(Bone::left_thigh, Bone::right_thigh)},
                        {0.245F * h, 0.032F * h, bone(Bone::left_shin, Bone::right_shin)},
                        {0.487F * h, 0.012F * h, bone(Bone::left_foot, Bone::right_foot)}});
}

void PersonBuilder::arms() {
  for (const bool left : {true, false}) arm(left), hand(left);
}

void PersonBuilder::legs() {
  for (const bool left : {true, false}) leg(left), shoe(left);
}

void PersonBuilder::arm(bool left) {
  const Vector3f shoulder = joint(left ? Bone::left_upper_arm : Bone::right_upper_arm);
  const float inwards = left ? -1.0F : 1.0F;
  const float grow = (1.0F - 0.13F * figure_) * (1.0F + 0.6F * (girth_ - 1.0F));
  const bool jacket = look_.top == Top::jacket;
  const float loose = jacket ? 0.012F : look_.top == Top::t_shirt ? 0.006F : 0.008F;
  const float hem = look_.long_sleeves ? 0.330F : 0.120F;

  Loft sleeve;
  // Over the shoulder: flat, and leaning to the neck.
  const auto cap = [&](float down, float width, float depth, float lean) {
    LimbSection section{down, width, depth, depth, 0.0F};
    Ring ring = limb_ring(section, shoulder, height_, grow, width > 0.0F ? loose : 0.0F);
    ring.centre.x() += inwards * lean * height_;
    sleeve.rings.push_back(ring);
  };
  cap(-0.0100F, 0.0F, 0.0F, 0.020F);
  cap(-0.0090F, 0.0100F, 0.0130F, 0.016F);
  cap(-0.0030F, 0.0200F, 0.0220F, 0.009F);
  cap(0.0060F, 0.0255F, 0.0285F, 0.003F);
  for (const LimbSection& section : arm_sections)
    if (section.down > 0.010F && section.down < hem - 0.008F) {
      const float flare = look_.long_sleeves ? 0.004F * smooth_step(0.20F, 0.28F, section.down) : 0.0F;
      sleeve.rings.push_back(limb_ring(section, shoulder, height_, grow, loose + flare));
    }
  sleeve.rings.push_back(
      limb_ring(limb_at(arm_sections, hem), shoulder, height_, grow, loose + (look_.long_sleeves ? 0.003F : 0.006F)));
  close_hem(sleeve.rings, look_.long_sleeves ? 0.012F : 0.017F);
  sleeve.facets = 9;
  sleeve.seam = left ? inner_seam_of_left : inner_seam_of_right;
  sleeve.weights = [this, left](const Vector3f& position) { return arm_weights(left, position); };
  sleeve.bulge = wrinkles(random_.fork(left ? 601 : 602), sleeve.rings.size(), sleeve.facets,
                          look_.long_sleeves ? 0.0035F : 0.002F);
  add(sleeve, cloth_texels, [&](cv::Size size, double texels, Random random) {
    return pictures::sleeve(size, look_.top_cloth, look_.long_sleeves, texels, random);
  });

  if (look_.long_sleeves) return;
  Loft bare;
  for (const LimbSection& section : arm_sections)
    if (section.down > hem - 0.045F) bare.rings.push_back(limb_ring(section, shoulder, height_, grow, 0.0F));
  bare.facets = 9;
  bare.seam = sleeve.seam;
  bare.weights = sleeve.weights;
  add(bare, skin_texels, [&](cv::Size size, double texels, Random random) {
    return pictures::bare_limb(size, look_.skin, texels, random);
  });
}

void PersonBuilder::hand(bool left) {
  const Bone bone = left ? Bone::left_hand : Bone::right_hand;
  const Vector3f wrist = joint(bone);
  const float inwards = left ? -1.0F : 1.0F;
  const float length = static_cast<float>(skeleton_.length(bone)), size_factor = height_ * (1.0F - 0.08F * figure_);
  const auto weights = [this, left](const Vector3f& position) { return arm_weights(left, position); };
  Loft palm;
  const auto ring = [&](float down, float thickness, float breadth, float bend, float forward) {
    Ring result;
    result.centre = wrist + Vector3f(inwards * bend * height_, -forward * height_, -down * length);
    result.width = thickness * size_factor, result.front = result.back = breadth * size_factor;
    result.power = 2.4F;
    palm.rings.push_back(result);
  };
  ring(-0.12F, 0.0125F, 0.0155F, 0.0F, 0.0F);
  ring(0.06F, 0.0115F, 0.0165F, 0.0F, 0.0F);
  ring(0.24F, 0.0115F, 0.0215F, 0.0F, 0.002F);
  ring(0.45F, 0.0100F, 0.0225F, 0.001F, 0.001F);
  ring(0.60F, 0.0085F, 0.0215F, 0.005F, 0.0F);
  ring(0.80F, 0.0075F, 0.0195F, 0.014F, 0.0F);
  ring(0.94F, 0.0060F, 0.0150F, 0.022F, 0.0F);
  ring(1.00F, 0.0F, 0.0F, 0.026F, 0.0F);
  palm.facets = 8;
  palm.seam = left ? inner_seam_of_left : inner_seam_of_right;
  palm.weights = weights;
  add(palm, skin_texels,
      [&](cv::Size size, double texels, Random random) { return pictures::hand(size, look_.skin, texels, random); });

  Loft thumb;
  const Vector3f from = wrist + Vector3f(inwards * 0.002F, -0.012F * height_, -0.16F * length);
  const Vector3f to = wrist + Vector3f(inwards * 0.010F, -0.030F * height_, -0.60F * length);
  const Vector3f along = (to - from).normalized();
  for (const auto& [share, radius] : {std::pair(0.0F, 0.0085F), {0.35F, 0.0085F}, {0.8F, 0.0065F}, {1.0F, 0.0F}}) {
    Ring result;
    result.centre = from + share * (to - from);
    result.across = (Vector3f::UnitX() - Vector3f::UnitX().dot(along) * along).normalized();
    result.behind = result.across.cross(along);
    result.width = result.front = result.back = radius * size_factor;
    thumb.rings.push_back(result);
  }
  thumb.facets = 5;
  thumb.seam = palm.seam;
  thumb.weights = weights;
  add(thumb, skin_texels, [&](cv::Size size, double texels, Random random) {
    return pictures::bare_limb(size, look_.skin, texels, random);
  });
}

void PersonBuilder::leg(bool left) {
  const Vector3f hip = joint(left ? Bone::left_thigh : Bone::right_thigh);
  const float grow = (1.0F + 0.02F * figure_) * (1.0F + 0.5F * (girth_ - 1.0F));
  const bool skirt = look_.bottom == Bottom::skirt, trousers = look_.bottom == Bottom::trousers;
  const float hem = trousers ? 0.478F : 0.215F;
  const auto weights = [this, left](const Vector3f& position) { return leg_weights(left, position); };
  const float seam = left ? inner_seam_of_left : inner_seam_of_right;
  const float outwards = left ? 1.0F : -1.0F;
  if (!skirt) {
    Loft loft;
    // Trousers hang from the knee down more than they follow the calf.
    const auto ring = [&](float down) {
      LimbSection section = limb_at(leg_sections, down);
      if (trousers) {
        const float hang = smooth_step(0.22F, 0.44F, down);
        section.width = std::max(section.width, 0.029F + 0.0005F * hang);
        section.front = std::max(section.front, 0.030F), section.back = std::max(section.back, 0.031F);
      }
      Ring result = limb_ring(section, hip, height_, grow, trousers ? 0.004F : 0.004F + 0.06F * down);
      result.centre.x() += outwards * 0.003F * height_ * smooth_step(0.12F, 0.0F, down) * figure_;
      return result;
    };
    for (const LimbSection& section : leg_sections)
      if (section.down < hem - 0.010F) loft.rings.push_back(ring(section.down));
    loft.rings.push_back(ring(hem));
    close_hem(loft.rings, trousers ? 0.010F : 0.026F);
    loft.facets = 11;
    loft.seam = seam;
    loft.weights = weights;
    loft.bulge = wrinkles(random_.fork(left ? 701 : 702), loft.rings.size(), loft.facets, 0.0035F);
    add(loft, cloth_texels, [&](cv::Size size, double texels, Random random) {
      return pictures::trouser_leg(size, look_.bottom_cloth, !trousers, left ? 0.25 : 0.75, texels, random);
    });
  }
  if (trousers) return;
  Loft bare;
  for (const LimbSection& section : leg_sections)
    if (section.down > (skirt ? 0.12F : hem - 0.05F))
      bare.rings.push_back(limb_ring(section, hip, height_, 0.97F * grow, 0.0F));
  bare.facets = 9;
  bare.seam = seam;
  bare.weights = weights;
  add(bare, skin_texels, [&](cv::Size size, double texels, Random random) {
    return pictures::bare_limb(size, look_.skin, texels, random);
  });
}

void PersonBuilder::shoe(bool left) {
  const Bone bone = left ? Bone::left_foot : Bone::right_foot;
  const Vector3f ankle = joint(bone);
  const auto length = static_cast<float>(skeleton_.length(bone));
  const float narrow = 1.0F - 0.08F * figure_;
  Loft loft;
  const auto ring = [&](float along, float width, float low, float high) {
    Ring result;
    result.centre = Vector3f(ankle.x(), -along * length, 0.5F * (low + high) * height_);
    result.behind = -Vector3f::UnitZ();
    result.width = width * height_ * narrow;
    result.front = result.back = 0.5F * (high - low) * height_;
    result.power = 2.7F;
    loft.rings.push_back(result);
  };
  ring(-0.270F, 0.0F, 0.016F, 0.016F);
  ring(-0.262F, 0.0110F, 0.003F, 0.036F);
  ring(-0.215F, 0.0180F, 0.0F, 0.047F);
  ring(-0.020F, 0.0213F, 0.0F, 0.052F);
  ring(0.190F, 0.0230F, 0.0F, 0.042F);
  ring(0.370F, 0.0265F, 0.0F, 0.032F);
  ring(0.550F, 0.0275F, 0.0F, 0.026F);
  ring(0.690F, 0.0235F, 0.0F, 0.022F);
  ring(0.755F, 0.0140F, 0.002F, 0.018F);
  ring(0.770F, 0.0F, 0.010F, 0.010F);
  loft.facets = 8;
  loft.weights = [bone](const Vector3f&) { return chain_weights(0.0F, bone, {}); };
  add(loft, shoe_texels, [&](cv::Size size, double texels, Random random) {
    return pictures::shoe(size, look_.shoes, look_.soles, texels, random);
  });
}

}  // namespace holdfast::simulation

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <opencv2/imgproc.hpp>

#include "holdfast/simulation/person.hpp"
#include "person_loft.hpp"

namespace holdfast::simulation {

/// Makes the parts of one person's mesh. Lengths in the members named after the body are shares of the height.
class PersonBuilder {
 public:
  PersonBuilder(World& world, Mesh& mesh, const Skeleton& skeleton, const PersonLook& look, Random random);

  void trunk();  ///< what is worn above, with its collar, and the neck
  void seat();   ///< what is worn below, down to where the legs part
  void arms();   ///< sleeves, forearms and hands
  void legs();   ///< legs of the trousers, or bare ones, and shoes
  void head();   ///< face and ears
  void hair();

 private:
  void arm(bool left);
  void hand(bool left);
  void leg(bool left);
  void shoe(bool left);
  void ear(bool left);
  void collar();

  std::vector<Ring> trunk_rings() const;
  std::vector<Ring> seat_rings() const;
  /// A point of the head: `share` of a turn from behind over the right, `rise` from 0 at the chin to 1 at the crown of
  /// the bald skull, moved outwards [m]. `curtain`: below the cheekbones as wide and deep as there.
  Eigen::Vector3f head_point(float share, float rise, float outwards, bool curtain = false) const;
  Eigen::Vector3f joint(Bone bone) const { return rest_[index(bone)].translation().cast<float>(); }
  /// Standard deviation [m] of the blur on what people wear, and on faces. Cloth has no edges as sharp as print on
  /// paper, and who comes close to a camera is out of its focus: so people offer a tracker about as many corners as
  /// photographed people of the same size in the image.
  static constexpr double cloth_softness = 0.008, face_softness = 0.002;

  /// Adds a skin with a texture of its own, painted by painter(size, texels per metre, Random).
  template <typename Painter>
  void add(const Loft& loft, float texels, Painter&& painter) {
    const Eigen::Vector2f size = flat_size(loft.rings) * texels;
    add_loft(mesh_, loft, paint(size, texels, painter));
  }
  template <typename Painter>
  TextureArea paint(const Eigen::Vector2f& size, float texels, Painter&& painter, double softness = cloth_softness) {
    const cv::Size whole(std::max(8, static_cast<int>(size.x())), std::max(8, static_cast<int>(size.y())));
    cv::Mat picture = painter(whole, static_cast<double>(texels), random_.fork(++painted_));
    cv::GaussianBlur(picture, picture, {}, softness * texels, softness * texels, cv::BORDER_REPLICATE);
    return world_.add_texture(picture);
  }

  SkinWeights trunk_weights(const Eigen::Vector3f& position) const;
  SkinWeights arm_weights(bool left, const Eigen::Vector3f& position) const;
  SkinWeights leg_weights(bool left, const Eigen::Vector3f& position) const;
  SkinWeights skirt_weights(const Eigen::Vector3f& position) const;

  World& world_;
  Mesh& mesh_;
  const Skeleton& skeleton_;
  const PersonLook& look_;
  Random random_;
  std::uint64_t painted_ = 0;
  BonePoses rest_;
  float height_, girth_, figure_;
};

}  // namespace holdfast::simulation

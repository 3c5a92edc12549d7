// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <string>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// A place on the floor or a table: where a thing's own origin comes to stand, and its turn about z [rad].
struct Place {
  double x = 0, y = 0, z = 0, yaw = 0;
};

/// Puts furniture into a world. Things are built with their front to -y and their origin on the ground below the
/// middle, then put in place. Every thing draws its random numbers from a stream of its own name, so adding one leaves
/// the others as they were.
class RoomBuilder {
 public:
  RoomBuilder(World& world, std::uint64_t seed) : world_(world), seed_(seed) {}

  void shell();
  void rug(const Place& place, double width, double depth);
  void desk(const Place& place, double width, double depth);
  void monitor(const Place& place, double width);
  void keyboard_and_mouse(const Place& place);
  void mug(const Place& place);
  void pen_holder(const Place& place);
  void package(const Place& place, double width, double depth, double height);
  void page(const Place& place);
  void book_pile(const Place& place, int count);
  void lamp(const Place& place);
  void telephone(const Place& place);
  void cable(const Place& from, const Place& to);
  void chair(const Place& place);
  void cabinet(const Place& place, double width, double depth, double height);
  void cardboard_box(const Place& place, double width, double depth, double height);
  void bookcase(const Place& place, double width, double height);
  /// A board with books at the wall, its middle at place.
  void wall_shelf(const Place& place, double width);
  void poster(const Place& place, double width, double height);
  void painting(const Place& place, double width, double height);
  void clock(const Place& place);
  void plant(const Place& place, double height);

 private:
  /// A new object at a place; the reference is valid until the next call.
  Object& add(const std::string& class_name, const Place& place);
  /// A picture painted for the object that was added last.
  TextureArea paint(cv::Mat picture) { return world_.add_texture(picture); }
  /// The random stream of the object that was added last.
  Random random() const { return random_; }
  /// A box with a picture of each side's own, `density` texels per metre; painter(size, random) makes it.
  template <class Painter>
  BoxSkin skin(const Eigen::AlignedBox3f& box, double density, Painter&& painter);
  /// One plain colour for all sides.
  BoxSkin plain_skin(const cv::Scalar& colour);
  /// Books side by side between two ends, standing on `ground`, backs at y = front.
  void row_of_books(Object& object, double from, double to, double front, double ground, double most_height);

  World& world_;
  std::uint64_t seed_;
  Random random_{0};
};

}  // namespace holdfast::simulation

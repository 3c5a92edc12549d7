// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <string>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/world.hpp"
#include "measures.hpp"

namespace holdfast::simulation {

/// A place on the floor or a table: where a thing's own origin comes to stand, and its turn about z [rad].
struct Place {
  double x = 0, y = 0, z = 0, yaw = 0;
};

/// Walls, floor and ceiling, with a doorway if there is a door.
struct Shell {
  float width = 6.0F, depth = 5.0F, height = 2.6F;                              ///< along x, y, z [m]
  double wall_density = 200.0, floor_density = 200.0, ceiling_density = 120.0;  ///< [texels/m]
  float door_from = 0.0F, door_to = 0.0F;  ///< x of the doorway's sides in the wall y = depth; equal: none
};
inline constexpr float door_height = 2.0F;

/// Puts furniture into a world. Things are built with their front to -y and their origin on the ground below the
/// middle, then put in place. Every thing draws its random numbers from a stream of its own name, so adding one leaves
/// the others as they were.
class RoomBuilder {
 public:
  RoomBuilder(World& world, std::uint64_t seed) : world_(world), seed_(seed) {}

  void shell(const Shell& shell);
  /// A section of a corridor along x: both walls (y = 0 and y = depth), floor and ceiling, that can be repeated.
  void corridor_section(double from, double to, double depth, double height);
  /// The walls x = 0 and x = width.
  void end_walls(double width, double depth, double height);
  /// The frame, and the leaf as an object of its own: its z axis is the hinge at the right end, its x axis points away
  /// from the doorway, so that a turn about z by a positive angle swings it into the room. `place` is the hinge.
  void door(const Place& place, double width);
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
  /// A table on four legs; `stool`: any low one.
  void table(const Place& place, double width, double depth, double height = table_top);
  void stool(const Place& place, double width, double depth, double height);
  /// A screen between workplaces, covered with cloth, with papers pinned to both sides.
  void partition(const Place& place, double width, double height);
  /// A board with papers pinned to it.
  void notice_board(const Place& place, double width, double height);

  /// Number of the next object.
  std::size_t mark() const { return world_.objects.size(); }
  /// Copies the objects from one mark up to another, moved by `offset`: the same meshes and light on the same textures.
  void repeat(std::size_t from, std::size_t to, const Eigen::Vector3d& offset);

 private:
  /// A new object at a place; the reference is valid until the next call.
  Object& add(const std::string& class_name, const Place& place);
  /// Legs and board of a table.
  void four_legs(Object& object, double width, double depth, double height);
  /// A picture painted for the object that was added last.
  TextureArea paint(cv::Mat picture) { return world_.add_texture(picture); }
  /// The random stream of the object that was added last.
  Random random() const { return random_; }
  /// Pictures for the sides of a box, `density` texels per metre, made by painter(size, random). Opposite sides share
  /// one unless `all_different`.
  template <class Painter>
  BoxSkin skin(const Eigen::AlignedBox3f& box, double density, Painter&& painter, bool all_different = false);
  /// One plain colour for all sides.
  BoxSkin plain_skin(const cv::Scalar& colour);
  /// Books side by side between two ends, standing on `ground`, backs at y = front.
  void row_of_books(Object& object, double from, double to, double front, double ground, double most_height);

  World& world_;
  std::uint64_t seed_;
  Random random_{0};
};

template <class Painter>
BoxSkin RoomBuilder::skin(const Eigen::AlignedBox3f& shape, double density, Painter&& painter, bool all_different) {
  const Eigen::Vector3f size = shape.sizes();
  const auto painted = [&](BoxSide side, float width, float height, double fineness) {
    return paint(painter(texels(width, height, fineness), random_.fork(static_cast<std::uint64_t>(side) + 1)));
  };
  BoxSkin result;
  result[front] = painted(front, size.x(), size.z(), density);
  result[left] = painted(left, size.y(), size.z(), density);
  result[top] = painted(top, size.x(), size.y(), density);
  result[bottom] = painted(bottom, size.x(), size.y(), 20.0);
  // Opposite sides are never seen at once.
  result[back] = all_different ? painted(back, size.x(), size.z(), density) : result[front];
  result[right] = all_different ? painted(right, size.y(), size.z(), density) : result[left];
  random_.next();
  return result;
}

}  // namespace holdfast::simulation

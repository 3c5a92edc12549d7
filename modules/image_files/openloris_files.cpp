// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/openloris_files.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include "yaml_numbers.hpp"

namespace holdfast {

namespace {

using yaml_numbers::location;

constexpr const char* robot_frame = "base_link";

/// Looks up keys of a map of the file that must be there.
struct OpenLorisMap {
  const std::filesystem::path& file;
  YAML::Node node;
  std::string name;  ///< of the map, for errors

  YAML::Node at(const char* key) const {
    const YAML::Node value = node.IsMap() ? node[key] : YAML::Node(YAML::NodeType::Undefined);
    if (!node.IsMap() || !value.IsDefined())
      throw InputError(location(file, node.Mark()), name + " lacks " + key +
                                                        "; expected the calibration of a sensor as "
                                                        "OpenLORIS-Scene has it; unpack the file again");
    return value;
  }
  std::string text(const char* key) const {
    const YAML::Node value = at(key);
    if (!value.IsScalar()) yaml_numbers::reject(file, value, key, "a name");
    return value.Scalar();
  }
  /// The numbers of a matrix as OpenCV writes it: a map with rows, cols, dt and data.
  std::vector<double> matrix(const char* key, const std::vector<std::size_t>& counts) const {
    return yaml_numbers::numbers(file, OpenLorisMap{file, at(key), key}.at("data"), key, counts);
  }
};

Distortion read_distortion_of(const OpenLorisMap& sensor) {
  const std::string model = sensor.text("distortion_model");
  if (model == "none" || model == "None") return {};
  const std::vector<double> k = sensor.matrix("distortion_coefficients", {4, 5});
  const bool is_fisheye = model == "Kannala-Brandt" || model == "equidistant";
  if (!is_fisheye && model != "radial-tangential")
    yaml_numbers::reject(sensor.file, sensor.at("distortion_model"), "distortion_model",
                         "radial-tangential, Kannala-Brandt or none");
  return yaml_numbers::distortion(is_fisheye ? Lens::fisheye : Lens::radial_tangential, k);
}

/// The pose of one frame in another.
struct FrameLink {
  std::string parent, child;
  Eigen::Isometry3d T_parent_child;
};

FrameLink read_link(const std::filesystem::path& file, const YAML::Node& node) {
  const OpenLorisMap map{file, node, "a transform"};
  const auto motion = yaml_numbers::rigid_motion(map.matrix("matrix", {16}));
  if (!motion)
    throw InputError(location(file, node.Mark()), "found a matrix of " + map.text("child_frame") +
                                                      " that is not a rigid motion; expected a rotation "
                                                      "with a translation [m], row by row, the last row 0 0 0 1");
  return {map.text("parent_frame"), map.text("child_frame"), *motion};
}

}  // namespace

Camera read_openloris_camera(const std::filesystem::path& file, const std::string& sensor) {
  const YAML::Node root = yaml_numbers::load(file, "the calibration of the sensors, which OpenLORIS-Scene has");
  const OpenLorisMap map{file, OpenLorisMap{file, root, "the file"}.at(sensor.c_str()), sensor};
  if (map.text("model") != "pinhole") yaml_numbers::reject(file, map.at("model"), "model", "pinhole");
  Camera camera;
  camera.name = sensor;
  camera.width = yaml_numbers::size(file, map.at("width"), "width");
  camera.height = yaml_numbers::size(file, map.at("height"), "height");
  camera.frame_rate = yaml_numbers::number(file, map.at("fps"), "fps", true);
  const std::vector<double> intrinsics = map.matrix("intrinsics", {4});
  camera.fx = intrinsics[0], camera.cx = intrinsics[1], camera.fy = intrinsics[2], camera.cy = intrinsics[3];
  if (camera.fx <= 0.0 || camera.fy <= 0.0)
    throw InputError(location(file, map.at("intrinsics").Mark()),
                     "found a focal length that is not positive; expected fx, cx, fy, cy in this order");
  camera.distortion = read_distortion_of(map);
  if (const std::string trouble = camera.trouble(); !trouble.empty())
    throw InputError(location(file, map.at("distortion_coefficients").Mark()), trouble);
  return camera;
}

Eigen::Isometry3d read_openloris_pose(const std::filesystem::path& file, const std::string& sensor) {
  const YAML::Node root = yaml_numbers::load(
      file,
      "the poses of the sensors on the robot, by which the recorded poses of base_link become those of the camera");
  std::vector<FrameLink> links;
  for (const YAML::Node& node : OpenLorisMap{file, root, "the file"}.at("trans_matrix"))
    links.push_back(read_link(file, node));
  // Breadth-first search through the tree; an edge may lead either way.
  struct Reached {
    std::string frame;
    Eigen::Isometry3d T_base_frame;
  };
  std::vector<Reached> reached = {{robot_frame, Eigen::Isometry3d::Identity()}};
  std::set<std::string> seen = {robot_frame};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const Reached from = reached[i];
    if (from.frame == sensor) return from.T_base_frame;
    for (const FrameLink& link : links) {
      if (link.parent == from.frame && seen.insert(link.child).second)
        reached.push_back({link.child, from.T_base_frame * link.T_parent_child});
      if (link.child == from.frame && seen.insert(link.parent).second)
        reached.push_back({link.parent, from.T_base_frame * link.T_parent_child.inverse()});
    }
  }
  throw InputError({file.string()}, "has no chain of transforms from " + std::string(robot_frame) + " to " + sensor +
                                        "; expected the poses of all sensors on the robot; unpack the file again");
}

}  // namespace holdfast

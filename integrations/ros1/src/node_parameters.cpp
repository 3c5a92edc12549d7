// SPDX-License-Identifier: BSD-3-Clause
#include "node_parameters.hpp"

#include <set>
#include <stdexcept>
#include <vector>

namespace holdfast_ros {

namespace {

/// Reads parameters by name, and finds those that nothing reads.
class Reader {
 public:
  explicit Reader(const ros::NodeHandle& node) : node_(node) {}

  template <class Value>
  void read(const std::string& name, Value& value) {
    known_.insert(node_.resolveName(name));
    if (!node_.hasParam(name) || node_.getParam(name, value)) return;
    throw std::runtime_error("parameter '" + name + "' of " + node_.getNamespace() +
                             " has a value of another type; README.md of integrations/ros1 lists the types");
  }

  void refuse_unknown() const {
    std::vector<std::string> names;
    node_.getParamNames(names);
    const std::string beginning = node_.getNamespace() + "/";
    for (const std::string& name : names)
      if (name.compare(0, beginning.size(), beginning) == 0 && known_.count(name) == 0)
        throw std::runtime_error("there is no parameter '" + name.substr(beginning.size()) +
                                 "'; README.md of integrations/ros1 lists all; those of the pipeline are set by `set`, "
                                 "such as set: [tracking.minimum_inliers=15]");
  }

 private:
  const ros::NodeHandle& node_;
  std::set<std::string> known_;
};

}  // namespace

NodeParameters read_parameters(const ros::NodeHandle& node) {
  NodeParameters p;
  Reader reader(node);
  std::string start = "new";
  bool has_grid = true;
  reader.read("configuration", p.bridge.configuration);
  reader.read("set", p.bridge.overrides);
  reader.read("depth", p.bridge.has_depth);
  reader.read("stereo", p.bridge.has_right);
  reader.read("rectified", p.bridge.is_rectified);
  reader.read("compressed", p.is_compressed);
  reader.read("grid", has_grid);
  reader.read("tolerance", p.bridge.tolerance);
  reader.read("depth_factor", p.bridge.depth_factor);
  reader.read("queue", p.bridge.queue);
  reader.read("map_interval", p.bridge.map_interval);
  reader.read("grid_interval", p.bridge.grid_interval);
  reader.read("map_file", p.bridge.map_file);
  reader.read("start", start);
  reader.read("map_frame", p.map_frame);
  reader.read("odom_frame", p.odom_frame);
  reader.read("base_frame", p.base_frame);
  reader.read("camera_frame", p.camera_frame);
  reader.read("publish_tf", p.publishes_tf);
  reader.read("external_odometry", p.has_external_odometry);
  reader.read("transform_tolerance", p.transform_tolerance);
  reader.read("transform_wait", p.transform_wait);
  reader.refuse_unknown();
  if (has_grid) p.bridge.overrides.insert(p.bridge.overrides.begin(), "surface.enabled=true");
  if (p.bridge.configuration.empty())
    throw std::runtime_error("parameter 'configuration' is missing; expected the YAML file of a pipeline");
  if (start != "new" && start != "continue" && start != "localise")
    throw std::runtime_error("found '" + start + "' for 'start'; expected new, continue or localise");
  p.bridge.localise_only = start == "localise";
  if (start == "new")
    p.bridge.map_file.clear();
  else if (p.bridge.map_file.empty())
    throw std::runtime_error("'start' is '" + start + "' without 'map_file'; expected the file of a map");
  return p;
}

std::string map_file_of(const ros::NodeHandle& node) {
  std::string file;
  node.getParam("map_file", file);
  return file;
}

}  // namespace holdfast_ros

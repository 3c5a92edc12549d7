// SPDX-License-Identifier: BSD-3-Clause
#include "node_parameters.hpp"

#include <set>
#include <stdexcept>
#include <utility>
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
        throw holdfast::bridge::unknown_parameter(name.substr(beginning.size()), "ros1");
  }

 private:
  const ros::NodeHandle& node_;
  std::set<std::string> known_;
};

}  // namespace

NodeParameters read_parameters(const ros::NodeHandle& node) {
  NodeParameters parameters;
  Reader reader(node);
  holdfast::bridge::visit_parameters(parameters, [&](const char* name, auto& value) { reader.read(name, value); });
  reader.refuse_unknown();
  return holdfast::bridge::resolved(std::move(parameters));
}

std::string map_file_of(const ros::NodeHandle& node) {
  std::string file;
  node.getParam("map_file", file);
  return file;
}

}  // namespace holdfast_ros

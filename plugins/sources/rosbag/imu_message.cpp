// SPDX-License-Identifier: BSD-3-Clause
#include "imu_message.hpp"

#include <algorithm>
#include <memory>

#include "holdfast/core/error.hpp"
#include "image_message.hpp"

namespace holdfast::rosbag_plugin {

ImuSample read_imu_message(const Message& message) {
  ImuSample sample;
  sample.timestamp = read_stamp(message);
  const std::unique_ptr<MessageReader> reader = message.open();
  reader->stamp();
  reader->text("frame name");
  const auto pass = [&](int count, const char* what) {
    for (int i = 0; i < count; ++i) reader->number<double>(what);
  };
  const auto vector = [&](Eigen::Vector3d& values, const char* what) {
    for (double& value : values) value = reader->number<double>(what);
  };
  pass(4, "orientation");
  pass(9, "covariance of the orientation");
  vector(sample.angular_velocity, "angular velocity");
  pass(9, "covariance of the angular velocity");
  vector(sample.acceleration, "linear acceleration");
  if (!sample.angular_velocity.allFinite() || !sample.acceleration.allFinite())
    throw InputError({message.place}, "has a measurement that is not finite; expected finite numbers");
  return sample;
}

std::string choose_imu_topic(const Bag& bag, const std::string& name, bool is_wanted) {
  if (name == "none" || (name.empty() && !is_wanted)) return {};
  std::vector<std::string> found;
  std::string list;
  for (const BagTopic& topic : bag.topics()) {
    if (topic.type != imu_type || !topic.is_readable() || topic.messages == 0) continue;
    if (topic.name == name) return name;
    found.push_back(topic.name);
    list += (list.empty() ? "" : ", ") + topic.name;
  }
  const std::string known = list.empty() ? "the recording has none" : "the recording has " + list;
  if (!name.empty())
    throw InputError({bag.path().string()}, "has no inertial measurements (sensor_msgs/Imu) on the topic '" + name +
                                                "'; " + known + "; correct `source.rosbag.imu`");
  if (found.size() > 1)
    throw InputError({bag.path().string()},
                     "has several topics of inertial measurements: " + list +
                         "; choose one with gyroscope and accelerometer by `source.rosbag.imu`, or none");
  return found.empty() ? "" : found.front();
}

std::vector<ImuSample> read_imu_topic(Bag& bag, const std::string& topic) {
  std::vector<ImuSample> samples;
  if (topic.empty()) return samples;
  for (const BagMessage& message : bag.messages(topic)) samples.push_back(read_imu_message(bag.content(message)));
  const auto is_earlier = [](const ImuSample& a, const ImuSample& b) { return a.timestamp < b.timestamp; };
  std::stable_sort(samples.begin(), samples.end(), is_earlier);
  for (std::size_t i = 1; i < samples.size(); ++i)
    if (!is_earlier(samples[i - 1], samples[i]))
      throw InputError({bag.path().string() + ", " + topic},
                       "has two messages with the time stamp " + std::to_string(samples[i].timestamp) +
                           " s in their headers; expected stamps that increase; does the driver set them, and is there "
                           "one driver alone? `imu: none` leaves the topic out");
  return samples;
}

}  // namespace holdfast::rosbag_plugin

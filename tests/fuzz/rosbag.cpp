// SPDX-License-Identifier: BSD-3-Clause
// Bags of ROS 1 and the messages in them.
#include <cmath>

#include "bag_file.hpp"
#include "fuzz.hpp"
#include "image_message.hpp"
#include "topics.hpp"

using namespace holdfast;
using namespace holdfast::rosbag_plugin;

namespace {

void read_message(BagFile& bag, const BagTopic& topic, const BagMessage& message) {
  const std::string place = bag.place_of(message);
  const auto is_small = [&](const cv::Size& size) {
    if (size.width > 640 || size.height > 480) throw InputError({place}, "is larger than the camera");
  };
  fuzz::accepts([&] { fuzz::require(std::isfinite(read_stamp(bag.head(message, stamp_bytes), place)), "stamps"); });
  fuzz::accepts([&] { encoding_of(bag.content(message), topic.type, place); });
  ImageMessages images;
  fuzz::accepts([&] {
    const cv::Mat colour = images.colour(bag.content(message), topic.type, place, is_small);
    fuzz::require(colour.type() == CV_8UC3 && !colour.empty(), "colour is blue, green, red");
  });
  fuzz::accepts([&] {
    const cv::Mat depth = images.depth(bag.content(message), topic.type, place, 1000.0, is_small);
    fuzz::require(depth.type() == CV_32FC1 && !depth.empty(), "depth is in metres");
    for (int y = 0; y < depth.rows; ++y)
      for (int x = 0; x < depth.cols; ++x) fuzz::require(depth.at<float>(y, x) >= 0.0F, "depth is positive or missing");
  });
  fuzz::accepts([&] {
    const Camera camera = read_camera_info(bag.content(message), false, place);
    fuzz::require(camera.fx > 0.0 && camera.fy > 0.0 && camera.width > 0 && camera.height > 0, "a camera has an area");
    fuzz::require(camera.distortion.trouble().empty(), "the coefficients fit the lens");
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("recording.bag", {data, size});
  fuzz::accepts([&] {
    BagFile bag(file);
    for (const BagTopic& topic : bag.topics())
      for (const BagMessage& message : bag.messages(topic.name)) read_message(bag, topic, message);
    choose_topics(bag, {});
  });
  return 0;
}

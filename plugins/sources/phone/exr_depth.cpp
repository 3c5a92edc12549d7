// SPDX-License-Identifier: BSD-3-Clause
#include "exr_depth.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>

#include <cstdint>

#include "holdfast/core/error.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/size_text.hpp"

namespace holdfast::phone_plugin {

namespace {

/// The channel with the depth, and how often it is sampled.
const char* depth_channel(const Imf::Header& header, const std::filesystem::path& file) {
  for (const char* name : {"R", "Y", "Z"}) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    if (channel != nullptr && channel->xSampling == 1 && channel->ySampling == 1) return name;
  }
  throw InputError({file.string()}, "has no channel R, Y or Z with a value for each pixel; expected depth in metres");
}

cv::Mat read_channel(const std::filesystem::path& file) {
  constexpr std::int64_t largest = 8192;  // side of an image [px]
  Imf::InputFile input(file.c_str());
  const Imath::Box2i window = input.header().dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > largest || height > largest)
    throw InputError({file.string()}, "is an image of " + std::to_string(width) + "x" + std::to_string(height) +
                                          " pixels; expected a depth image of at most 8192 pixels in width and height");
  cv::Mat depth(static_cast<int>(height), static_cast<int>(width), CV_32FC1, cv::Scalar(0.0));
  Imf::FrameBuffer buffer;
  buffer.insert(depth_channel(input.header(), file),
                Imf::Slice::Make(Imf::FLOAT, depth.data, window, sizeof(float), depth.step));
  input.setFrameBuffer(buffer);
  input.readPixels(window.min.y, window.max.y);
  return depth;
}

}  // namespace

cv::Mat read_exr_depth(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError({file.string()}, "is missing; expected a depth image in OpenEXR; complete the recording");
  cv::Mat depth;
  try {
    depth = read_channel(file);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& problem) {  // of the library
    throw InputError({file.string()},
                     std::string("is not an OpenEXR image that is whole: ") + problem.what() + "; copy it again");
  }
  depth.forEach<float>([](float& value, const int*) {
    if (!is_measured_depth(value)) value = 0.0F;
  });
  return depth;
}

}  // namespace holdfast::phone_plugin

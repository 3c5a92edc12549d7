// SPDX-License-Identifier: BSD-3-Clause
#include "sources/recording.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_tum(holdfast::Registry& registry);
extern "C" void holdfast_register_plugin_folder(holdfast::Registry& registry);
extern "C" void holdfast_register_plugin_euroc(holdfast::Registry& registry);
extern "C" void holdfast_register_plugin_four_seasons(holdfast::Registry& registry);
extern "C" void holdfast_register_plugin_icl_nuim(holdfast::Registry& registry);
extern "C" void holdfast_register_plugin_kitti(holdfast::Registry& registry);
extern "C" void holdfast_register_plugin_openloris(holdfast::Registry& registry);
extern "C" void holdfast_register_plugin_phone(holdfast::Registry& registry);
#ifdef HOLDFAST_PLUGIN_V4L2
extern "C" void holdfast_register_plugin_v4l2(holdfast::Registry& registry);
#endif
#ifdef HOLDFAST_PLUGIN_ROSBAG
extern "C" void holdfast_register_plugin_rosbag(holdfast::Registry& registry);
#endif

namespace holdfast::test {

TemporaryFolder::TemporaryFolder() {
  static std::atomic<int> counter{0};
  path_ = std::filesystem::temp_directory_path() /
          ("holdfast_sources_" + std::to_string(::getpid()) + '_' + std::to_string(counter++));
  std::filesystem::create_directories(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

std::string TemporaryFolder::write(const std::filesystem::path& name, const std::string& content) const {
  std::filesystem::create_directories((path_ / name).parent_path());
  // A new file: ext4 waits for the disk when one is written over another.
  std::filesystem::remove(path_ / name);
  std::ofstream(path_ / name, std::ios::binary) << content;
  return (path_ / name).string();
}

std::string TemporaryFolder::read(const std::filesystem::path& name) const {
  std::ostringstream content;
  content << std::ifstream(path_ / name, std::ios::binary).rdbuf();
  return content.str();
}

void TemporaryFolder::write_image(const std::filesystem::path& name, const cv::Mat& image) const {
  std::filesystem::create_directories((path_ / name).parent_path());
  if (!cv::imwrite((path_ / name).string(), image)) throw std::runtime_error("cannot write " + name.string());
}

void TemporaryFolder::truncate(const std::filesystem::path& name, double share) const {
  const auto size = static_cast<double>(std::filesystem::file_size(path_ / name));
  std::filesystem::resize_file(path_ / name, static_cast<std::uintmax_t>(size * share));
}

cv::Mat colour_image(int number, int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at<cv::Vec3b>(y, x) =
          cv::Vec3b(static_cast<uchar>(40 + number), static_cast<uchar>(2 * x), static_cast<uchar>(3 * y));
  return image;
}

cv::Mat depth_image(int number, int width, int height) {
  cv::Mat image(height, width, CV_16UC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(100 * number + 64 * y + x);
  image.at<std::uint16_t>(0, 0) = 0;
  return image;
}

std::string colour_name(int i) { return "rgb/" + std::to_string(i) + (i % 2 == 0 ? ".png" : ".jpg"); }
std::string depth_name(int i) { return "depth/" + std::to_string(i) + ".png"; }

void write_tum_recording(const TemporaryFolder& folder, int count) {
  std::string colour = "# timestamp filename\n", depth = colour;
  char stamp[64];
  for (int i = 0; i < count; ++i) {
    folder.write_image(colour_name(i), colour_image(i));
    folder.write_image(depth_name(i), depth_image(i));
    std::snprintf(stamp, sizeof(stamp), "%.6f ", 100.0 + 0.1 * i);
    colour += stamp + colour_name(i) + '\n';
    std::snprintf(stamp, sizeof(stamp), "%.6f ", 100.004 + 0.1 * i);
    depth += stamp + depth_name(i) + '\n';
  }
  folder.write("rgb.txt", colour);
  folder.write("depth.txt", depth);
}

std::unique_ptr<FrameSource> make_mono_source(const std::string& name, const ParameterValues& values) {
  return make_source(name, values, recording_width, recording_height, Sensor::mono);
}

std::unique_ptr<FrameSource> make_source(const std::string& name, const ParameterValues& values, int width, int height,
                                         const std::optional<Sensor>& sensor) {
  Registry registry;
  holdfast_register_plugin_tum(registry);
  holdfast_register_plugin_folder(registry);
  holdfast_register_plugin_euroc(registry);
  holdfast_register_plugin_four_seasons(registry);
  holdfast_register_plugin_icl_nuim(registry);
  holdfast_register_plugin_kitti(registry);
  holdfast_register_plugin_openloris(registry);
  holdfast_register_plugin_phone(registry);
#ifdef HOLDFAST_PLUGIN_V4L2
  holdfast_register_plugin_v4l2(registry);
#endif
#ifdef HOLDFAST_PLUGIN_ROSBAG
  holdfast_register_plugin_rosbag(registry);
#endif
  CreationContext context;
  context.camera.width = width;
  context.camera.height = height;
  context.sensor = sensor;
  return registry.create<FrameSource>(name, values, context);
}

std::vector<SensorFrame> read_all(FrameSource& source) {
  std::vector<SensorFrame> frames;
  while (std::optional<SensorFrame> frame = source.next()) frames.push_back(std::move(*frame));
  return frames;
}

std::string input_error(const std::function<void()>& run) {
  std::string message;
  bool thrown = false;
  testing::internal::CaptureStderr();
  try {
    run();
  } catch (const InputError& error) {
    message = error.what();
    thrown = true;
  } catch (...) {
    testing::internal::GetCapturedStderr();
    throw;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "a library printed";
  EXPECT_TRUE(thrown) << "no InputError";
  return message;
}

std::string input_error_with(const TemporaryFolder& folder, const std::string& file, const std::string& content,
                             const std::function<void()>& run) {
  const std::string before = folder.read(file);
  folder.write(file, content);
  std::string message = input_error(run);
  folder.write(file, before);
  return message;
}

}  // namespace holdfast::test

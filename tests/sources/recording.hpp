// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/parameter.hpp"

namespace holdfast::test {

/// A folder of its own for each test, removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string write(const std::filesystem::path& name, const std::string& content) const;
  std::string read(const std::filesystem::path& name) const;
  /// Encodes by the ending of the name; makes the folders that it needs.
  void write_image(const std::filesystem::path& name, const cv::Mat& image) const;
  void truncate(const std::filesystem::path& name, double share) const;

 private:
  std::filesystem::path path_;
};

constexpr int recording_width = 64;
constexpr int recording_height = 48;

/// A colour image whose pixels depend on its number.
cv::Mat colour_image(int number, int width = recording_width, int height = recording_height);
/// 16-bit depth: value(x, y) = 100 * number + 64 * y + x, 0 at (0, 0).
cv::Mat depth_image(int number, int width = recording_width, int height = recording_height);

/// A recording in TUM layout: frames i = 0 ... count - 1 with colour at 100 + 0.1 i s (PNG for even, JPEG for odd i)
/// and depth 4 ms later; line i + 2 of each list names frame i.
void write_tum_recording(const TemporaryFolder& folder, int count);
std::string colour_name(int i);
std::string depth_name(int i);

/// The source `name`, with its settings and a camera of the size of these recordings, in a run with that sensor.
std::unique_ptr<FrameSource> make_source(const std::string& name, const ParameterValues& values,
                                         int width = recording_width, int height = recording_height,
                                         const std::optional<Sensor>& sensor = {});
std::unique_ptr<FrameSource> make_mono_source(const std::string& name, const ParameterValues& values);

std::vector<SensorFrame> read_all(FrameSource& source);

/// What() of the InputError that run throws, and what was printed to the standard error stream meanwhile; a failed
/// expectation when it does not throw, and when something was printed.
std::string input_error(const std::function<void()>& run);
/// The same while a file of the folder has other content, which it loses again.
std::string input_error_with(const TemporaryFolder& folder, const std::string& file, const std::string& content,
                             const std::function<void()>& run);

}  // namespace holdfast::test

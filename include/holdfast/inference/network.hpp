// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

namespace holdfast {

/// How an image becomes the input of a network: resized to width x height (its shape is not kept), then, channel by
/// channel, (value * scale - mean) / standard_deviation.
struct NetworkOptions {
  std::filesystem::path model;  ///< ONNX, float32
  /// The model itself, where the program holds it; `model` then only names it in messages. Read when the network is
  /// made.
  std::span<const std::uint8_t> bytes = {};
  int width = 0;  ///< of the input [px]; 0 = as the model declares it
  int height = 0;
  bool rgb = true;  ///< order of the channels: red green blue, or blue green red
  double scale = 1.0 / 255.0;
  std::vector<double> mean = {0.0, 0.0, 0.0};  ///< in the order of the channels
  std::vector<double> standard_deviation = {1.0, 1.0, 1.0};
  bool channels_last = false;  ///< NHWC: input (and output) are 1 x height x width x channels
  std::string output_name;     ///< empty = the only one
  int threads = 0;             ///< of OpenCV, for the whole process, set when the network is made; 0 = leave as it is
};

/// A network that turns one colour image into one output, run by OpenCV's DNN module on the CPU. The one place that
/// knows that library. The same image gives the same output on the same machine; OpenCV chooses its kernels by
/// processor, so another processor may differ in the last bits. Used by one thread at a time.
class Network {
 public:
  /// Loads the model. Throws InputError, with what was found and what was expected, for a file that is missing or no
  /// ONNX model, float16 weights (OpenCV reads none), an input that is not one image of three channels, a size that is
  /// not the declared one, an output name that is not there, and layers that OpenCV cannot run.
  explicit Network(const NetworkOptions& options);
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  /// The output for an image (8UC3, blue green red, any size): 32F, as many dimensions as the network gives; valid
  /// until the next call. Throws InputError when the network cannot be run on its input.
  cv::Mat run(const cv::Mat& colour);
  /// The output for the mirror image of the image of the last run(), without preparing that again; once after each
  /// run(), because the image is mirrored where it lies.
  cv::Mat run_mirrored();

  int width() const;
  int height() const;
  /// "1x3x480x640".
  std::string input_text() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace holdfast

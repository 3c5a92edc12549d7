// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "holdfast/inference/onnx_signature.hpp"
#include "holdfast/settings/network_engine.hpp"

namespace holdfast {

/// How an image becomes the input of a network: every channel is normalised as (value * scale - mean) /
/// standard_deviation.
struct InputPreparation {
  /// Scale the image by one factor, and pad it with grey on both sides (place_of_frame()), in place of stretching it.
  bool letterbox = false;
  bool rgb = true;  ///< order of the channels: red green blue, or blue green red
  double scale = 1.0 / 255.0;
  std::vector<double> mean = {0.0, 0.0, 0.0};  ///< in the order of the channels
  std::vector<double> standard_deviation = {1.0, 1.0, 1.0};
};

/// Model and preprocessing of a network. The input is the image, resized to width x height, in the first place without
/// preserving its aspect ratio, with every channel normalised as InputPreparation says.
struct NetworkOptions {
  std::filesystem::path model;  ///< ONNX
  /// The model in memory; if it is not empty, `model` only names it in messages. It is read during construction only,
  /// or, with in_background, until the first run.
  std::span<const std::uint8_t> bytes = {};
  /// Load `bytes` in another thread, for which finish_loading() or the first run waits. For models that are known to be
  /// good: layers that the engine cannot load are then errors of these.
  bool in_background = false;
  int width = 0;  ///< of the input [px]; 0 = as declared by the model
  int height = 0;
  bool rgb = true;  ///< order of the channels: red green blue, or blue green red
  double scale = 1.0 / 255.0;
  std::vector<double> mean = {0.0, 0.0, 0.0};  ///< in the order of the channels
  std::vector<double> standard_deviation = {1.0, 1.0, 1.0};
  bool channels_last = false;  ///< NHWC: input (and output) are 1 x height x width x channels
  std::string output_name;     ///< empty = the only output
  bool every_output = false;   ///< compute all outputs, for Network::outputs()
  NetworkEngine engine = NetworkEngine::opencv;
  NetworkPrecision precision = NetworkPrecision::fp32;
  std::string provider = "cpu";          ///< of ONNX Runtime
  std::filesystem::path engine_library;  ///< ONNX Runtime's; empty = as find_onnxruntime() searches
  /// OpenCV: number of threads for the whole process, set on construction; 0 = unchanged. Other engines: number of
  /// threads for this network; 0 = 1.
  int threads = 0;
};

/// Whether this build has the engine onednn.
bool has_onednn();

/// Whether a library of ONNX Runtime is found: `given`, a file or a folder, if it is not empty; otherwise the one that
/// the environment variable HOLDFAST_ONNXRUNTIME names ("none": no library is); otherwise in the usual places, where
/// one that cannot be used is none. Throws ConfigurationError for a named one that cannot be used.
bool has_onnxruntime(const std::filesystem::path& given = {});

/// What a user asks to compute a network.
struct EngineChoice {
  NetworkEngine engine = NetworkEngine::automatic;
  std::string provider = "cpu";
  std::filesystem::path engine_library;
};

/// The engine of a choice, never automatic. `is_for_onednn`: automatic is oneDNN where this build has it. A provider
/// other than "cpu", and a library, are of ONNX Runtime; throws ConfigurationError for them beside another engine, and
/// as has_onnxruntime().
NetworkEngine chosen_engine(const EngineChoice& choice, bool is_for_onednn);

/// An OnnxNet with one colour image as input and one output. Used by one thread at a time.
class Network {
 public:
  /// Loads the model, or begins to with in_background. Throws InputError, which states what was found and what was
  /// expected, for a missing file, a file that is not an ONNX model, float16 weights, an input that is not one image
  /// with three channels, a size other than the declared one, an unknown output name, and layers that the engine cannot
  /// load. Throws ConfigurationError for an engine, a provider or a precision that is not there.
  explicit Network(const NetworkOptions& options);
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  /// Computes the output for an image (8UC3, blue green red, any size): 32F with the dimensions of the network's
  /// output, valid until the next call. Throws InputError if the network cannot be run.
  cv::Mat run(const cv::Mat& colour);
  /// Prepares later images in another way. Throws ConfigurationError as the constructor does.
  void set_preparation(const InputPreparation& preparation);
  /// The outputs of the last run(), valid until the next call: in the order of signature() with
  /// NetworkOptions::every_output, otherwise the one that run() gives.
  const std::vector<cv::Mat>& outputs() const;
  /// Computes the output for the mirror image of the last run() without preprocessing it again. It may be called once
  /// after each run(), because the prepared image is mirrored in place.
  cv::Mat run_mirrored();

  /// Waits for a model that is loaded in the background. Throws InputError for layers that the engine cannot load.
  void finish_loading();

  int width() const;
  int height() const;
  /// The output that run() computes, as its file declares it.
  const OnnxTensor& output() const;
  const OnnxSignature& signature() const;
  /// Shape of the input, such as "1x3x480x640".
  std::string input_text() const;
  /// What computes the network, for people: "ONNX Runtime 1.20.1 (/usr/lib/libonnxruntime.so.1), provider cpu".
  std::string engine_text() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace holdfast

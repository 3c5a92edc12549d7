// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/inference/onnx_signature.hpp"
#include "holdfast/settings/network_engine.hpp"

namespace holdfast {

/// A network in ONNX format with any inputs and outputs, run on the CPU by OpenCV's DNN module or by oneDNN, or by ONNX
/// Runtime on what its library offers. The same inputs give the same outputs on the same machine; all engines select
/// their kernels by processor, so that the last bits may differ on another processor. Used by one thread at a time, not
/// necessarily the one that made it.
class OnnxNet {
 public:
  /// Where the network comes from.
  struct File {
    std::filesystem::path model;
    /// The model in memory; if it is not empty, `model` only names it in messages. It is read until load() returns, or,
    /// with in_background, until the first run.
    std::span<const std::uint8_t> bytes = {};
    /// load() loads `bytes` in another thread, for which finish_loading() or the first run waits. For models that are
    /// known to be good: layers that the engine cannot load are then errors of these.
    bool in_background = false;
    NetworkEngine engine = NetworkEngine::opencv;
    NetworkPrecision precision = NetworkPrecision::fp32;
    int threads = 1;                       ///< for this network; OpenCV has one number for the whole process
    std::string provider = "cpu";          ///< of ONNX Runtime
    std::filesystem::path engine_library;  ///< ONNX Runtime's; empty = as has_onnxruntime() searches
  };

  /// What every run computes.
  struct Use {
    std::vector<std::pair<std::string, std::vector<std::int64_t>>> inputs;  ///< shapes by name
    std::vector<std::string> outputs;
    std::string advice;  ///< for the error of a network that cannot be run: what the user should check
  };

  /// Reads the signature. Throws InputError, which states what was found and what was expected, for a missing file, a
  /// file that is not an ONNX model, and float16 weights for an engine other than ONNX Runtime. Throws
  /// ConfigurationError for an engine or a provider that is not there, and a precision that the engine or the processor
  /// has not.
  explicit OnnxNet(File file);
  ~OnnxNet();
  OnnxNet(const OnnxNet&) = delete;
  OnnxNet& operator=(const OnnxNet&) = delete;

  const std::filesystem::path& model() const { return file_.model; }
  const OnnxSignature& signature() const { return signature_; }
  /// What computes the network, for people.
  std::string engine_text() const;
  /// The declared output of this name. Throws InputError, which names the nearest, when there is none; `setting` is the
  /// parameter that says the name.
  const OnnxTensor& output(const std::string& name, const std::string& setting) const;
  const OnnxTensor& input(const std::string& name, const std::string& setting) const;

  /// The size of an input in one direction, from the configured one (0 = as declared) and the declared one (-1 = any),
  /// which must agree; throws InputError otherwise. `setting` is the parameter that says the configured one.
  int agreed_size(const OnnxTensor& input, int configured, std::int64_t declared, const std::string& setting) const;

  /// Loads the model into the engine for inputs of these shapes, which take the place of those that it declares, or
  /// begins to with in_background. Called once, before the first run. Throws InputError for layers that the engine
  /// cannot load at these shapes.
  void load(const Use& use);
  /// Waits for a model that is loaded in the background. Throws as load().
  void finish_loading();
  /// Sets an input, 32F of the shape that was given to load(), for the next run; ONNX Runtime gets it in the type that
  /// the network declares. Its data must stay as they are until then.
  void set_input(const cv::Mat& values, const std::string& name);
  /// Computes the outputs that were given to load(): 32F with the dimensions of the network, valid until the next run.
  /// Throws InputError if the network cannot be run.
  void run(std::vector<cv::Mat>& results);

 private:
  struct Loaded;

  File file_;
  std::vector<std::uint8_t> content_;  ///< of the file, until it is loaded
  OnnxSignature signature_;
  std::unique_ptr<Loaded> loaded_;
};

/// The tensors with their shapes, for messages: "'image' (1x3x480x640), 'mask' (?)".
std::string names(const std::vector<OnnxTensor>& tensors);

}  // namespace holdfast

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

#include "holdfast/inference/onnx_net.hpp"
#include "holdfast/settings/network_engine.hpp"

namespace holdfast {

/// A network that is loaded into an engine for one use. Used by one thread at a time, not always the same.
class NetworkRunner {
 public:
  using Inputs = std::vector<std::pair<std::string, cv::Mat>>;  ///< by name

  virtual ~NetworkRunner() = default;
  /// Computes the outputs of the use as OnnxNet::run() says, from inputs of its shapes.
  virtual void run(const Inputs& inputs, std::vector<cv::Mat>& results) = 0;
};

/// "cannot be run by ENGINE on an input of 1x3x288x384 (REASON); ADVICE".
std::string cannot_run(const std::string& engine, const OnnxNet::Use& use, const std::string& reason);

/// Throws ConfigurationError, which says what to do, for an engine or a provider that is not there, and for a precision
/// that the engine or the processor has not.
void require_engine(const OnnxNet::File& file);
/// The part of require_engine() that depends on whether oneDNN is there.
void require_onednn(NetworkPrecision precision);

/// Throw InputError for networks that the engine cannot load for this use. `model` names them in messages; the bytes
/// are not needed afterwards.
std::unique_ptr<NetworkRunner> load_with_opencv(const std::filesystem::path& model, std::span<const std::uint8_t> bytes,
                                                const OnnxNet::Use& use);
std::unique_ptr<NetworkRunner> load_with_onednn(const std::filesystem::path& model, std::span<const std::uint8_t> bytes,
                                                const OnnxNet::Use& use, NetworkPrecision precision, int threads);
/// Throws ConfigurationError, too, for a library or a provider that is not there.
std::unique_ptr<NetworkRunner> load_with_onnxruntime(const OnnxNet::File& file, const OnnxNet::Use& use);

}  // namespace holdfast

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

#include "holdfast/settings/network_engine.hpp"

namespace holdfast {

/// A network that is loaded into an engine. Used by one thread at a time, not always the same.
class NetworkRunner {
 public:
  /// By name; an empty name means the only input.
  using Inputs = std::vector<std::pair<std::string, cv::Mat>>;

  virtual ~NetworkRunner() = default;
  /// Computes outputs as OnnxNet::run() says.
  virtual void run(const Inputs& inputs, const std::vector<std::string>& outputs, std::vector<cv::Mat>& results,
                   const std::string& advice) = 0;
};

/// Shapes of inputs for messages: "1x3x288x384, 1x2".
std::string shapes_of(const NetworkRunner::Inputs& inputs);

/// Throws ConfigurationError, which says what to do, for an engine that this build has not, and for a precision that
/// the engine or the processor has not.
void require_engine(NetworkEngine engine, NetworkPrecision precision);
/// The part of require_engine() that depends on whether oneDNN is there.
void require_onednn(NetworkPrecision precision);

/// Throw InputError for networks that the engine cannot load. `model` names them in messages; the bytes are not needed
/// afterwards.
std::unique_ptr<NetworkRunner> load_with_opencv(const std::filesystem::path& model,
                                                std::span<const std::uint8_t> bytes);
std::unique_ptr<NetworkRunner> load_with_onednn(const std::filesystem::path& model, std::span<const std::uint8_t> bytes,
                                                NetworkPrecision precision, int threads);

}  // namespace holdfast

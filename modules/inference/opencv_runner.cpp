// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <optional>
#include <utility>

#include "holdfast/core/error.hpp"
#include "network_runner.hpp"
#include "onnx_shapes.hpp"

namespace holdfast {

namespace {

/// OpenCV prints what it then throws; the message of the exception is enough. Several threads may want silence at the
/// same time: the last one ends it.
class QuietLibrary {
 public:
  QuietLibrary() {
    const std::lock_guard lock(mutex);
    if (count++ == 0) before = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  }
  ~QuietLibrary() {
    const std::lock_guard lock(mutex);
    if (--count == 0) cv::utils::logging::setLogLevel(before);
  }
  QuietLibrary(const QuietLibrary&) = delete;
  QuietLibrary& operator=(const QuietLibrary&) = delete;

 private:
  static inline std::mutex mutex;
  static inline int count = 0;
  static inline cv::utils::logging::LogLevel before = cv::utils::logging::LOG_LEVEL_WARNING;
};

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

cv::dnn::Net load(const std::filesystem::path& model, std::span<const std::uint8_t> given, const OnnxNet::Use& use) {
  const QuietLibrary quiet;
  const std::vector<std::uint8_t> bytes = with_input_shapes(given, {use.inputs.begin(), use.inputs.end()});
  try {
    cv::dnn::Net net = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    return net;
  } catch (const cv::Exception& error) {
    throw InputError({model.string()}, "cannot be loaded by OpenCV " CV_VERSION " (" + one_line(error.err) +
                                           "); expected layers that it knows; export with a lower opset, or simplify "
                                           "the network, or use `engine: onnxruntime`; or " +
                                           use.advice);
  }
}

class OpencvRunner final : public NetworkRunner {
 public:
  OpencvRunner(std::filesystem::path model, OnnxNet::Use use, cv::dnn::Net net)
      : model_(std::move(model)), use_(std::move(use)), net_(std::move(net)) {}

  void run(const Inputs& inputs, std::vector<cv::Mat>& results) override {
    std::optional<QuietLibrary> quiet;
    if (!has_run_) quiet.emplace();  // what does not fit shows in the first run
    try {
      for (const auto& [name, input] : inputs) net_.setInput(input, name);
      std::vector<cv::String> wanted(use_.outputs.begin(), use_.outputs.end());
      net_.forward(results, wanted);
      for (cv::Mat& result : results)
        if (result.depth() != CV_32F) result.convertTo(result, CV_32F);
      has_run_ = true;
    } catch (const cv::Exception& error) {
      throw InputError({model_.string()}, cannot_run("OpenCV " CV_VERSION, use_, one_line(error.err)));
    }
  }

 private:
  std::filesystem::path model_;
  OnnxNet::Use use_;
  cv::dnn::Net net_;
  bool has_run_ = false;
};

}  // namespace

std::unique_ptr<NetworkRunner> load_with_opencv(const std::filesystem::path& model, std::span<const std::uint8_t> bytes,
                                                const OnnxNet::Use& use) {
  return std::make_unique<OpencvRunner>(model, use, load(model, bytes, use));
}

}  // namespace holdfast

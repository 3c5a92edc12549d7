// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/onnx_net.hpp"

#include <algorithm>
#include <fstream>
#include <future>
#include <iterator>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <optional>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

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

std::vector<std::uint8_t> read_bytes(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError({file.string()},
                     std::string(std::filesystem::exists(file, error) ? "is not a file" : "is missing") +
                         "; expected a network in ONNX format; correct `model`");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError({file.string()}, "cannot be read; check its permissions");
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

cv::dnn::Net load(const std::filesystem::path& model, std::span<const std::uint8_t> bytes) {
  const QuietLibrary quiet;
  try {
    cv::dnn::Net net = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    return net;
  } catch (const cv::Exception& error) {
    throw InputError({model.string()}, "cannot be loaded by OpenCV " CV_VERSION " (" + one_line(error.err) +
                                           "); expected layers that it knows; export with a lower opset, or simplify "
                                           "the network");
  }
}

const OnnxTensor& find(const std::vector<OnnxTensor>& tensors, const std::string& name, const char* kind,
                       const std::string& setting, const std::filesystem::path& model) {
  for (const OnnxTensor& tensor : tensors)
    if (tensor.name == name) return tensor;
  std::vector<std::string> known;
  for (const OnnxTensor& tensor : tensors) known.push_back(tensor.name);
  throw InputError({model.string()}, std::string("has no ") + kind + " '" + name + "'; " + did_you_mean(name, known) +
                                         "; it has " + names(tensors) + "; correct `" + setting + "`");
}

}  // namespace

std::string names(const std::vector<OnnxTensor>& tensors) {
  std::string text;
  for (const OnnxTensor& tensor : tensors)
    text += (text.empty() ? "'" : ", '") + tensor.name + "' (" + tensor.shape_text() + ")";
  return text;
}

struct OnnxNet::Loaded {
  cv::dnn::Net net;
  std::future<cv::dnn::Net> loading;  ///< valid while the network is loaded in the background
  std::vector<std::pair<std::string, cv::Mat>> inputs;
  bool has_run = false;
};

OnnxNet::OnnxNet(const File& file) : model_(file.model), loaded_(std::make_unique<Loaded>()) {
  HOLDFAST_CHECK(!file.in_background || !file.bytes.empty(), "a file is not loaded in the background");
  const std::vector<std::uint8_t> content = file.bytes.empty() ? read_bytes(model_) : std::vector<std::uint8_t>();
  const std::span<const std::uint8_t> bytes = file.bytes.empty() ? std::span(content) : file.bytes;
  signature_ = read_onnx_signature(bytes, model_);
  if (signature_.has_half_precision)
    throw InputError({model_.string()},
                     "has float16 numbers, which OpenCV cannot read; expected float32; export the network without "
                     "half precision");
  if (file.in_background)
    loaded_->loading = std::async(std::launch::async, [model = model_, bytes] { return load(model, bytes); });
  else
    loaded_->net = load(model_, bytes);
}

OnnxNet::~OnnxNet() = default;

const OnnxTensor& OnnxNet::output(const std::string& name, const std::string& setting) const {
  return find(signature_.outputs, name, "output", setting, model_);
}
const OnnxTensor& OnnxNet::input(const std::string& name, const std::string& setting) const {
  return find(signature_.inputs, name, "input", setting, model_);
}

int OnnxNet::agreed_size(const OnnxTensor& input, int configured, std::int64_t declared,
                         const std::string& setting) const {
  if (configured == 0 && declared == -1)
    throw InputError({model_.string()},
                     "has an input of " + input.shape_text() + ", of any " + setting + "; set `" + setting + "`");
  if (configured != 0 && declared != -1 && configured != declared)
    throw InputError({model_.string()}, "has an input of " + input.shape_text() + ", but `" + setting + "` is " +
                                            std::to_string(configured) + "; expected " + std::to_string(declared) +
                                            ", or leave `" + setting + "` out");
  return configured != 0 ? configured : static_cast<int>(declared);
}

void OnnxNet::set_input(const cv::Mat& values, const std::string& name) {
  for (auto& [known, input] : loaded_->inputs)
    if (known == name) {
      input = values;
      return;
    }
  loaded_->inputs.emplace_back(name, values);
}

void OnnxNet::run(const std::vector<std::string>& outputs, std::vector<cv::Mat>& results, const std::string& advice) {
  Loaded& loaded = *loaded_;
  if (loaded.loading.valid()) loaded.net = loaded.loading.get();
  std::optional<QuietLibrary> quiet;
  if (!loaded.has_run) quiet.emplace();  // what does not fit shows in the first run
  std::string shapes;
  for (const auto& [name, input] : loaded.inputs)
    shapes +=
        (shapes.empty() ? "" : ", ") + shape_text(std::vector<std::int64_t>(input.size.p, input.size.p + input.dims));
  try {
    for (const auto& [name, input] : loaded.inputs) loaded.net.setInput(input, name);
    std::vector<cv::String> wanted(outputs.begin(), outputs.end());
    loaded.net.forward(results, wanted);
    for (cv::Mat& result : results)
      if (result.depth() != CV_32F) result.convertTo(result, CV_32F);
    loaded.has_run = true;
  } catch (const cv::Exception& error) {
    throw InputError({model_.string()},
                     "cannot be run on an input of " + shapes + " (" + one_line(error.err) + "); " + advice);
  }
}

}  // namespace holdfast

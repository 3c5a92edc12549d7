// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/onnx_net.hpp"

#include <fstream>
#include <future>
#include <iterator>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "network_runner.hpp"

namespace holdfast {

namespace {

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
  std::unique_ptr<NetworkRunner> runner;
  std::future<std::unique_ptr<NetworkRunner>> loading;  ///< valid while the network is loaded in the background
  NetworkRunner::Inputs inputs;
};

OnnxNet::OnnxNet(const File& file) : model_(file.model), loaded_(std::make_unique<Loaded>()) {
  HOLDFAST_CHECK(!file.in_background || !file.bytes.empty(), "a file is not loaded in the background");
  require_engine(file.engine, file.precision);
  const std::vector<std::uint8_t> content = file.bytes.empty() ? read_bytes(model_) : std::vector<std::uint8_t>();
  const std::span<const std::uint8_t> bytes = file.bytes.empty() ? std::span(content) : file.bytes;
  signature_ = read_onnx_signature(bytes, model_);
  if (signature_.has_half_precision)
    throw InputError({model_.string()},
                     "has float16 numbers, which no engine here can read; expected float32; export the network without "
                     "half precision");
  const auto load = [model = model_, engine = file.engine, precision = file.precision, threads = file.threads, bytes] {
    return engine == NetworkEngine::onednn ? load_with_onednn(model, bytes, precision, threads)
                                           : load_with_opencv(model, bytes);
  };
  if (file.in_background)
    loaded_->loading = std::async(std::launch::async, load);
  else
    loaded_->runner = load();
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
  if (loaded.loading.valid()) loaded.runner = loaded.loading.get();
  loaded.runner->run(loaded.inputs, outputs, results, advice);
}

}  // namespace holdfast

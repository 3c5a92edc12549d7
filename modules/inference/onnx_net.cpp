// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/onnx_net.hpp"

#include <future>
#include <opencv2/core/version.hpp>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "network_runner.hpp"
#include "onnxruntime_library.hpp"

namespace holdfast {

namespace {

std::vector<std::uint8_t> read_bytes(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  InputFile(file, largest_file::network, "a network in ONNX format; correct `model`").read_rest(bytes);
  return bytes;
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
  Use use;
  std::unique_ptr<NetworkRunner> runner;
  std::future<std::unique_ptr<NetworkRunner>> loading;  ///< valid while the network is loaded in the background
  NetworkRunner::Inputs inputs;
};

OnnxNet::OnnxNet(File file) : file_(std::move(file)), loaded_(std::make_unique<Loaded>()) {
  HOLDFAST_CHECK(!file_.in_background || !file_.bytes.empty(), "a file is not loaded in the background");
  require_engine(file_);
  if (file_.bytes.empty()) {
    content_ = read_bytes(file_.model);
    file_.bytes = content_;
  }
  signature_ = read_onnx_signature(file_.bytes, file_.model);
  if (signature_.has_half_precision && file_.engine != NetworkEngine::onnxruntime)
    throw InputError({file_.model.string()},
                     std::string("has float16 numbers, which the engine ") + choice_name(file_.engine) +
                         " cannot read; expected float32; export the network without half precision, or use `engine: "
                         "onnxruntime`");
}

OnnxNet::~OnnxNet() = default;

void OnnxNet::load(const Use& use) {
  HOLDFAST_CHECK(!loaded_->runner && !loaded_->loading.valid(), "a network is loaded once");
  loaded_->use = use;
  const auto load = [file = file_, use] {
    if (file.engine == NetworkEngine::onnxruntime) return load_with_onnxruntime(file, use);
    return file.engine == NetworkEngine::onednn
               ? load_with_onednn(file.model, file.bytes, use, file.precision, file.threads)
               : load_with_opencv(file.model, file.bytes, use);
  };
  if (file_.in_background)
    loaded_->loading = std::async(std::launch::async, load);
  else
    loaded_->runner = load();
  content_ = {};
}

std::string OnnxNet::engine_text() const {
  if (file_.engine == NetworkEngine::onednn) return "oneDNN";
  if (file_.engine != NetworkEngine::onnxruntime) return "OpenCV " CV_VERSION;
  const OnnxruntimeLibrary& library = OnnxruntimeLibrary::get(file_.engine_library);
  return library.title() + " (" + library.file().string() + "), provider " + file_.provider;
}

void OnnxNet::finish_loading() {
  if (loaded_->loading.valid()) loaded_->runner = loaded_->loading.get();
}

const OnnxTensor& OnnxNet::output(const std::string& name, const std::string& setting) const {
  return find(signature_.outputs, name, "output", setting, file_.model);
}
const OnnxTensor& OnnxNet::input(const std::string& name, const std::string& setting) const {
  return find(signature_.inputs, name, "input", setting, file_.model);
}

int OnnxNet::agreed_size(const OnnxTensor& input, int configured, std::int64_t declared,
                         const std::string& setting) const {
  if (configured == 0 && declared == -1)
    throw InputError({file_.model.string()},
                     "has an input of " + input.shape_text() + ", of any " + setting + "; set `" + setting + "`");
  if (configured != 0 && declared != -1 && configured != declared)
    throw InputError({file_.model.string()}, "has an input of " + input.shape_text() + ", but `" + setting + "` is " +
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

void OnnxNet::run(std::vector<cv::Mat>& results) {
  finish_loading();
  HOLDFAST_CHECK(loaded_->runner, "a network is loaded before its first run");
  loaded_->runner->run(loaded_->inputs, results);
}

}  // namespace holdfast

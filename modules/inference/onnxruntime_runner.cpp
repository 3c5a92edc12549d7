// SPDX-License-Identifier: BSD-3-Clause
#include <onnxruntime_c_api.h>

#include <cctype>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "holdfast/core/error.hpp"
#include "network_runner.hpp"
#include "onnxruntime_library.hpp"

namespace holdfast {

namespace {

/// An error that ONNX Runtime reports.
struct RuntimeFailure {
  std::string reason;
};

/// What ONNX Runtime made, released by its own function.
template <class Type>
using Owned = std::unique_ptr<Type, void (*)(Type*)>;

std::string on_one_line(std::string text) {
  for (char& character : text)
    if (character == '\n') character = ' ';
  return text;
}

/// The type of OpenCV whose elements have the bytes of a tensor's, or -1 if there is none.
int matrix_type(ONNXTensorElementDataType type) {
  switch (type) {
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT:
      return CV_32F;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT16:
      return CV_16F;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_DOUBLE:
      return CV_64F;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT8:
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_BOOL:
      return CV_8U;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT8:
      return CV_8S;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT16:
      return CV_16U;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT16:
      return CV_16S;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT32:
      return CV_32S;
    default:
      return -1;
  }
}

/// Numbers of a type that OpenCV has not, such as int64, as float32.
template <class Number>
cv::Mat as_floats(const void* data, const std::vector<int>& shape) {
  cv::Mat result(static_cast<int>(shape.size()), shape.data(), CV_32F);
  const auto* from = static_cast<const Number*>(data);
  auto* to = result.ptr<float>();
  for (std::size_t i = 0; i < result.total(); ++i) to[i] = static_cast<float>(from[i]);
  return result;
}

class OnnxruntimeRunner final : public NetworkRunner {
 public:
  OnnxruntimeRunner(const OnnxNet::File& file, OnnxNet::Use use)
      : library_(OnnxruntimeLibrary::get(file.engine_library)),
        api_(library_.api()),
        model_(file.model),
        use_(std::move(use)),
        session_(nullptr, api_.ReleaseSession),
        memory_(nullptr, api_.ReleaseMemoryInfo) {
    try {
      load(file);
    } catch (const RuntimeFailure& failure) {
      fail(failure);
    }
  }

  void run(const Inputs& inputs, std::vector<cv::Mat>& results) override {
    try {
      compute(inputs);
      results.resize(use_.outputs.size());
      for (std::size_t i = 0; i < results.size(); ++i) results[i] = matrix(values_[i].get(), use_.outputs[i]);
    } catch (const RuntimeFailure& failure) {
      fail(failure);
    }
  }

 private:
  [[noreturn]] void fail(const RuntimeFailure& failure) const {
    throw InputError({model_.string()}, cannot_run(library_.title(), use_, on_one_line(failure.reason)));
  }

  void check(OrtStatus* status) const {
    if (status == nullptr) return;
    RuntimeFailure failure{api_.GetErrorMessage(status)};
    api_.ReleaseStatus(status);
    throw failure;
  }

  void load(const OnnxNet::File& file) {
    OrtSessionOptions* made = nullptr;
    check(api_.CreateSessionOptions(&made));
    const Owned<OrtSessionOptions> options(made, api_.ReleaseSessionOptions);
    check(api_.SetIntraOpNumThreads(made, file.threads));
    check(api_.SetInterOpNumThreads(made, 1));
    check(api_.AddSessionConfigEntry(made, "session.intra_op.allow_spinning", "0"));
    start_provider(made, file.provider);
    OrtSession* session = nullptr;
    check(api_.CreateSessionFromArray(library_.environment(), file.bytes.data(), file.bytes.size(), made, &session));
    session_.reset(session);
    OrtMemoryInfo* memory = nullptr;
    check(api_.CreateCpuMemoryInfo(OrtArenaAllocator, OrtMemTypeDefault, &memory));
    memory_.reset(memory);
    for (const auto& [name, shape] : use_.inputs) input_types_.push_back(declared_type(name));
  }

  /// add_provider() with an error that names the parameter.
  void start_provider(OrtSessionOptions* options, const std::string& provider) const {
    try {
      add_provider(options, provider);
    } catch (const RuntimeFailure& failure) {
      throw ConfigurationError(
          SourceLocation{},
          "provider: found '" + provider + "', which " + library_.title() + " (" + library_.file().string() +
              ") knows but cannot start (" + on_one_line(failure.reason) +
              "); expected `provider: cpu`, or in `engine_library` a library with the files of this provider beside it "
              "(libonnxruntime_providers_*.so) and what these need");
    }
  }

  void add_provider(OrtSessionOptions* options, const std::string& provider) const {
    if (provider == "cpu") return;
    if (provider == "tensorrt") {
      OrtTensorRTProviderOptionsV2* tensorrt = nullptr;
      check(api_.CreateTensorRTProviderOptions(&tensorrt));
      const Owned<OrtTensorRTProviderOptionsV2> owned(tensorrt, api_.ReleaseTensorRTProviderOptions);
      check(api_.SessionOptionsAppendExecutionProvider_TensorRT_V2(options, tensorrt));
    }
    if (provider == "cuda" || provider == "tensorrt") {  // CUDA computes what TensorRT leaves
      OrtCUDAProviderOptionsV2* cuda = nullptr;
      check(api_.CreateCUDAProviderOptions(&cuda));
      const Owned<OrtCUDAProviderOptionsV2> owned(cuda, api_.ReleaseCUDAProviderOptions);
      check(api_.SessionOptionsAppendExecutionProvider_CUDA_V2(options, cuda));
      return;
    }
    check(api_.SessionOptionsAppendExecutionProvider(options, interface_name(provider).c_str(), nullptr, nullptr, 0));
  }

  /// The name of a provider in the interface, which has its own capitals.
  static std::string interface_name(const std::string& provider) {
    for (const char* known : {"OpenVINO", "CoreML", "WebGPU", "VitisAI", "MIGraphX"}) {
      std::string lower = known;
      for (char& letter : lower) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
      if (lower == provider) return known;
    }
    std::string upper = provider;
    for (char& letter : upper) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    return upper;
  }

  ONNXTensorElementDataType declared_type(const std::string& wanted) const {
    std::size_t count = 0;
    check(api_.SessionGetInputCount(session_.get(), &count));
    OrtAllocator* allocator = nullptr;
    check(api_.GetAllocatorWithDefaultOptions(&allocator));
    for (std::size_t i = 0; i < count; ++i) {
      char* name = nullptr;
      check(api_.SessionGetInputName(session_.get(), i, allocator, &name));
      const bool is_wanted = wanted == name;
      check(api_.AllocatorFree(allocator, name));
      if (!is_wanted) continue;
      OrtTypeInfo* made = nullptr;
      check(api_.SessionGetInputTypeInfo(session_.get(), i, &made));
      const Owned<OrtTypeInfo> info(made, api_.ReleaseTypeInfo);
      const OrtTensorTypeAndShapeInfo* tensor = nullptr;
      check(api_.CastTypeInfoToTensorInfo(made, &tensor));
      if (tensor == nullptr) throw RuntimeFailure{"the input '" + wanted + "' is no tensor"};
      ONNXTensorElementDataType type = ONNX_TENSOR_ELEMENT_DATA_TYPE_UNDEFINED;
      check(api_.GetTensorElementType(tensor, &type));
      return type;
    }
    throw RuntimeFailure{"there is no input '" + wanted + "'"};
  }

  void compute(const Inputs& inputs) {
    std::vector<Owned<OrtValue>> owned;
    std::vector<const char*> names, wanted;
    std::vector<const OrtValue*> values;
    converted_.resize(use_.inputs.size());
    for (std::size_t i = 0; i < use_.inputs.size(); ++i) {
      const auto& [name, shape] = use_.inputs[i];
      const cv::Mat* given = nullptr;
      for (const auto& [known, input] : inputs)
        if (known == name) given = &input;
      if (given == nullptr) throw RuntimeFailure{"the input '" + name + "' is not set"};
      owned.push_back(tensor(*given, shape, input_types_[i], converted_[i]));
      names.push_back(name.c_str());
      values.push_back(owned.back().get());
    }
    for (const std::string& output : use_.outputs) wanted.push_back(output.c_str());
    values_.clear();
    std::vector<OrtValue*> results(wanted.size(), nullptr);
    OrtStatus* status = api_.Run(session_.get(), nullptr, names.data(), values.data(), values.size(), wanted.data(),
                                 wanted.size(), results.data());
    for (OrtValue* result : results) values_.emplace_back(result, api_.ReleaseValue);
    check(status);
  }

  Owned<OrtValue> tensor(const cv::Mat& given, const std::vector<std::int64_t>& shape, ONNXTensorElementDataType type,
                         cv::Mat& converted) const {
    cv::Mat numbers = given;
    if (type == ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64) {
      converted.create(1, static_cast<int>(2 * given.total()), CV_32S);  // its bytes
      auto* to = reinterpret_cast<std::int64_t*>(converted.data);
      for (std::size_t i = 0; i < given.total(); ++i)
        to[i] = static_cast<std::int64_t>(std::llround(given.ptr<float>()[i]));
      numbers = converted;
    } else if (type != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT) {
      const int wanted = matrix_type(type);
      if (wanted < 0) throw RuntimeFailure{"an input has elements of the type " + std::to_string(type)};
      given.convertTo(converted, wanted);
      numbers = converted;
    }
    OrtValue* made = nullptr;
    check(api_.CreateTensorWithDataAsOrtValue(memory_.get(), numbers.data, numbers.total() * numbers.elemSize(),
                                              shape.data(), shape.size(), type, &made));
    return {made, api_.ReleaseValue};
  }

  /// The numbers of an output as float32; those of a float32 output share its memory.
  cv::Mat matrix(OrtValue* value, const std::string& name) const {
    int is_tensor = 0;
    check(api_.IsTensor(value, &is_tensor));
    if (is_tensor == 0) throw RuntimeFailure{"the output '" + name + "' is no tensor"};
    OrtTensorTypeAndShapeInfo* made = nullptr;
    check(api_.GetTensorTypeAndShape(value, &made));
    const Owned<OrtTensorTypeAndShapeInfo> info(made, api_.ReleaseTensorTypeAndShapeInfo);
    ONNXTensorElementDataType type = ONNX_TENSOR_ELEMENT_DATA_TYPE_UNDEFINED;
    check(api_.GetTensorElementType(made, &type));
    const std::vector<int> shape = dimensions(made, name);
    void* data = nullptr;
    check(api_.GetTensorMutableData(value, &data));
    if (type == ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64) return as_floats<std::int64_t>(data, shape);
    if (type == ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT64) return as_floats<std::uint64_t>(data, shape);
    if (type == ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT32) return as_floats<std::uint32_t>(data, shape);
    const int found = matrix_type(type);
    if (found < 0) throw RuntimeFailure{"the output '" + name + "' has elements of the type " + std::to_string(type)};
    cv::Mat numbers(static_cast<int>(shape.size()), shape.data(), found, data);
    if (found == CV_32F) return numbers;
    cv::Mat floats;
    numbers.convertTo(floats, CV_32F);
    return floats;
  }

  std::vector<int> dimensions(const OrtTensorTypeAndShapeInfo* info, const std::string& name) const {
    std::size_t count = 0;
    check(api_.GetDimensionsCount(info, &count));
    std::vector<std::int64_t> sizes(count);
    check(api_.GetDimensions(info, sizes.data(), count));
    std::vector<int> shape;
    std::int64_t total = 1;
    constexpr std::int64_t most = 1 << 30;
    for (const std::int64_t size : sizes) {
      if (size < 0 || size > most || (total *= size) > most)
        throw RuntimeFailure{"the output '" + name + "' has too many elements"};
      shape.push_back(static_cast<int>(size));
    }
    while (shape.size() < 2) shape.push_back(1);  // of one dimension: a column, as cv::Mat has it
    return shape;
  }

  const OnnxruntimeLibrary& library_;
  const OrtApi& api_;
  std::filesystem::path model_;
  OnnxNet::Use use_;
  Owned<OrtSession> session_;
  Owned<OrtMemoryInfo> memory_;
  std::vector<ONNXTensorElementDataType> input_types_;  ///< of use_.inputs
  std::vector<cv::Mat> converted_;                      ///< inputs in their types
  std::vector<Owned<OrtValue>> values_;                 ///< of the last run
};

}  // namespace

std::unique_ptr<NetworkRunner> load_with_onnxruntime(const OnnxNet::File& file, const OnnxNet::Use& use) {
  return std::make_unique<OnnxruntimeRunner>(file, use);
}

}  // namespace holdfast

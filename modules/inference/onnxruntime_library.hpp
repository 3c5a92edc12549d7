// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

struct OrtApi;
struct OrtEnv;

namespace holdfast {

/// A library of ONNX Runtime, loaded at run time through its C interface and never unloaded. Thread-safe.
class OnnxruntimeLibrary {
 public:
  /// The library that has_onnxruntime() finds, loaded once in a process. Throws ConfigurationError, which says what was
  /// searched and what to install, for one that is not there, is not ONNX Runtime, or is older than 1.12.
  static const OnnxruntimeLibrary& get(const std::filesystem::path& given);
  /// The same, or null if no place has one that can be used. Throws as get() for a library that is named.
  static const OnnxruntimeLibrary* find(const std::filesystem::path& given);

  const OrtApi& api() const { return *api_; }
  const OrtEnv* environment() const { return environment_; }
  const std::filesystem::path& file() const { return file_; }
  /// "ONNX Runtime 1.20.1".
  std::string title() const { return "ONNX Runtime " + version_; }
  /// Its execution providers, by the names that the parameter `provider` takes: "cpu", "cuda", "tensorrt".
  const std::vector<std::string>& providers() const { return providers_; }
  /// Throws ConfigurationError, which lists what there is, for a provider that the library has not.
  void require_provider(const std::string& provider) const;

 private:
  OnnxruntimeLibrary() = default;
  static const OnnxruntimeLibrary& load(const std::filesystem::path& file);

  const OrtApi* api_ = nullptr;
  OrtEnv* environment_ = nullptr;
  std::filesystem::path file_;
  std::string version_;
  std::vector<std::string> providers_;
};

}  // namespace holdfast

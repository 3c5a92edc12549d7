// SPDX-License-Identifier: BSD-3-Clause
#include "onnxruntime_library.hpp"

#include <dlfcn.h>
#include <onnxruntime_c_api.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <mutex>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t least_interface = 12;
constexpr const char* least_version = "1.12";
constexpr const char* variable = "HOLDFAST_ONNXRUNTIME";

[[noreturn]] void fail(const std::string& message) {
  throw ConfigurationError(SourceLocation{}, "engine: found onnxruntime, but " + message);
}

/// The numbers of a file name behind ".so": {1, 20, 1}.
std::vector<int> version_numbers(const std::string& name) {
  std::vector<int> numbers;
  for (std::size_t at = name.find(".so"); at != std::string::npos; at = name.find('.', at + 1)) {
    const std::string rest = name.substr(at + 1, 6);
    if (!rest.empty() && std::isdigit(static_cast<unsigned char>(rest[0])) != 0)
      numbers.push_back(std::atoi(rest.c_str()));
  }
  return numbers;
}

/// The library in a folder, of several the one with the highest version; empty if there is none.
fs::path library_in(const fs::path& folder) {
  fs::path best;
  std::error_code unreadable;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, unreadable)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("libonnxruntime.so")) continue;
    const auto rank = [](const fs::path& file) {
      return std::pair(version_numbers(file.filename().string()), file.string());
    };
    if (best.empty() || rank(entry.path()) > rank(best)) best = entry.path();
  }
  return best;
}

/// Names that the dynamic loader may know, then files in the folders in which it is installed.
std::vector<fs::path> usual_places() {
  std::vector<fs::path> places = {"libonnxruntime.so.1", "libonnxruntime.so"};
  for (const char* folder :
       {"/usr/local/lib", "/opt/onnxruntime/lib", "/usr/lib/" HOLDFAST_LIBRARY_ARCHITECTURE, "/usr/lib64", "/usr/lib"})
    if (const fs::path file = library_in(folder); !file.empty()) places.push_back(file);
  return places;
}

void ignore_log(void*, OrtLoggingLevel, const char*, const char*, const char*, const char*) {}

/// "CUDAExecutionProvider" is "cuda".
std::string provider_name(std::string name) {
  const std::size_t suffix = name.find("ExecutionProvider");
  if (suffix != std::string::npos) name.resize(suffix);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

void check(const OrtApi& api, OrtStatus* status, const fs::path& file) {
  if (status == nullptr) return;
  const std::string reason = api.GetErrorMessage(status);
  api.ReleaseStatus(status);
  fail("its library " + file.string() + " cannot be used (" + reason + "); expected another build of it");
}

/// The library that is named by the setting or by the environment, and where it is named; empty if none is.
std::pair<fs::path, std::string> named_library(const fs::path& given) {
  if (!given.empty()) return {given, "engine_library"};
  const char* value = std::getenv(variable);
  return {value == nullptr ? "" : value, variable};
}

std::string what_to_do() {
  return std::string("expected version ") + least_version +
         " or later; install it (sh cmake/install_dependencies.sh --onnxruntime; Debian 13: libonnxruntime-dev), or "
         "name its libonnxruntime.so in `engine_library` or " +
         variable;
}

}  // namespace

const OnnxruntimeLibrary& OnnxruntimeLibrary::load(const fs::path& file) {
  static std::mutex mutex;
  // Lives as long as the process: networks may outlast static objects.
  static auto& loaded = *new std::map<fs::path, std::unique_ptr<OnnxruntimeLibrary>>;
  const std::lock_guard lock(mutex);
  if (const auto known = loaded.find(file); known != loaded.end()) return *known->second;

  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* reason = dlerror();
    fail("its library cannot be loaded (" + std::string(reason == nullptr ? file.string() : reason) + "); " +
         what_to_do());
  }
  using GetBase = const OrtApiBase* (*)();
  const auto get_base = reinterpret_cast<GetBase>(dlsym(handle, "OrtGetApiBase"));
  if (get_base == nullptr) {
    dlclose(handle);
    fail(file.string() + " is another library, without OrtGetApiBase; " + what_to_do());
  }
  std::unique_ptr<OnnxruntimeLibrary> library(new OnnxruntimeLibrary);
  Dl_info info = {};
  const bool is_known = dladdr(reinterpret_cast<void*>(get_base), &info) != 0 && info.dli_fname != nullptr;
  library->file_ = is_known ? fs::path(info.dli_fname) : file;
  library->version_ = get_base()->GetVersionString();
  library->api_ = get_base()->GetApi(least_interface);
  if (library->api_ == nullptr)
    fail(library->file_.string() + " is version " + library->version_ + "; " + what_to_do());
  const OrtApi& api = *library->api_;
  check(
      api,
      api.CreateEnvWithCustomLogger(&ignore_log, nullptr, ORT_LOGGING_LEVEL_FATAL, "holdfast", &library->environment_),
      library->file_);
  char** names = nullptr;
  int count = 0;
  check(api, api.GetAvailableProviders(&names, &count), library->file_);
  for (int i = 0; i < count; ++i) library->providers_.push_back(provider_name(names[i]));
  check(api, api.ReleaseAvailableProviders(names, count), library->file_);
  return *(loaded[file] = std::move(library));
}

const OnnxruntimeLibrary* OnnxruntimeLibrary::find(const fs::path& given) {
  const auto [named, where] = named_library(given);
  if (named == "none" && where == variable) return nullptr;
  if (named.empty()) {
    for (const fs::path& place : usual_places()) {
      try {
        return &load(place);
      } catch (const ConfigurationError&) {  // the next one may be better
      }
    }
    return nullptr;
  }
  std::error_code unknown;
  if (!fs::is_directory(named, unknown)) {
    if (!fs::exists(named, unknown))
      fail("`" + where + "` names " + named.string() + ", which does not exist; " + what_to_do());
    return &load(fs::absolute(named));
  }
  const fs::path file = library_in(named);
  if (file.empty())
    fail("`" + where + "` names the folder " + named.string() + ", in which there is no libonnxruntime.so; " +
         what_to_do());
  return &load(fs::absolute(file));
}

const OnnxruntimeLibrary& OnnxruntimeLibrary::get(const fs::path& given) {
  if (const OnnxruntimeLibrary* library = find(given)) return *library;
  const char* value = std::getenv(variable);
  if (value != nullptr && std::string(value) == "none")
    fail(std::string(variable) + " is 'none'; unset it, or name the library in `engine_library`");
  for (const fs::path& place : usual_places())
    if (place.has_parent_path()) load(place);  // throws what is wrong with it
  fail(
      "no ONNX Runtime was found, by the dynamic loader or in /usr/local/lib, /opt/onnxruntime/lib, "
      "/usr/lib/" HOLDFAST_LIBRARY_ARCHITECTURE ", /usr/lib64 and /usr/lib; " +
      what_to_do());
}

void OnnxruntimeLibrary::require_provider(const std::string& provider) const {
  if (std::find(providers_.begin(), providers_.end(), provider) != providers_.end()) return;
  throw ConfigurationError(SourceLocation{}, "provider: found '" + provider + "', but " + title() + " (" +
                                                 file_.string() + ") has " + join(providers_) +
                                                 "; expected one of these, or a library that has it in "
                                                 "`engine_library`");
}

bool has_onnxruntime(const fs::path& given) { return OnnxruntimeLibrary::find(given) != nullptr; }

}  // namespace holdfast

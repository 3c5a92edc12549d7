// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/loader.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <exception>

#include "abi_of_file.hpp"
#include "holdfast/plugin/abi.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

/// The plugin folder beside the library that this code is linked into: `holdfast/plugins`, as in an installation, or
/// `plugins` in a folder that is called holdfast, as in the Python package. Empty for a program.
fs::path folder_beside_library() {
  Dl_info own = {};
  if (dladdr(reinterpret_cast<void*>(&can_find_plugin), &own) == 0 || own.dli_fname == nullptr) return {};
  std::error_code unknown;
  const fs::path library = fs::canonical(own.dli_fname, unknown);
  if (unknown || library == fs::read_symlink("/proc/self/exe", unknown)) return {};
  const fs::path folder = library.parent_path();
  return folder.filename() == "holdfast" ? folder / "plugins" : folder / "holdfast/plugins";
}

}  // namespace

std::vector<fs::path> plugin_search_path(const std::vector<fs::path>& first) {
  std::vector<fs::path> folders = first;
  if (const char* variable = std::getenv("HOLDFAST_PLUGIN_PATH")) {
    std::string text = variable;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(':', begin), text.size());
      if (end > begin) folders.emplace_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  std::error_code no_program;
  const fs::path program = fs::read_symlink("/proc/self/exe", no_program);
  if (!no_program)
    folders.push_back(
        (program.parent_path().parent_path() / HOLDFAST_LIBRARY_FOLDER / "holdfast/plugins").lexically_normal());
  // In a process of another program, such as Python's, that is the place that was installed with this code.
  const fs::path beside = folder_beside_library();
  if (!beside.empty() && std::find(folders.begin(), folders.end(), beside) == folders.end()) folders.push_back(beside);
  return folders;
}

namespace {

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::vector<std::string> file_names(const std::string& name) {
  if (name.ends_with(".so")) return {name, "lib" + name};
  return {name, name + ".so", "lib" + name + ".so"};
}

fs::path find_plugin(const std::string& name_or_path, const std::vector<fs::path>& search_first) {
  if (name_or_path.find('/') != std::string::npos) {
    if (is_file(name_or_path)) return fs::absolute(name_or_path);
    throw PluginError("plugin '" + name_or_path + "' cannot be loaded: there is no such file");
  }
  const std::vector<fs::path> folders = plugin_search_path(search_first);
  for (const fs::path& folder : folders)
    for (const std::string& name : file_names(name_or_path))
      if (is_file(folder / name)) return fs::absolute(folder / name);
  std::string searched;
  for (const fs::path& folder : folders)
    searched += (searched.empty() ? "" : ", ") + (folder.empty() ? std::string(".") : folder.string());
  throw PluginError("plugin '" + name_or_path + "' cannot be found; searched: " + searched +
                    "; give a path with a folder, or name its folder in HOLDFAST_PLUGIN_PATH");
}

bool has_modules_of(const Registry& registry, const std::string& origin) {
  for (const std::string& kind : registry.kinds())
    for (const ModuleEntry* entry : registry.of_kind(kind))
      if (entry->origin == origin) return true;
  return false;
}

/// Sets the origin of the modules that a plugin registers and restores the previous one, also after an exception.
class OriginScope {
 public:
  OriginScope(Registry& registry, const std::string& origin) : registry_(registry), before_(registry.origin()) {
    registry_.set_origin(origin);
  }
  ~OriginScope() { registry_.set_origin(before_); }
  OriginScope(const OriginScope&) = delete;
  OriginScope& operator=(const OriginScope&) = delete;

 private:
  Registry& registry_;
  std::string before_;
};

}  // namespace

bool can_find_plugin(const std::string& name_or_path, const std::vector<fs::path>& search_first) {
  try {
    find_plugin(name_or_path, search_first);
    return true;
  } catch (const PluginError&) {
    return false;
  }
}

fs::path load_plugin(Registry& registry, const std::string& name_or_path, const std::vector<fs::path>& search_first) {
  const std::string file = find_plugin(name_or_path, search_first).lexically_normal().string();
  const auto refuse = [&](const std::string& reason) { throw PluginError("plugin '" + file + "' " + reason); };
  if (has_modules_of(registry, file)) return file;
  const auto refuse_differences = [&](const AbiRecord& record) {
    std::string all;
    for (const std::string& difference : abi_differences(compiled_abi(), record))
      all += (all.empty() ? "" : "; ") + difference;
    if (!all.empty())
      refuse("does not fit this program: " + all + "; build both with the same Holdfast, compiler and libraries");
  };
  // Checked before loading: an incompatible plugin often fails to load as well, with a less helpful message.
  if (is_cut_off(file)) refuse("cannot be loaded: the file ends too early; build or copy it again");
  if (const auto record = read_abi_of_file(file)) refuse_differences(*record);

  // RTLD_NOW reports a missing symbol here and not during a run. The library is never closed; see the header.
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* reason = dlerror();
    refuse(std::string("cannot be loaded: ") + (reason != nullptr ? reason : "unknown reason"));
  }
  const auto* record = static_cast<const AbiRecord*>(dlsym(library, "holdfast_plugin_abi"));
  if (record == nullptr)
    refuse("is no Holdfast plugin: it has no ABI record holdfast_plugin_abi; define its entry with HOLDFAST_PLUGIN");
  refuse_differences(*record);
  auto* entry = reinterpret_cast<void (*)(Registry&)>(dlsym(library, "holdfast_register_plugin"));
  if (entry == nullptr) refuse("has no entry function holdfast_register_plugin; define it with HOLDFAST_PLUGIN");

  const OriginScope scope(registry, file);
  try {
    entry(registry);
  } catch (const PluginError&) {
    throw;
  } catch (const std::exception& reason) {
    refuse(std::string("failed to register its modules: ") + reason.what());
  }
  return file;
}

}  // namespace holdfast

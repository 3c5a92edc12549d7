// SPDX-License-Identifier: BSD-3-Clause
// Configurations: the YAML, and every section with the modules of this build.
#include "fuzz.hpp"
#include "holdfast/run/configured_pipeline.hpp"

using namespace holdfast;

namespace {

Registry builtin_modules() {
  Registry registry;
  register_builtin_plugins(registry);
  return registry;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Registry builtin = builtin_modules();
  static const std::vector<SectionDescription> sections = pipeline_sections();
  const std::string text = fuzz::text_of({data, size});
  Configuration configuration;
  const bool accepted = fuzz::accepts([&] {
    const ConfigurationNode root = parse_yaml(text, "fuzz.yaml", fuzz::folder().path());
    Registry registry = builtin;
    configuration = resolve_configuration(root, "fuzz.yaml", registry, sections);
  });
  if (!accepted || !configuration.plugins.empty()) return 0;
  // The resolved configuration is written next to the results, and gives the same run again.
  const std::string resolved = to_yaml(configuration);
  fuzz::require(fuzz::accepts([&] {
                  Registry registry = builtin;
                  const ConfigurationNode root = parse_yaml(resolved, "resolved.yaml", "/");
                  const Configuration again = resolve_configuration(root, "resolved.yaml", registry, sections);
                  fuzz::require(to_yaml(again) == resolved, "a resolved configuration resolves to itself");
                }),
                "a resolved configuration is a configuration");
  return 0;
}

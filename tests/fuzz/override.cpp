// SPDX-License-Identifier: BSD-3-Clause
// Overrides of a configuration, as after --set.
#include "fuzz.hpp"
#include "holdfast/config/configuration.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ConfigurationNode base = parse_yaml(
      "source: { tum: { path: here } }\ncamera: tum_fr1\nfeatures: orb\n"
      "filters: [semantic_mask, motion_objects: { threshold: 2 }]\nrun: { mode: sequential }\n",
      "base.yaml", "/");
  ConfigurationNode root = base;
  fuzz::accepts([&] { apply_override(root, fuzz::text_of({data, size}), choice_sections()); });
  root.found();
  return 0;
}

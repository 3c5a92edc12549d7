// SPDX-License-Identifier: BSD-3-Clause
// The build record of a plugin, which is read from its ELF file before anything of the file is loaded.
#include "abi_of_file.hpp"
#include "fuzz.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("plugin.so", {data, size});
  fuzz::accepts([&] {
    is_cut_off(file);
    if (const auto record = read_abi_of_file(file)) abi_differences(compiled_abi(), *record);
  });
  return 0;
}

// SPDX-License-Identifier: BSD-3-Clause
#include "shipped_weights.hpp"

// The assembler copies the file: C++20 has no way of its own that a compiler survives with megabytes.
__asm__(
    ".pushsection .rodata\n"
    ".balign 16\n"
    "holdfast_unet_begin:\n"
    ".incbin \"" HOLDFAST_UNET_WEIGHTS
    "\"\n"
    "holdfast_unet_end:\n"
    ".popsection\n");

// Hidden: through a table of addresses, as aarch64 has it for others, the linker takes both labels for the first.
extern "C" {
[[gnu::visibility("hidden")]] extern const std::uint8_t holdfast_unet_begin[];
[[gnu::visibility("hidden")]] extern const std::uint8_t holdfast_unet_end[];
}

namespace holdfast::unet_plugin {

std::span<const std::uint8_t> shipped_unet() { return {holdfast_unet_begin, holdfast_unet_end}; }

}  // namespace holdfast::unet_plugin

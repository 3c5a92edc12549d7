// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace holdfast::unet_plugin {

/// The network that Holdfast comes with: unet.onnx of this folder, compiled in.
std::span<const std::uint8_t> shipped_unet();

}  // namespace holdfast::unet_plugin

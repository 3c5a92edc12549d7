// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// The images of the fake cameras: what the driver gives, and the test expects.
constexpr int fake_width = 64, fake_height = 48, fake_images = 15;

constexpr std::uint64_t fake_colour_time(int i) { return 1000 + 33'333ULL * static_cast<unsigned>(i); }  // [us]
constexpr std::uint64_t fake_depth_time(int i) { return fake_colour_time(i) + 4000; }
constexpr std::uint8_t fake_red(int i) { return static_cast<std::uint8_t>(10 * i); }
constexpr std::uint16_t fake_depth(int i, int x) { return static_cast<std::uint16_t>(1000 * i + x); }  // [mm]

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace holdfast {

class Segmenter;
template <class Settings>
class ParameterTable;

/// The segmenter `unet`: what each value means, and its range, is in the reference (`holdfast modules unet`).
struct UnetSettings {
  using Interface = Segmenter;
  static constexpr const char* module = "unet";

  std::string size = "base";
  int width = 0, height = 0;
  bool mirror = true;
  std::filesystem::path model;
  int threads = 0;

  static void describe(ParameterTable<UnetSettings>& table);
};

}  // namespace holdfast

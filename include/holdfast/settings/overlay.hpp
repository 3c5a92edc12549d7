// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/choice.hpp"

namespace holdfast {

class Observer;
template <class Settings>
class ParameterTable;

/// Format of the pictures: single files (png, jpg) or one video (avi, mp4).
enum class PictureFormat { png, jpg, avi, mp4 };
/// Layout of a picture: the overlay alone, or the input image to its left.
enum class PictureLayout { single, side_by_side };

template <>
inline constexpr Choice<PictureFormat> choice_table<PictureFormat>[] = {
    {"png", PictureFormat::png}, {"jpg", PictureFormat::jpg}, {"avi", PictureFormat::avi}, {"mp4", PictureFormat::mp4}};
template <>
inline constexpr Choice<PictureLayout> choice_table<PictureLayout>[] = {{"single", PictureLayout::single},
                                                                        {"side_by_side", PictureLayout::side_by_side}};

/// Settings of the observer `overlay`. Ranges and units: `holdfast modules overlay`.
/// Thread: any.
struct OverlaySettings {
  using Interface = Observer;
  static constexpr const char* module = "overlay";

  int every = 1;  ///< a picture is written for every n-th frame
  PictureFormat format = PictureFormat::jpg;
  PictureLayout layout = PictureLayout::single;
  int quality = 90;  ///< JPEG quality, 1 to 100

  static void describe(ParameterTable<OverlaySettings>& table);
};

}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/image_files/image_list.hpp"

namespace holdfast {

/// Reads two lists of images of a recording and associates them by associate_stamps() within `max_time_difference` [s].
/// `kinds` names the images for errors: "colour and depth". Throws InputError with file and line for invalid lists, and
/// if there is no pair.
std::vector<ListedPair> associate_lists(const std::filesystem::path& first_list,
                                        const std::filesystem::path& second_list, double max_time_difference,
                                        const std::string& kinds);

/// Reads the pairs of colour and depth images of a recording in TUM layout, in temporal order: those of rgb.txt and
/// depth.txt, associated by associate_stamps() within `max_time_difference` [s], or those of the file `associations` if
/// it is given. These are the frames of the source `tum`. Throws InputError with file and line for invalid lists and if
/// there is no pair.
std::vector<ListedPair> recording_pairs(const std::filesystem::path& folder, const std::filesystem::path& associations,
                                        double max_time_difference);

}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "holdfast/image_files/image_list.hpp"

namespace holdfast {

/// The colour and depth images that make the frames of a recording in TUM layout, in order of time: those of rgb.txt
/// and depth.txt, paired by associate_stamps() within `max_time_difference` [s], or, where `associations` names a file
/// of ready pairs, that file's. Whoever wants the same frames as the source `tum` asks here. Throws InputError with
/// file and line for lists that cannot be used or make no pair.
std::vector<ListedPair> recording_pairs(const std::filesystem::path& folder, const std::filesystem::path& associations,
                                        double max_time_difference);

}  // namespace holdfast

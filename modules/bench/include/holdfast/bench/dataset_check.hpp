// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/bench/dataset_recipe.hpp"
#include "holdfast/image_files/image_list.hpp"

namespace holdfast {

/// Content of a recording's folder, and problems with their remedies.
struct DatasetCheck {
  std::vector<std::string> facts;
  std::vector<std::string> problems;
};

/// The recipe whose folder, or whose name, a path ends with; nullptr when none does.
const DatasetRecipe* recipe_of_folder(const std::filesystem::path& folder);

/// Layout of a folder, recognised by its files; tum if none is recognised.
DatasetLayout layout_of(const std::filesystem::path& folder);

/// Checks a recording: readable lists, all listed images present, complete and of the camera's size, decoding of a
/// sample, coverage by the ground truth, the number of images of the recipe, and masks for all colour images of
/// recordings with masks. For stereo pairs, the images of both cameras, calibration and truth are checked. Without a
/// recipe the layout is that of layout_of(), with any camera.
DatasetCheck check_dataset(const std::filesystem::path& folder, const DatasetRecipe* recipe);

/// The colour-depth pairs of the source `tum` or, for the layout of ICL-NUIM, of its list, colour image first. Throws
/// InputError, also for a recording without depth.
std::vector<ListedPair> dataset_pairs(const std::filesystem::path& folder, DatasetLayout layout,
                                      double max_time_difference);

}  // namespace holdfast

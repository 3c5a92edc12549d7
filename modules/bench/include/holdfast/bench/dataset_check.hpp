// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/bench/dataset_recipe.hpp"
#include "holdfast/image_files/image_list.hpp"

namespace holdfast {

/// What a folder holds, and what is wrong with it, each with what to do.
struct DatasetCheck {
  std::vector<std::string> facts;
  std::vector<std::string> problems;
};

/// The recipe whose folder, or whose name, a path ends with; nullptr when none does.
const DatasetRecipe* recipe_of_folder(const std::filesystem::path& folder);

/// The layout that the files of a folder show; tum where they show none.
DatasetLayout layout_of(const std::filesystem::path& folder);

/// Looks at a recording: are the lists there and readable, is every image that they list, has each its end and the
/// camera's size, does a sample of them decode, does the truth cover them, are there as many as the recipe says, has
/// every colour image its mask where there should be masks. Of stereo pairs: the same of the images of both cameras,
/// and are calibration and truth readable. Without a recipe: a recording of any camera in the layout that layout_of()
/// says.
DatasetCheck check_dataset(const std::filesystem::path& folder, const DatasetRecipe* recipe);

/// The pairs that the source `tum` gives for the recording, or, of a recording in the layout of ICL-NUIM, those that
/// its list holds, the colour image first. Throws InputError, as for a recording without depth.
std::vector<ListedPair> dataset_pairs(const std::filesystem::path& folder, DatasetLayout layout,
                                      double max_time_difference);

}  // namespace holdfast

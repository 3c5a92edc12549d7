// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/camera.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {

/// Layout of the files of a recording.
enum class DatasetLayout {
  tum,       ///< rgb.txt and depth.txt list the images with their stamps (Sturm et al., IROS 2012)
  icl_nuim,  ///< associations.txt lists numbered pairs, the depth image first (Handa et al., ICRA 2014); what the
             ///< source `icl_nuim` reads
  kitti,  ///< stereo pairs of the KITTI odometry or raw data (Geiger et al., CVPR 2012); what the source `kitti` reads
  euroc,  ///< stereo pairs in the ASL layout (Burri et al., IJRR 2016); what the source `euroc` reads
  four_seasons,  ///< undistorted stereo pairs of 4Seasons (Wenzel et al., GCPR 2020); what the source `four_seasons`
                 ///< reads
  openloris,     ///< the package format of OpenLORIS-Scene (Shi et al., ICRA 2020); what the source `openloris` reads
  phone,         ///< folders of Record3D, NeRFCapture, Nerfstudio and Stray Scanner; what the source `phone` reads
};

/// tum, icl_nuim, kitti, euroc, four_seasons, openloris or phone.
const char* layout_name(DatasetLayout layout);
/// Whether the recording contains the calibration of its cameras, so that a recipe gives none.
inline bool brings_camera(DatasetLayout layout) {
  return layout == DatasetLayout::kitti || layout == DatasetLayout::euroc || layout == DatasetLayout::four_seasons ||
         layout == DatasetLayout::openloris || layout == DatasetLayout::phone;
}

/// Description of a known recording: its origin, and properties by which a folder is checked. Nothing is downloaded.
struct DatasetRecipe {
  std::string name;      ///< as in published figures: fr3_walking_xyz, bonn_crowd, w21
  std::string dataset;   ///< name of the data set
  std::string folder;    ///< folder in its archive
  std::string licence;   ///< "unknown; ..." where its page says nothing that we know
  std::string citation;  ///< publication to cite
  std::string address;   ///< web address of its download page
  std::string about;     ///< remarks for users; may be empty
  std::string make;      ///< command that generates a composed sequence; otherwise empty
  DatasetLayout layout = DatasetLayout::tum;
  Camera camera;  ///< a known one; of stereo pairs it is in their own files, and this one has no name
  std::string truth = "groundtruth.txt";
  /// Values of source.tum.truth_left and truth_right; nothing = the truth is that of the camera.
  std::optional<ConfigurationNode> truth_left, truth_right;
  /// True if depth.txt lists images that are not in the published archive, which is no damage.
  bool lists_absent_depth = false;
  bool has_masks = false;                    ///< mask.txt and mask/: of every colour image, 0 = static, k = person k
  std::optional<std::size_t> colour, depth;  ///< number of images; empty if not documented
  std::optional<std::size_t> pairs;          ///< colour-depth pairs within 0.02 s, or stereo pairs

  /// How to get it, in a sentence.
  std::string how_to_get() const;
};

/// All recipes, dataset by dataset: those of modules/bench/recipes/*.yaml.
const std::vector<DatasetRecipe>& dataset_recipes();

/// Nullptr when there is none of that name.
const DatasetRecipe* find_recipe(const std::string& name);
/// "there is no recipe 'x'; did you mean 'y'? `holdfast dataset list` shows all".
std::string no_such_recipe(const std::string& name);

/// Reads a file of recipes: keys of the dataset, and `sequences`. Appends everything that is wrong to `diagnostics`.
std::vector<DatasetRecipe> read_recipes(const std::string& yaml, const std::string& file_name,
                                        std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast

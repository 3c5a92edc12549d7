// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/dataset_check.hpp"

#include <algorithm>
#include <functional>
#include <set>

#include "file_signature.hpp"
#include "holdfast/core/folder_name.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/image_files/calibrated_recording.hpp"
#include "holdfast/image_files/icl_nuim_files.hpp"
#include "holdfast/image_files/image_decoder.hpp"
#include "holdfast/image_files/image_structure.hpp"
#include "holdfast/image_files/phone_recording.hpp"
#include "holdfast/image_files/recorded_imu.hpp"
#include "holdfast/image_files/recording_pairs.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

constexpr double max_time_difference = 0.02;
constexpr const char* icl_list = "associations.txt";

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// A count with the first few of what was counted.
struct Examples {
  std::size_t count = 0;
  std::string first;

  void add(const std::string& example) {
    if (++count <= 3) first += (count == 1 ? "" : ", ") + example;
  }
  std::string text() const { return first + (count > 3 ? " and " + std::to_string(count - 3) + " more" : ""); }
};

/// The recording as the source of its layout reads it.
CalibratedRecording read_calibrated(const fs::path& folder, DatasetLayout layout) {
  if (layout == DatasetLayout::kitti) {
    KittiOptions options;
    options.path = folder;
    return read_kitti_recording(options);
  }
  if (layout == DatasetLayout::euroc) {
    EurocOptions options;
    options.path = folder;
    return read_euroc_recording(options);
  }
  if (layout == DatasetLayout::four_seasons) {
    FourSeasonsOptions options;
    options.path = folder;
    return read_four_seasons_recording(options);
  }
  if (layout == DatasetLayout::phone) {
    PhoneOptions options;
    options.path = folder;
    return read_phone_recording(options);
  }
  OpenLorisOptions options;
  options.path = folder;
  return read_openloris_recording(options);
}

class Checker {
 public:
  Checker(const fs::path& folder, const DatasetRecipe* recipe) : folder_(folder), recipe_(recipe) {
    if (recipe_ == nullptr || brings_camera(recipe_->layout)) return;
    size_ = {recipe_->camera.width, recipe_->camera.height};
    camera_ = "of the camera " + recipe_->camera.name;
  }

  DatasetCheck result() {
    std::error_code ignored;
    if (!fs::is_directory(folder_, ignored)) {
      problem("'" + folder_.string() + "' is no folder" + (recipe_ ? "; " + recipe_->how_to_get() : ""));
      return check_;
    }
    if (recipe_)
      fact(recipe_->name + ": " + recipe_->dataset +
           (recipe_->camera.name.empty() || brings_camera(recipe_->layout) ? "" : ", camera " + recipe_->camera.name));
    const DatasetLayout layout = recipe_ ? recipe_->layout : layout_of(folder_);
    if (brings_camera(layout)) {
      attempt([&] { check_calibrated(layout); });
      return check_;
    }
    if (layout == DatasetLayout::icl_nuim)
      check_icl();
    else
      check_tum();
    check_truth(layout);
    return check_;
  }

 private:
  using Decode = std::function<void(const fs::path&)>;

  void fact(const std::string& text) { check_.facts.push_back(text); }
  void problem(const std::string& text) { check_.problems.push_back(text); }

  /// Runs what throws InputError for what it cannot use.
  template <class Action>
  void attempt(const Action& action) {
    try {
      action();
    } catch (const InputError& error) {
      problem(error.what());
    }
  }

  void check_tum() {
    const bool has_lists = is_file(folder_ / "rgb.txt") && is_file(folder_ / "depth.txt");
    const auto colour = check_list("rgb.txt", "colour", recipe_ ? recipe_->colour : std::nullopt);
    const auto depth = check_list("depth.txt", "depth", recipe_ ? recipe_->depth : std::nullopt);
    for (const ListedImage& image : colour) stamps_.push_back(image.timestamp);
    check_colour_and_depth(colour, depth);
    check_imu(find_imu_file(folder_, {}), {}, stamps_);
    if (has_lists && !colour.empty() && !depth.empty())
      attempt([&] { check_pairs(dataset_pairs(folder_, DatasetLayout::tum, max_time_difference).size()); });
    if ((recipe_ && recipe_->has_masks) || is_file(folder_ / "mask.txt")) check_masks(colour);
  }

  void check_icl() {
    if (!is_file(folder_ / icl_list)) {
      problem(std::string(icl_list) + " is missing, the list of pairs; unpack the archive again");
      return;
    }
    attempt([&] {
      std::vector<ListedImage> colour, depth;
      for (const ListedPair& pair : dataset_pairs(folder_, DatasetLayout::icl_nuim, max_time_difference)) {
        colour.push_back(pair.colour);
        depth.push_back(pair.depth);
        stamps_.push_back(pair.colour.timestamp);
      }
      check_presence(icl_list, colour);
      check_presence(icl_list, depth);
      check_ends(icl_list, colour);
      check_ends(icl_list, depth);
      check_colour_and_depth(colour, depth);
      check_pairs(colour.size());
    });
  }

  /// What the sources read, with every file.
  void check_calibrated(DatasetLayout layout) {
    const CalibratedRecording recording = read_calibrated(folder_, layout);
    const auto expected = recipe_ ? recipe_->pairs : std::nullopt;
    const std::size_t frames = recording.files.size();
    const char* what = recording.has_right ? "stereo pair" : recording.depth ? "colour-depth pair" : "image";
    fact(counted(frames, what) + (expected ? ", expected " + std::to_string(*expected) : ""));
    if (expected && frames + 2 + *expected / 100 < *expected)
      problem(counted(frames, what) + "; expected " + std::to_string(*expected) + ": the recording was cut");
    const Camera& camera = recording.camera;
    fact("camera of its own files: " +
         (recording.colour_is_video ? "the size of its video" : size_text(camera.width, camera.height)) +
         (recording.has_right ? ", baseline " + fixed_text(camera.baseline, 3) + " m" : "") +
         (recording.rectification ? ", to be rectified" : ""));
    check_sides(recording);
    std::vector<double> stamps;
    for (const ImageFiles& files : recording.files) stamps.push_back(files.timestamp);
    check_imu(recording.imu_file, recording.imu, stamps);
    if (recording.truth.empty()) {
      fact("no true poses: there is nothing to measure an error by");
      return;
    }
    stamps_ = stamps;
    check_coverage("the truth", recording.truth);
  }

  void check_sides(const CalibratedRecording& recording) {
    const Decode grey = [&](const fs::path& file) { decoder_.read_grey(file); };
    const std::string first = recording.depth ? "the colour camera" : "the left camera";
    if (recording.colour_is_video)
      check_video(recording.files.front().colour);
    else
      check_side(recording, {first, first, &ImageFiles::colour, &ImageFiles::colour_listed_at}, recording.left_size,
                 grey);
    if (recording.has_right)
      check_side(recording, {"the right camera", "the right camera", &ImageFiles::right, &ImageFiles::right_listed_at},
                 recording.right_size, grey);
    if (!recording.depth) return;
    const Decode metres = [&](const fs::path& file) { decoder_.read_depth(file, *recording.depth); };
    const cv::Size depth_size = check_side(
        recording, {"the depth camera", "the depth camera", &ImageFiles::depth, &ImageFiles::depth_listed_at},
        recording.scales_depth ? cv::Size() : recording.left_size, metres);
    check_side(recording,
               {"the confidence of depth", "the depth camera", &ImageFiles::confidence, &ImageFiles::depth_listed_at},
               depth_size, grey);
  }

  struct Side {
    std::string list, camera;  ///< the name of the list in messages, and the camera that has the size
    fs::path ImageFiles::*member;
    SourceLocation ImageFiles::*listed_at;
  };

  /// Checks the images of one camera, each file once. Returns their size.
  cv::Size check_side(const CalibratedRecording& recording, const Side& side, const cv::Size& size,
                      const Decode& decode) {
    std::vector<ListedImage> images, decoded;
    std::set<fs::path> seen;
    Examples of_other_format;
    std::size_t exr_images = 0;
    for (const ImageFiles& files : recording.files) {
      const fs::path& file = files.*side.member;
      if (file.empty() || !seen.insert(file).second) continue;
      images.push_back({files.timestamp, file.lexically_relative(folder_).string(), (files.*side.listed_at).line});
      if (file.extension() != ".exr") {
        decoded.push_back(images.back());
      } else if (is_file(file)) {
        ++exr_images;
        attempt([&] {
          if (!has_signature(file, exr_signature)) of_other_format.add(place_of(images.back()));
        });
      }
    }
    size_ = size;
    camera_ = "of " + side.camera;
    check_presence(side.list, images);
    if (exr_images > 0) fact("of " + counted(exr_images, "OpenEXR image") + " only the first bytes were checked");
    if (of_other_format.count > 0)
      problem(side.list + " lists " + counted(of_other_format.count, "file") + " .exr that " +
              (of_other_format.count == 1 ? "is no OpenEXR image: " : "are no OpenEXR images: ") +
              of_other_format.text() + "; copy the recording again");
    const cv::Size found = check_ends(side.list, decoded);
    check_images(decoded, decode);
    return found;
  }

  void check_video(const fs::path& file) {
    const std::string name = file.lexically_relative(folder_).string();
    if (!is_file(file)) return problem(name + " is missing, the video of the recording; copy the recording again");
    attempt([&] {
      if (!has_signature(file, mp4_signature)) problem(name + " is no MP4 video; copy the recording again");
    });
    fact("of the video only the first bytes were checked");
  }

  std::vector<ListedImage> check_list(const std::string& list, const std::string& what,
                                      std::optional<std::size_t> expected) {
    std::vector<ListedImage> images;
    if (!is_file(folder_ / list)) {
      problem(list + " is missing, the list of " + what +
              " images (lines 'timestamp filename'); unpack the archive again, or make the recording again");
      return images;
    }
    attempt([&] { images = read_image_list(folder_ / list); });
    if (images.empty()) return images;
    fact(counted(images.size(), what + " image") + (expected ? ", expected " + std::to_string(*expected) : ""));
    if (expected && images.size() != *expected)
      problem(list + " lists " + counted(images.size(), "image") + "; expected " + std::to_string(*expected) +
              ": the recording was cut or changed");
    check_presence(list, images);
    check_ends(list, images);
    return images;
  }

  void check_presence(const std::string& list, const std::vector<ListedImage>& images) {
    Examples absent;
    for (const ListedImage& image : images)
      if (!is_file(folder_ / image.name)) absent.add(place_of(image));
    const std::size_t missing = absent.count;
    if (missing == 0) return;
    if (recipe_ && recipe_->lists_absent_depth && list == "depth.txt" && missing < images.size()) {
      fact(list + " lists " + counted(missing, "image") + " that " + (missing == 1 ? "does" : "do") +
           " not exist: " + absent.text() +
           "; this is known of the dataset, and nothing is damaged. A run that pairs one of them needs "
           "`source.tum.on_bad_frame: skip`");
      return;
    }
    problem(list + " lists " + counted(missing, "image") + " that " + (missing == 1 ? "is" : "are") +
            " missing: " + absent.text() + "; unpack the archive again");
  }

  static std::string place_of(const ListedImage& image) {
    return image.name + (image.line > 0 ? " (line " + std::to_string(image.line) + ")" : "");
  }

  /// Looks at the begin and the end of every file: a broken download shows there. Returns the size that was expected.
  cv::Size check_ends(const std::string& list, const std::vector<ListedImage>& images) {
    Examples damaged, of_other_size, too_large;
    cv::Size expected = size_;
    for (const ListedImage& image : images) {
      const fs::path file = folder_ / image.name;
      if (!is_file(file)) continue;
      std::string problem_of_file;
      ImageStructure structure;
      try {
        structure = examine_image_ends(file);
        problem_of_file = structure.problem;
      } catch (const InputError& error) {
        problem_of_file = error.what();
      }
      const std::string place = place_of(image);
      if (!problem_of_file.empty()) {
        damaged.add(place + " " + problem_of_file);
        unusable_.insert(image.name);
        continue;
      }
      const cv::Size size(structure.width, structure.height);
      const std::string has = place + " has " + size_text(size.width, size.height) + " pixels";
      if (!structure.has_camera_size()) {
        too_large.add(has);
        unusable_.insert(image.name);
        continue;
      }
      if (expected.width == 0) expected = size;
      if (size == expected) continue;
      of_other_size.add(has);
      unusable_.insert(image.name);
    }
    if (damaged.count > 0)
      problem(list + " lists " + counted(damaged.count, "image") + " that " + (damaged.count == 1 ? "is" : "are") +
              " damaged: " + damaged.text() + "; copy or download " + (damaged.count == 1 ? "it" : "them") + " again");
    if (of_other_size.count > 0)
      problem(list + " lists " + counted(of_other_size.count, "image") + " of another size: " + of_other_size.text() +
              "; expected " + size_text(expected.width, expected.height) + " " +
              (size_.width > 0 ? camera_ : "of the list's first image") + ": is this another recording?");
    if (too_large.count > 0)
      problem(list + " lists " + counted(too_large.count, "image") + " that " + (too_large.count == 1 ? "is" : "are") +
              " larger than a camera's: " + too_large.text() + "; expected at most " + ImageStructure::largest() +
              "; make " + (too_large.count == 1 ? "it" : "them") + " smaller");
    return expected;
  }

  void check_colour_and_depth(const std::vector<ListedImage>& colour, const std::vector<ListedImage>& depth) {
    check_images(colour, [&](const fs::path& file) { decoder_.read_widened(file); });
    check_images(depth, [&](const fs::path& file) { decoder_.read_depth(file, 5000.0); });
  }

  /// Decodes images spread over the whole recording, the first and the last among them, but for those that check_ends()
  /// has found to be damaged, too large or of another size.
  void check_images(const std::vector<ListedImage>& images, const Decode& decode) {
    constexpr std::size_t sample = 11;
    if (images.empty()) return;
    std::set<std::size_t> chosen;
    for (std::size_t i = 0; i < sample; ++i) chosen.insert(i * (images.size() - 1) / (sample - 1));
    for (const std::size_t i : chosen) {
      const fs::path file = folder_ / images[i].name;
      if (is_file(file) && !unusable_.contains(images[i].name)) attempt([&] { decode(file); });
    }
  }

  void check_imu(const fs::path& file, const std::optional<ImuCalibration>& calibration,
                 const std::vector<double>& stamps) {
    if (file.empty()) return;
    attempt([&] {
      std::vector<ImuSample> samples = read_imu_samples(file);
      fact(counted(samples.size(), "inertial measurement"));
      const RecordedImu recorded(std::move(samples), file.string(), calibration, stamps);
      for (const Diagnostic& warning : recorded.warnings()) problem(warning.to_string());
    });
  }

  void check_pairs(std::size_t pairs) {
    const auto expected = recipe_ ? recipe_->pairs : std::nullopt;
    fact(counted(pairs, "colour-depth pair") + (expected ? ", expected " + std::to_string(*expected) : ""));
    // Tools pair a little differently: a frame or two are no damage.
    if (expected && pairs + 2 + *expected / 100 < *expected)
      problem(counted(pairs, "colour-depth pair") + " within 0.02 s; expected " + std::to_string(*expected) +
              ": the lists do not belong together, or one of them was cut");
  }

  void check_masks(const std::vector<ListedImage>& colour) {
    if (!is_file(folder_ / "mask.txt")) {
      problem("mask.txt is missing, the list of masks of a composed sequence; " +
              (recipe_ && !recipe_->make.empty() ? recipe_->how_to_get() : std::string("compose it again")));
      return;
    }
    const auto masks = check_list("mask.txt", "mask", recipe_ ? recipe_->colour : std::nullopt);
    std::set<double> with_mask;
    for (const ListedImage& mask : masks) with_mask.insert(mask.timestamp);
    const auto without = std::count_if(colour.begin(), colour.end(),
                                       [&](const ListedImage& image) { return !with_mask.contains(image.timestamp); });
    if (!masks.empty() && without > 0)
      problem(counted(static_cast<std::size_t>(without), "colour image") +
              " without a mask of the same stamp in mask.txt; every one needs one: compose the sequence again");
    check_images(masks, [&](const fs::path& file) { decoder_.read_labels(file); });
  }

  /// The name of the file with the true poses; of a recording of ICL-NUIM the one that is there, since the recordings
  /// with noise have other names.
  std::string truth_name(DatasetLayout layout) {
    std::string name = recipe_ ? recipe_->truth : "groundtruth.txt";
    if (layout == DatasetLayout::icl_nuim && (recipe_ == nullptr || !is_file(folder_ / name))) {
      try {
        name = icl_nuim_truth_file(folder_).filename().string();
      } catch (const InputError&) {
        if (recipe_ == nullptr) name = "NAME.gt.freiburg";
      }
    }
    return name;
  }

  void check_truth(DatasetLayout layout) {
    const std::string name = truth_name(layout);
    if (!is_file(folder_ / name)) {
      problem(name + " is missing, the true poses; without them there is nothing to measure");
      return;
    }
    attempt([&] {
      const Trajectory truth = read_trajectory(folder_ / name);
      if (truth.empty()) {
        problem(name + " holds no pose; expected lines 'timestamp tx ty tz qx qy qz qw'");
        return;
      }
      check_coverage(name, truth);
    });
  }

  void check_coverage(const std::string& name, const Trajectory& truth) {
    fact(counted(truth.size(), "true pose"));
    const auto covered = static_cast<std::size_t>(std::count_if(stamps_.begin(), stamps_.end(), [&](double stamp) {
      return stamp >= truth.front().timestamp - max_time_difference &&
             stamp <= truth.back().timestamp + max_time_difference;
    }));
    if (2 * covered < stamps_.size())
      problem(name + " covers the time of " + std::to_string(covered) + " of " +
              counted(stamps_.size(), "colour image") + "; it belongs to another recording");
  }

  fs::path folder_;
  const DatasetRecipe* recipe_;
  cv::Size size_;       ///< that the images should have; empty: any
  std::string camera_;  ///< whose size that is
  DatasetCheck check_;
  ImageDecoder decoder_;
  std::set<std::string> unusable_;  ///< names of images that are damaged, too large or of another size
  std::vector<double> stamps_;      ///< of the colour images
};

}  // namespace

const DatasetRecipe* recipe_of_folder(const fs::path& folder) {
  const std::string name = folder_name(folder);
  for (const DatasetRecipe& recipe : dataset_recipes())
    if (recipe.folder == name || recipe.name == name) return &recipe;
  return nullptr;
}

DatasetLayout layout_of(const fs::path& folder) {
  std::error_code ignored;
  if (fs::is_directory(folder / "mav0", ignored) || fs::is_directory(folder / "cam0", ignored))
    return DatasetLayout::euroc;
  if (is_file(folder / "color.txt") && !is_file(folder / "rgb.txt")) return DatasetLayout::openloris;
  if (!is_file(folder / "rgb.txt") && is_phone_folder(folder)) return DatasetLayout::phone;
  if (is_file(folder / "times.txt") && fs::is_directory(folder / "undistorted_images", ignored))
    return DatasetLayout::four_seasons;
  for (const char* part : {"oxts", "image_00", "image_02"})
    if (fs::is_directory(folder / part, ignored)) return DatasetLayout::kitti;
  if (is_file(folder / "calib.txt") && !is_file(folder / "rgb.txt")) return DatasetLayout::kitti;
  // Lists that were made for a recording in TUM layout have the same name.
  if (is_file(folder / icl_list) && !is_file(folder / "rgb.txt")) return DatasetLayout::icl_nuim;
  return DatasetLayout::tum;
}

DatasetCheck check_dataset(const fs::path& folder, const DatasetRecipe* recipe) {
  return Checker(folder, recipe).result();
}

std::vector<ListedPair> dataset_pairs(const fs::path& folder, DatasetLayout layout, double max_difference) {
  if (layout == DatasetLayout::openloris)
    return associate_lists(folder / "color.txt", folder / "aligned_depth.txt", max_difference, "colour and depth");
  if (brings_camera(layout))
    throw InputError({folder.string()}, std::string("holds ") +
                                            (layout == DatasetLayout::phone ? "frames" : "stereo pairs") +
                                            " in the layout '" + layout_name(layout) +
                                            "'; expected a recording with depth images, which can be associated with "
                                            "the colour images");
  if (layout == DatasetLayout::tum) return recording_pairs(folder, {}, max_difference);
  return icl_nuim_pairs(folder);
}

}  // namespace holdfast

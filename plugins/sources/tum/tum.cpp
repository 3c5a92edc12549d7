// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>
#include <utility>

#include "holdfast/core/folder_name.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/image_files/image_list.hpp"
#include "holdfast/image_files/image_sequence.hpp"
#include "holdfast/image_files/recorded_frames.hpp"
#include "holdfast/image_files/recording_pairs.hpp"
#include "holdfast/image_files/truth_transform.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

namespace {

struct TumSettings : RecordedFrames {
  std::filesystem::path path;
  double max_time_difference = 0.02;
  double depth_factor = 5000.0;
  int invalid_depth = DepthEncoding::largest;
  std::filesystem::path associations;
  std::string truth_frame = "camera";
  RealTable truth_left, truth_right;
  std::filesystem::path imu;

  static void describe(ParameterTable<TumSettings>& table) {
    table
        .add("path", &TumSettings::path,
             "folder of the recording, with rgb.txt and depth.txt; with `sensor: mono`, rgb.txt alone will do")
        .required();
    table
        .add("max_time_difference", &TumSettings::max_time_difference,
             "upper bound of the time difference between a colour image and its depth image")
        .range(1e-6, 1.0)
        .unit("s");
    table.add("depth_factor", &TumSettings::depth_factor, "value of one metre in a depth image").range(1.0, 65535.0);
    table
        .add("invalid_depth", &TumSettings::invalid_depth,
             "value of pixels without a measurement in a depth image, besides 0")
        .range(0, 65535);
    table.add("associations", &TumSettings::associations,
              "file of associated pairs, lines 'colour_timestamp colour_file depth_timestamp depth_file', used instead "
              "of rgb.txt and depth.txt; image names are relative to path");
    table
        .add(
            "truth_frame", &TumSettings::truth_frame,
            "camera: the truth of the camera, by truth_left and truth_right or, if both are empty, by the transform "
            "that is known of a dataset (rgbd_bonn_* and the camera bonn); raw: as recorded, to which published errors "
            "may refer")
        .one_of({"camera", "raw"});
    table
        .add("truth_left", &TumSettings::truth_left,
             "rigid motion before each pose of groundtruth.txt, the four rows of a matrix; empty = none. The true pose "
             "of the camera is truth_left * pose * truth_right, for motion capture that tracks markers")
        .unit("m");
    table.add("truth_right", &TumSettings::truth_right, "the same after each pose").unit("m");
    table.add(
        "imu", &TumSettings::imu,
        "file of inertial measurements under path, lines 'time stamp, angular velocity x, y, z [rad/s], specific force "
        "x, "
        "y, z [m/s^2]', stamps in seconds or nanoseconds; empty = an imu.csv that Holdfast wrote, if there is one");
    add_rows(table, "pair");
  }
};

/// The colour images of a recording without depth.txt, for one camera.
std::vector<ImageFiles> find_colour_images(const TumSettings& settings) {
  const std::filesystem::path list = settings.path / "rgb.txt";
  std::vector<ImageFiles> images;
  for (const ListedImage& image : read_image_list(list)) {
    ImageFiles& files = images.emplace_back();
    files.timestamp = image.timestamp;
    files.colour = settings.path / image.name;
    files.colour_listed_at = {list.string(), image.line};
  }
  select_range(images, settings.start, settings.frames, settings.path, "colour images");
  return images;
}

std::vector<ImageFiles> find_frames(const TumSettings& settings, const std::optional<Sensor>& sensor) {
  require_recording_folder(settings.path, "the folder of a TUM recording, with rgb.txt and depth.txt",
                           "source.tum.path");
  std::error_code error;
  if (settings.associations.empty() && !std::filesystem::exists(settings.path / "rgb.txt", error) &&
      std::filesystem::exists(settings.path / "color.txt", error))
    throw InputError({settings.path.string()},
                     "has a color.txt and no rgb.txt, as sequences of OpenLORIS-Scene do; expected rgb.txt and "
                     "depth.txt; read such a sequence by `source: { openloris: { path: " +
                         settings.path.string() + " } }`");
  const std::filesystem::path depth_list = settings.path / "depth.txt";
  if (settings.associations.empty() && !std::filesystem::exists(depth_list, error)) {
    if (sensor == Sensor::mono) return find_colour_images(settings);
    if (std::filesystem::exists(settings.path / "rgb.txt", error))
      throw InputError({depth_list.string()},
                       "is missing; expected a list with lines 'timestamp filename'; complete the recording, or set "
                       "`sensor: mono` to use its colour images alone");
  }
  const auto listed_in = [&](const char* list) {
    return (settings.associations.empty() ? settings.path / list : settings.associations).string();
  };
  std::vector<ImageFiles> pairs;
  for (const ListedPair& pair : recording_pairs(settings.path, settings.associations, settings.max_time_difference))
    pairs.push_back({pair.colour.timestamp,
                     pair.depth.timestamp - pair.colour.timestamp,
                     settings.path / pair.colour.name,
                     settings.path / pair.depth.name,
                     {listed_in("rgb.txt"), pair.colour.line},
                     {listed_in("depth.txt"), pair.depth.line}});
  select_range(pairs, settings.start, settings.frames, settings.path, "colour and depth pairs");
  return pairs;
}

/// What shutter.txt says, which Holdfast writes beside its own recordings; without the file, the camera knows.
bool has_global_shutter(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "shutter.txt";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return false;
  const std::string expected = "'global' (all rows of an image are exposed at once) or 'rolling'";
  std::istringstream text(file_content(file, largest_file::configuration, expected));
  std::string word;
  text >> word;
  if (word != "global" && word != "rolling") throw InputError({file.string(), 1}, "expected " + expected);
  return word == "global";
}

ImageSequenceOptions options_of(const TumSettings& settings, const Camera& camera) {
  ImageSequenceOptions options{
      {settings.depth_factor, settings.invalid_depth}, camera.width, camera.height, settings.skips_bad_frames()};
  options.invalid_depth_key = "source.tum.invalid_depth";
  return options;
}

/// A recording in the layout of the TUM RGB-D benchmark (Sturm et al., IROS 2012), which the Bonn RGB-D Dynamic dataset
/// shares. A colour image without a depth image near enough in time makes no frame.
class TumSource final : public ImageSequenceSource {
 public:
  TumSource(const TumSettings& settings, const CreationContext& context)
      : TumSource(find_frames(settings, context.sensor), settings, context) {}

 private:
  TumSource(std::vector<ImageFiles> frames, const TumSettings& settings, const CreationContext& context)
      : ImageSequenceSource(frames, options_of(settings, context.camera)) {
    description_.name = folder_name(settings.path);
    description_.has_depth = !frames.front().depth.empty();
    description_.has_global_shutter = has_global_shutter(settings.path);
    const std::filesystem::path truth_file = settings.path / "groundtruth.txt";
    const TruthTransform transform = choose_truth_transform({.is_raw = settings.truth_frame == "raw",
                                                             .left = settings.truth_left,
                                                             .right = settings.truth_right,
                                                             .place = "source.tum"},
                                                            truth_file, context.camera);
    description_.truth_frame = transform.frame();
    if (std::filesystem::exists(truth_file)) truth_ = transformed(transform, read_trajectory(truth_file));
    read_imu(find_imu_file(settings.path, settings.imu), context.imu);
  }
};

}  // namespace

HOLDFAST_PLUGIN(tum, registry) {
  registry.add<FrameSource, TumSource, TumSettings>(
      {.name = "tum",
       .summary = "Recordings in the layout of the TUM RGB-D benchmark, also Bonn RGB-D Dynamic.",
       .paper =
           "Sturm, Engelhard, Endres, Burgard, Cremers: A benchmark for the evaluation of RGB-D SLAM systems, IROS "
           "2012"});
}

}  // namespace holdfast

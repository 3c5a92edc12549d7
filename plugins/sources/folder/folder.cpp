// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "holdfast/core/folder_name.hpp"
#include "holdfast/image_files/image_list.hpp"
#include "holdfast/image_files/image_sequence.hpp"
#include "holdfast/image_files/numbered_files.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "intrinsics.hpp"

namespace holdfast {

namespace {

using namespace folder_plugin;

struct FolderSettings {
  std::filesystem::path path;
  std::string colour = "colour";
  std::string depth;
  double depth_factor = 5000.0;
  double frame_rate = 30.0;
  std::filesystem::path stamps;
  std::filesystem::path truth;
  std::filesystem::path intrinsics;
  std::string on_bad_frame = "fail";
  std::int64_t start = 0;
  std::int64_t frames = 0;

  static void describe(ParameterTable<FolderSettings>& table) {
    table.add("path", &FolderSettings::path, "folder of the recording").required();
    table.add("colour", &FolderSettings::colour,
              "colour images under path: a folder of numbered images, or a pattern such as 'colour/%06d.png'");
    table.add("depth", &FolderSettings::depth,
              "depth images under path, 16-bit PNG with the numbers of the colour images: a folder, or a pattern where "
              "colour is one; empty = no depth");
    table.add("depth_factor", &FolderSettings::depth_factor, "value of one metre in a depth image").range(1.0, 65535.0);
    table.add("frame_rate", &FolderSettings::frame_rate, "frame rate, if no time stamps are given")
        .range(0.001, 100000.0)
        .unit("Hz");
    table.add("stamps", &FolderSettings::stamps,
              "file with one time stamp per line for each colour image, instead of frame_rate");
    table.add("truth", &FolderSettings::truth, "ground-truth trajectory in TUM format");
    table.add(
        "intrinsics", &FolderSettings::intrinsics,
        "YAML or JSON file with fx, fy, cx, cy, width, height and, for a lens with distortion, k1, k2, p1, p2, k3; "
        "if the configuration has a camera too, both must agree");
    table
        .add("on_bad_frame", &FolderSettings::on_bad_frame,
             "reaction to a missing, damaged or unsuitable image: stop with an error, or skip and count the frame")
        .one_of({"fail", "skip"});
    table.add("start", &FolderSettings::start, "index of the first frame, from 0").at_least(0);
    table.add("frames", &FolderSettings::frames, "number of frames, 0 = all").at_least(0);
  }
};

/// The files of every frame, without stamps.
std::vector<ImageFiles> find_images(const FolderSettings& settings) {
  const bool is_pattern = NumberPattern::is_pattern(settings.colour);
  std::vector<NumberedFile> colour;
  if (is_pattern)
    colour = NumberPattern(settings.path, settings.colour).find();
  else
    colour = find_numbered_files(settings.path / settings.colour);
  std::vector<ImageFiles> files(colour.size());
  for (std::size_t i = 0; i < colour.size(); ++i) files[i].colour = colour[i].path;
  if (settings.depth.empty()) return files;

  if (NumberPattern::is_pattern(settings.depth) != is_pattern)
    throw InputError({(settings.path / settings.depth).string()},
                     std::string("is a ") + (is_pattern ? "folder" : "pattern") + ", but the colour images '" +
                         settings.colour + "' are a " + (is_pattern ? "pattern" : "folder") +
                         "; expected two patterns or two folders");
  if (is_pattern) {
    const NumberPattern pattern(settings.path, settings.depth);
    pattern.find();  // says so when the pattern fits no file at all
    for (std::size_t i = 0; i < files.size(); ++i) files[i].depth = pattern.path_of(colour[i].numbers.front());
    return files;
  }
  const std::vector<NumberedFile> depth = find_numbered_files(settings.path / settings.depth);
  std::size_t next = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    while (next < depth.size() && comes_before(depth[next].numbers, colour[i].numbers)) ++next;
    const bool found = next < depth.size() && depth[next].numbers == colour[i].numbers;
    // A depth image that is not there gets the name that it should have, so that the frame is bad and says so.
    files[i].depth =
        found ? depth[next].path : settings.path / settings.depth / (colour[i].path.stem().string() + ".png");
  }
  return files;
}

void set_stamps(std::vector<ImageFiles>& files, const FolderSettings& settings) {
  if (settings.stamps.empty()) {
    for (std::size_t i = 0; i < files.size(); ++i) files[i].timestamp = static_cast<double>(i) / settings.frame_rate;
    return;
  }
  const std::vector<ListedImage> stamps = read_stamp_list(settings.stamps);
  if (stamps.size() != files.size())
    throw InputError({settings.stamps.string(), stamps.back().line},
                     "the file ends with " + std::to_string(stamps.size()) + " stamps, but there are " +
                         std::to_string(files.size()) + " colour images from '" + files.front().colour.string() +
                         "' to '" + files.back().colour.string() + "'; expected one stamp for each");
  for (std::size_t i = 0; i < files.size(); ++i) files[i].timestamp = stamps[i].timestamp;
}

std::vector<ImageFiles> find_frames(const FolderSettings& settings) {
  std::error_code error;
  if (!std::filesystem::is_directory(settings.path, error))
    throw InputError({settings.path.string()},
                     std::string(std::filesystem::exists(settings.path, error) ? "is not a folder" : "is missing") +
                         "; expected the folder of a recording; set `source.folder.path`");
  std::vector<ImageFiles> files = find_images(settings);
  set_stamps(files, settings);
  select_range(files, settings.start, settings.frames, settings.path, "frames");
  return files;
}

/// Numbered images in folders.
class FolderSource final : public FrameSource {
 public:
  FolderSource(const FolderSettings& settings, const CreationContext& context)
      : description_(describe(settings, context.camera)), sequence_(open(settings, context.camera)) {
    description_.frame_count = sequence_.size();
    if (!settings.truth.empty()) truth_ = read_trajectory(settings.truth);
  }

  SourceDescription describe() const override { return description_; }
  std::optional<SensorFrame> next() override { return sequence_.next(); }
  Trajectory truth() const override { return truth_; }
  std::vector<SkippedFrame> skipped() const override { return sequence_.skipped(); }

 private:
  static SourceDescription describe(const FolderSettings& settings, const Camera& camera) {
    SourceDescription description;
    description.name = folder_name(settings.path);
    description.has_depth = !settings.depth.empty();
    description.can_read_ahead = true;
    if (settings.intrinsics.empty()) return description;
    description.camera = read_intrinsics(settings.intrinsics, camera);
    if (settings.stamps.empty()) description.camera->frame_rate = settings.frame_rate;
    return description;
  }

  ImageSequence open(const FolderSettings& settings, const Camera& configured) const {
    const Camera& camera = description_.camera ? *description_.camera : configured;
    return {find_frames(settings),
            {settings.depth_factor, camera.width, camera.height, settings.on_bad_frame == "skip"}};
  }

  SourceDescription description_;  // first: the sequence needs its camera
  ImageSequence sequence_;
  Trajectory truth_;
};

}  // namespace

HOLDFAST_PLUGIN(folder, registry) {
  registry.add<FrameSource, FolderSource, FolderSettings>(
      {.name = "folder", .summary = "Numbered colour images in a folder, with or without depth.", .paper = ""});
}

}  // namespace holdfast

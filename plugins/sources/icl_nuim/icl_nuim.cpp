// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/folder_name.hpp"
#include "holdfast/image_files/icl_nuim_files.hpp"
#include "holdfast/image_files/image_sequence.hpp"
#include "holdfast/image_files/recorded_frames.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

namespace {

struct IclNuimSettings : RecordedFrames {
  std::filesystem::path path;
  std::filesystem::path truth;
  double frame_rate = 30.0;

  static void describe(ParameterTable<IclNuimSettings>& table) {
    table
        .add("path", &IclNuimSettings::path,
             "folder of a TUM-compatible recording, with associations.txt and NAME.gt.freiburg")
        .required();
    table.add("truth", &IclNuimSettings::truth,
              "file of the true poses, as published; empty = the only *.gt.freiburg of the folder");
    table.add("frame_rate", &IclNuimSettings::frame_rate, "frame rate; frame i has the time stamp i / frame_rate")
        .range(0.001, 100000.0)
        .unit("Hz");
    add_rows(table, "pair");
  }
};

constexpr double depth_factor = 5000.0;  // as in the TUM benchmark

std::vector<ImageFiles> find_pairs(const IclNuimSettings& settings) {
  require_recording_folder(settings.path, "the folder of an ICL-NUIM recording, with associations.txt",
                           "source.icl_nuim.path");
  const std::string list = (settings.path / "associations.txt").string();
  std::vector<ImageFiles> pairs;
  for (const ListedPair& pair : icl_nuim_pairs(settings.path))
    pairs.push_back({pair.colour.timestamp / settings.frame_rate,
                     (pair.depth.timestamp - pair.colour.timestamp) / settings.frame_rate,
                     settings.path / pair.colour.name,
                     settings.path / pair.depth.name,
                     {list, pair.colour.line},
                     {list, pair.depth.line}});
  select_range(pairs, settings.start, settings.frames, settings.path, "colour and depth pairs");
  return pairs;
}

/// A rendered recording of ICL-NUIM (Handa et al., ICRA 2014) in its TUM-compatible form, with the truth turned to the
/// camera of its images.
class IclNuimSource final : public ImageSequenceSource {
 public:
  IclNuimSource(const IclNuimSettings& settings, const CreationContext& context)
      : ImageSequenceSource(find_pairs(settings),
                            {depth_factor, context.camera.width, context.camera.height, settings.skips_bad_frames()}) {
    truth_ = read_icl_nuim_truth(settings.truth.empty() ? icl_nuim_truth_file(settings.path) : settings.truth,
                                 settings.frame_rate);
    description_.name = folder_name(settings.path);
    description_.has_depth = true;
    description_.has_global_shutter = true;  // rendered
    description_.truth_frame = "transformed";
  }
};

}  // namespace

HOLDFAST_PLUGIN(icl_nuim, registry) {
  registry.add<FrameSource, IclNuimSource, IclNuimSettings>(
      {.name = "icl_nuim",
       .summary = "Rendered recordings of ICL-NUIM in their TUM-compatible form.",
       .paper = "Handa, Whelan, McDonald, Davison: A benchmark for RGB-D visual odometry, 3D reconstruction and SLAM, "
                "ICRA 2014"});
}

}  // namespace holdfast

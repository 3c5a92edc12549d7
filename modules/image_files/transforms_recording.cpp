// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/image_files/frame_poses.hpp"
#include "holdfast/image_files/numbered_files.hpp"
#include "phone_layouts.hpp"
#include "yaml_numbers.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

using yaml_numbers::location;

/// The value of a key of a frame or, where it has none, of the file.
YAML::Node inherited(const YAML::Node& frame, const YAML::Node& root, const char* key) {
  const YAML::Node own = frame[key];
  return own ? own : root[key];
}

YAML::Node required(const fs::path& file, const YAML::Node& frame, const YAML::Node& root, const char* key) {
  if (const YAML::Node value = inherited(frame, root, key)) return value;
  throw InputError(location(file, frame.Mark()),
                   std::string("has no \"") + key +
                       "\", nor has the file; expected fl_x, fl_y, cx, cy, w and h of the camera, and file_path and "
                       "transform_matrix of each frame");
}

std::string text_of(const YAML::Node& node) { return node && node.IsScalar() ? node.Scalar() : std::string(); }

/// The image of a frame: NeRFCapture leaves out the ending of its name.
fs::path image_path(const fs::path& folder, const std::string& name) {
  const fs::path path = folder / name;
  std::error_code error;
  if (fs::exists(path, error)) return path;
  for (const char* extension : {".png", ".jpg", ".jpeg"})
    if (fs::path whole = path.string() + extension; fs::exists(whole, error)) return whole;
  return path.has_extension() ? path : fs::path(path.string() + ".png");
}

struct ListedFrame {
  ImageFiles files;
  NumberedFrame numbered;
};

/// The factor of the depth images: that of the options, of the file, or of Nerfstudio, whose depth is in millimetres.
double depth_factor(const fs::path& file, const YAML::Node& root, bool is_nerfstudio, double wanted) {
  if (wanted > 0.0) return wanted;
  constexpr double millimetres = 1000.0, largest = 65535.0;
  if (is_nerfstudio) {
    const YAML::Node unit = root["depth_unit_scale_factor"];
    return unit ? 1.0 / yaml_numbers::number(file, unit, "depth_unit_scale_factor", true) : millimetres;
  }
  const YAML::Node scale = root["integer_depth_scale"];
  if (!scale)
    throw InputError(
        {file.string()},
        "names depth images, but has no \"integer_depth_scale\", the metres of one unit; expected one; set "
        "`source.phone.depth_factor`");
  const double factor = 1.0 / yaml_numbers::number(file, scale, "integer_depth_scale", true);
  if (factor < 1.0 || factor >= largest - 0.5)
    throw InputError(location(file, scale.Mark()),
                     "makes one metre " + std::to_string(factor) + " units of 16 bits, so that depth beyond " +
                         std::to_string(65535.0 / factor) +
                         " m could not be stored; expected less than 65535: record with `--depth_scale 10`; if it is "
                         "meant, set `source.phone.depth_factor`");
  return factor;
}

Distortion read_distortion(const fs::path& file, const YAML::Node& frame, const YAML::Node& root) {
  const YAML::Node named = inherited(frame, root, "camera_model");
  const std::string model = text_of(named);
  const bool is_fisheye = model == "OPENCV_FISHEYE";
  if (!model.empty() && model != "OPENCV" && model != "PINHOLE" && model != "SIMPLE_PINHOLE" && !is_fisheye)
    throw InputError(location(file, named.Mark()),
                     "found the camera model '" + model + "'; expected OPENCV, OPENCV_FISHEYE or PINHOLE");
  const auto number = [&](const char* key) {
    const YAML::Node value = inherited(frame, root, key);
    return value ? yaml_numbers::number(file, value, key) : 0.0;
  };
  if (is_fisheye)
    return yaml_numbers::distortion(Lens::fisheye, {number("k1"), number("k2"), number("k3"), number("k4")});
  return yaml_numbers::distortion(Lens::radial_tangential,
                                  {number("k1"), number("k2"), number("p1"), number("p2"), number("k3")});
}

ListedFrame read_frame(const fs::path& folder, const fs::path& file, const YAML::Node& frame, const YAML::Node& root,
                       std::size_t index) {
  const std::string name = text_of(required(file, frame, frame, "file_path"));
  const int line = frame.Mark().line + 1;
  ListedFrame listed;
  listed.files.colour = image_path(folder, name);
  listed.files.colour_listed_at = listed.files.depth_listed_at = {file.string(), line};
  for (const char* key : {"depth_path", "depth_file_path"})
    if (const std::string depth = text_of(frame[key]); !depth.empty()) listed.files.depth = folder / depth;
  if (const YAML::Node stamp = frame["timestamp"])
    listed.files.timestamp = yaml_numbers::number(file, stamp, "timestamp");
  listed.numbered = {0.0, index, numbers_of(fs::path(name).stem().string())};
  for (const char* key : {"w", "h"}) {
    const YAML::Node first = required(file, root["frames"][0], root, key), own = required(file, frame, root, key);
    if (first.Scalar() != own.Scalar())
      yaml_numbers::reject(file, own, key, first.Scalar() + ", as of the first frame");
  }
  return listed;
}

/// The encoding of the depth images, and the names of those that the file leaves out, which makes bad frames; nothing
/// for a recording without depth.
std::optional<DepthEncoding> find_depth(const fs::path& file, const YAML::Node& root, double wanted_factor,
                                        std::vector<ListedFrame>& listed) {
  bool has_depth = false, is_nerfstudio = false;
  for (const YAML::Node& frame : root["frames"]) {
    has_depth = has_depth || frame["depth_path"] || frame["depth_file_path"];
    is_nerfstudio = is_nerfstudio || frame["depth_file_path"];
  }
  if (!has_depth) return std::nullopt;
  for (ListedFrame& frame : listed)
    if (frame.files.depth.empty()) frame.files.depth = fs::path(frame.files.colour).replace_extension(".depth.png");
  return DepthEncoding(depth_factor(file, root, is_nerfstudio, wanted_factor));
}

/// Sorts the frames by their time stamps, or sets those of the frame rate where there are none.
void order_frames(const fs::path& file, const YAML::Node& frames, double frame_rate, std::vector<ListedFrame>& listed) {
  const bool has_stamps = static_cast<bool>(frames[0]["timestamp"]);
  for (std::size_t i = 0; i < listed.size(); ++i) {
    if (static_cast<bool>(frames[i]["timestamp"]) != has_stamps)
      throw InputError(location(file, frames[i].Mark()),
                       "and the first frame differ in having a \"timestamp\"; expected "
                       "it of all frames or of none");
    if (!has_stamps) listed[i].files.timestamp = static_cast<double>(i) / frame_rate;
  }
  std::stable_sort(listed.begin(), listed.end(),
                   [](const ListedFrame& a, const ListedFrame& b) { return a.files.timestamp < b.files.timestamp; });
  for (std::size_t i = 1; i < listed.size(); ++i)
    if (listed[i - 1].files.timestamp == listed[i].files.timestamp)
      throw InputError(listed[i].files.colour_listed_at,
                       "has the time stamp of another frame; expected different ones");
}

}  // namespace

CalibratedRecording read_transforms(const fs::path& folder, const PhoneOptions& options) {
  const fs::path file = folder / "transforms.json";
  const YAML::Node root = yaml_numbers::load(file, "a JSON file with \"frames\"");
  const YAML::Node frames = root.IsMap() ? root["frames"] : YAML::Node();
  if (!frames || !frames.IsSequence() || frames.size() == 0)
    throw InputError({file.string()},
                     "has no \"frames\"; expected a list of frames with file_path and transform_matrix");
  CalibratedRecording recording;
  recording.camera.name = "transforms.json";
  std::vector<ListedFrame> listed;
  std::vector<FrameIntrinsics> intrinsics;
  for (const YAML::Node& frame : frames) {
    if (!frame.IsMap()) throw InputError(location(file, frame.Mark()), "is not a frame; expected a map");
    listed.push_back(read_frame(folder, file, frame, root, listed.size()));
    const auto number = [&](const char* key, bool is_positive) {
      return yaml_numbers::number(file, required(file, frame, root, key), key, is_positive);
    };
    intrinsics.push_back({number("fl_x", true), number("fl_y", true), number("cx", false), number("cy", false)});
    const Distortion distortion = read_distortion(file, frame, root);
    if (listed.size() == 1) recording.camera.distortion = distortion;
    if (!(distortion == recording.camera.distortion))
      throw InputError(location(file, frame.Mark()),
                       "has another distortion than the first frame; expected the same camera_model and k1, k2, ... of "
                       "all frames, which are of one camera");
  }
  recording.camera.width = yaml_numbers::size(file, inherited(frames[0], root, "w"), "w");
  recording.camera.height = yaml_numbers::size(file, inherited(frames[0], root, "h"), "h");
  set_median_intrinsics(recording.camera, intrinsics);

  order_frames(file, frames, options.frame_rate, listed);
  recording.depth = find_depth(file, root, options.depth_factor, listed);
  std::vector<NumberedFrame> numbered;
  for (ListedFrame& frame : listed) {
    frame.numbered.timestamp = frame.files.timestamp;
    numbered.push_back(frame.numbered);
    recording.files.push_back(frame.files);
  }
  recording.truth = read_frame_poses(file, numbered, numbered.size());
  return recording;
}

}  // namespace holdfast

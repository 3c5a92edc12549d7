// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <utility>

#include "holdfast/core/atomic_file.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/image_files/image_decoder.hpp"
#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/surface/surface_map.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int views_version = 1;
constexpr const char* views_list = "views.json";

fs::path image_file(const fs::path& folder, const char* kind, std::uint64_t frame) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%06llu.png", static_cast<unsigned long long>(frame));
  return folder / kind / name.data();
}

void write_png(const fs::path& file, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", image, bytes)) throw InputError({file.string()}, "the image cannot be encoded as PNG");
  write_file_atomically(file, std::string(bytes.begin(), bytes.end()), Durability::later);
}

json pinhole_json(const Camera& camera) {
  return {{"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
          {"fy", camera.fy},       {"cx", camera.cx},         {"cy", camera.cy}};
}

Camera pinhole_of(const json& values) {
  constexpr double largest = 20000.0, farthest = 1e6;  // [px]
  Camera camera;
  const double width = values.at("width"), height = values.at("height");
  camera.fx = values.at("fx"), camera.fy = values.at("fy"), camera.cx = values.at("cx"), camera.cy = values.at("cy");
  if (!(width >= 3 && height >= 3 && width <= largest && height <= largest && camera.fx >= 1.0 && camera.fy >= 1.0 &&
        camera.fx <= farthest && camera.fy <= farthest && std::abs(camera.cx) <= farthest &&
        std::abs(camera.cy) <= farthest))
    throw Error("found a camera without a valid size, focal length or principal point");
  camera.width = static_cast<int>(width), camera.height = static_cast<int>(height);
  return camera;
}

/// The numbers among the settings.
json settings_json(const SurfaceSettings& settings) {
  json values = json::object();
  for (const auto& [name, value] : ParameterTable<SurfaceSettings>().values(settings)) {
    if (const auto* real = std::get_if<double>(&value)) values[name] = *real;
    if (const auto* integer = std::get_if<std::int64_t>(&value)) values[name] = *integer;
  }
  return values;
}

SurfaceSettings settings_of(const json& given) {
  const ParameterTable<SurfaceSettings> table;
  ParameterValues values;
  for (const Parameter& parameter : table.parameters()) {
    const bool is_integer = parameter.type == ParameterType::integer;
    if ((!is_integer && parameter.type != ParameterType::real) || !given.contains(parameter.name)) continue;
    const json& number = given.at(parameter.name);
    const ParameterValue value =
        is_integer ? ParameterValue(number.get<std::int64_t>()) : ParameterValue(number.get<double>());
    if (const auto reason = parameter.reject(value)) throw Error("'" + parameter.name + "': " + *reason);
    values[parameter.name] = value;
  }
  return table.settings(values);
}

json pose_json(const Eigen::Isometry3d& pose) {
  json rows = json::array();
  for (int i = 0; i < 12; ++i) rows.push_back(pose.matrix()(i / 4, i % 4));
  return rows;
}

Eigen::Isometry3d pose_of(const json& rows) {
  constexpr double farthest = 1000.0;  // between the view and its keyframe [m]
  const auto values = rows.get<std::array<double, 12>>();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = values[static_cast<std::size_t>(i)];
  const Eigen::Matrix3d square = pose.linear() * pose.linear().transpose();
  if (!((square - Eigen::Matrix3d::Identity()).norm() < 1e-6) || !(pose.translation().norm() <= farthest))
    throw Error("found a pose that is no rigid motion of at most 1000 m");
  return pose;
}

/// The keyframe of the view, or for one that was removed, that of its submap which is nearest in time; nothing for a
/// removed submap.
std::optional<KeyFrameId> reference_of(const KeptView& view, const Map& map) {
  if (map.find_keyframe(view.keyframe) != nullptr) return view.keyframe;
  const auto submap = map.submap_of(view.keyframe);
  std::optional<KeyFrameId> nearest;
  double smallest = std::numeric_limits<double>::infinity();
  for (const KeyFrameId id : map.keyframes_by_age()) {
    const KeyFrame& keyframe = map.keyframe(id);
    const double gap = std::abs(keyframe.frame.timestamp - view.timestamp);
    if (submap && keyframe.submap == *submap && gap < smallest) nearest = id, smallest = gap;
  }
  return nearest;
}

std::string text_of(const fs::path& file) {
  std::string text;
  InputFile(file, largest_file::json,
            "the views that a run with surface.keep_depth=true leaves beside its map; run again with it, or name the "
            "folder of the views")
      .read_rest(text);
  return text;
}

/// Reads the images of views by the size of their camera.
class ViewReader {
 public:
  ViewReader(fs::path folder, const Map& map) : folder_(std::move(folder)) {
    map.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
      keyframes_.emplace(std::pair{keyframe.sequence, keyframe.frame.timestamp}, id);
    });
  }

  void read(const json& list, SurfaceViews& result) {
    result.camera = pinhole_of(list.at("camera"));
    result.settings = settings_of(list.at("settings"));
    if (list.contains("carving_camera"))
      coarse_camera_ = std::make_shared<const Camera>(pinhole_of(list.at("carving_camera")));
    if (list.contains("classes")) list.at("classes").get_to(result.classes);
    std::optional<std::uint64_t> last;
    for (const json& entry : list.at("views")) {
      const auto frame = entry.at("frame").get<std::uint64_t>();
      if (last && frame <= *last) throw Error("found frame " + std::to_string(frame) + " out of order");
      last = frame;
      const auto keyframe =
          keyframes_.find({entry.at("keyframe").get<std::uint64_t>(), entry.at("keyframe_timestamp").get<double>()});
      if (keyframe != keyframes_.end())
        result.views.push_back(view_of(entry, keyframe->second, result.camera));
      else
        ++result.left_out;
    }
    if (result.views.empty())
      throw Error("none of its keyframes is in the map; expected the views of the run that made the map");
  }

 private:
  KeptView view_of(const json& entry, KeyFrameId keyframe, const Camera& camera) {
    KeptView view;
    view.keyframe = keyframe;
    view.frame_index = entry.at("frame");
    view.timestamp = entry.at("timestamp");
    view.T_view_keyframe = pose_of(entry.at("T_view_keyframe"));
    if (entry.at("carves").get<bool>()) view.coarse_camera = coarse_camera_;
    if (entry.at("carves").get<bool>() && !coarse_camera_) throw Error("found no 'carving_camera'");
    const Camera& own = view.only_carves() ? *view.coarse_camera : camera;
    const auto check_size = [&](const cv::Size& size) {
      if (size != cv::Size(own.width, own.height))
        throw Error("frame " + std::to_string(view.frame_index) + ": found an image of " + std::to_string(size.width) +
                    "x" + std::to_string(size.height) + ", expected " + std::to_string(own.width) + "x" +
                    std::to_string(own.height));
    };
    decoder_.read_depth(image_file(folder_, "depth", view.frame_index), 1.0, check_size).convertTo(view.depth, CV_16U);
    if (!view.only_carves())
      view.colour = decoder_.read_colour(image_file(folder_, "colour", view.frame_index), check_size).clone();
    if (entry.value("has_labels", false)) view.labels = labels_of(view.frame_index, check_size);
    return view;
  }

  cv::Mat labels_of(std::uint64_t frame, const ImageDecoder::SizeCheck& check_size) {
    const fs::path file = image_file(folder_, "labels", frame);
    cv::Mat labels = decoder_.read_labels(file, check_size).clone();
    if (labels.type() != CV_8UC1) throw InputError({file.string()}, "found labels of 16 bits; expected 8 bits");
    return labels;
  }

  fs::path folder_;
  std::map<std::pair<std::uint64_t, double>, KeyFrameId> keyframes_;
  std::shared_ptr<const Camera> coarse_camera_;
  ImageDecoder decoder_;
};

}  // namespace

SurfaceViews SurfaceViews::of(const SurfaceMap& surface) {
  SurfaceViews result{surface.camera(), surface.field().settings(), {}, 0};
  for (std::size_t i = 0; i < surface.view_count(); ++i) result.views.push_back(surface.view(i));
  return result;
}

void SurfaceViews::append(SurfaceViews later) {
  const auto values = [](const Camera& c) {
    return std::array{static_cast<double>(c.width), static_cast<double>(c.height), c.fx, c.fy, c.cx, c.cy};
  };
  if (values(camera) != values(later.camera))
    throw Error("views of different cameras, or of different dense_map.step, cannot be fused into one surface; found " +
                std::to_string(camera.width) + "x" + std::to_string(camera.height) + ", fx " +
                std::to_string(camera.fx) + ", and " + std::to_string(later.camera.width) + "x" +
                std::to_string(later.camera.height) + ", fx " + std::to_string(later.camera.fx));
  if (!classes.empty() && !later.classes.empty() && classes != later.classes)
    throw Error("views with different classes cannot be fused into one surface; found those of different segmenters");
  if (classes.empty()) classes = std::move(later.classes);
  const std::uint64_t first = views.empty() ? 0 : views.back().frame_index + 1;
  for (KeptView& view : later.views) {
    view.frame_index += first;
    views.push_back(std::move(view));
  }
  left_out += later.left_out;
}

void write_views(const fs::path& folder, const SurfaceViews& views, const Map& map) {
  const bool has_labels =
      std::any_of(views.views.begin(), views.views.end(), [](const KeptView& view) { return !view.labels.empty(); });
  for (const char* kind : {"colour", "depth", "labels"}) {
    if (!has_labels && kind == std::string("labels")) continue;
    std::error_code error;
    fs::create_directories(folder / kind, error);
    if (error) throw InputError({(folder / kind).string()}, "the folder cannot be made: " + error.message());
  }
  json list = {{"version", views_version},
               {"camera", pinhole_json(views.camera)},
               {"settings", settings_json(views.settings)},
               {"views", json::array()}};
  for (const KeptView& view : views.views) {
    const std::optional<KeyFrameId> reference = reference_of(view, map);
    if (!reference) continue;
    const KeyFrame& keyframe = map.keyframe(*reference);
    const Eigen::Isometry3d T_view_keyframe =
        *reference == view.keyframe
            ? view.T_view_keyframe
            : view.T_view_keyframe * map.pose_of(view.keyframe) * map.pose_of(*reference).inverse();
    list["views"].push_back({{"frame", view.frame_index},
                             {"timestamp", view.timestamp},
                             {"keyframe", keyframe.sequence},
                             {"keyframe_timestamp", keyframe.frame.timestamp},
                             {"T_view_keyframe", pose_json(T_view_keyframe)},
                             {"carves", view.only_carves()}});
    if (view.only_carves()) list["carving_camera"] = pinhole_json(*view.coarse_camera);
    write_png(image_file(folder, "depth", view.frame_index), view.depth);
    if (!view.only_carves()) write_png(image_file(folder, "colour", view.frame_index), view.colour);
    if (view.labels.empty()) continue;
    list["views"].back()["has_labels"] = true;
    write_png(image_file(folder, "labels", view.frame_index), view.labels);
  }
  if (!views.classes.empty()) list["classes"] = views.classes;
  sync_file_system(folder);
  write_file_atomically(folder / views_list, list.dump(1) + "\n");
}

SurfaceViews read_views(const fs::path& folder, const Map& map) {
  const fs::path file = folder / views_list;
  const std::string text = text_of(file);
  SurfaceViews result;
  try {
    const json list = json::parse(text);
    if (list.at("version") != views_version) throw Error("found a version that this program does not know");
    ViewReader(folder, map).read(list, result);
  } catch (const InputError&) {
    throw;  // an image
  } catch (const Error& error) {
    throw InputError({file.string()}, error.what());
  } catch (const json::exception& error) {
    throw InputError({file.string()}, std::string("is damaged: ") + error.what());
  }
  return result;
}

TriangleMesh fuse(const SurfaceViews& views, const Map& map, const std::function<void(std::size_t)>& on_progress) {
  constexpr std::size_t step = 8;
  SurfaceMap surface(views.camera, views.settings);
  std::vector<KeptView> fused;
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < views.views.size();) {
    for (const std::size_t end = std::min(i + step, views.views.size()); i < end; ++i) {
      fused.push_back(views.views[i]);
      poses.push_back(fused.back().T_world_view(map.pose_of(fused.back().keyframe)));
    }
    surface.update(fused, poses, 0);
    on_progress(i);
  }
  TriangleMesh mesh = surface.field().mesh();
  mesh.classes = views.classes;
  return mesh;
}

}  // namespace holdfast

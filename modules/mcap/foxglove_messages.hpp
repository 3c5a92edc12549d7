// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/frame_health.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map_snapshot.hpp"

namespace holdfast::mcap {

using Json = nlohmann::ordered_json;

/// Coordinate frames of the messages. `map`: x forwards, y left, z up as in REP 105, if the first view was level.
/// `world`: the frame of Holdfast's poses. `camera`: x right, y down, z forwards.
inline constexpr const char *map_frame = "map", *world_frame = "world", *camera_frame = "camera";

/// Shapes of a scene entity that are always empty here; readers expect the fields.
inline constexpr const char* unused_shapes[] = {"spheres", "cylinders", "lines", "triangles", "models"};

/// The messages of Foxglove's schemas (docs.foxglove.dev/docs/visualization/message-schemas) in JSON. Times in seconds.
Json pose_message(double time, const Eigen::Isometry3d& T_world_camera);
Json transform_message(double time, const char* parent, const char* child, const Eigen::Isometry3d& T_parent_child);
Json path_message(double time, const std::vector<MapSnapshot::KeyFrame>& keyframes);
/// Map points that are more likely static than moving.
Json cloud_message(double time, const std::vector<MapSnapshot::Point>& points);
/// The image as JPEG.
Json image_message(double time, const cv::Mat& image, int quality);
/// Cells of the view as a grey PNG: 255 = moving by the filters, 128 = an object by the mask, 0 = static or unknown.
Json moving_message(double time, const CoarseView& view);
/// Boxes, velocities (as arrows of one second) and names of moving objects.
Json objects_message(double time, const std::vector<MovingObject>& objects);
/// The calibration of the raw images.
Json calibration_message(double time, const Camera& camera);
/// A sentence about the health of a frame, for panels of logs.
Json log_message(double time, const FrameHealth& health);
/// Schema `holdfast.FrameStatus`.
Json status_message(const FrameResult& result);

/// The JSON Schema document of one of the schemas above, such as "foxglove.PoseInFrame".
std::string schema_document(const std::string& name);

}  // namespace holdfast::mcap

// SPDX-License-Identifier: BSD-3-Clause
#include <initializer_list>

#include "foxglove_messages.hpp"

namespace holdfast::mcap {

namespace {

Json type(const char* name) { return {{"type", name}}; }

Json object(Json properties) { return {{"type", "object"}, {"properties", std::move(properties)}}; }

Json list(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

Json time_schema() { return object({{"sec", type("integer")}, {"nsec", type("integer")}}); }

Json numbers_schema(std::initializer_list<const char*> names) {
  Json properties = Json::object();
  for (const char* name : names) properties[name] = type("number");
  return object(properties);
}

Json pose_schema() {
  return object({{"position", numbers_schema({"x", "y", "z"})}, {"orientation", numbers_schema({"x", "y", "z", "w"})}});
}

Json data_schema() { return {{"type", "string"}, {"contentEncoding", "base64"}}; }

Json entity_schema() {
  const Json colour = numbers_schema({"r", "g", "b", "a"});
  Json properties = {{"timestamp", time_schema()},
                     {"frame_id", type("string")},
                     {"id", type("string")},
                     {"lifetime", time_schema()},
                     {"frame_locked", type("boolean")},
                     {"metadata", list(object({{"key", type("string")}, {"value", type("string")}}))}};
  properties["arrows"] = list(object({{"pose", pose_schema()},
                                      {"shaft_length", type("number")},
                                      {"shaft_diameter", type("number")},
                                      {"head_length", type("number")},
                                      {"head_diameter", type("number")},
                                      {"color", colour}}));
  properties["cubes"] =
      list(object({{"pose", pose_schema()}, {"size", numbers_schema({"x", "y", "z"})}, {"color", colour}}));
  properties["texts"] = list(object({{"pose", pose_schema()},
                                     {"billboard", type("boolean")},
                                     {"font_size", type("number")},
                                     {"scale_invariant", type("boolean")},
                                     {"color", colour},
                                     {"text", type("string")}}));
  for (const char* unused : unused_shapes) properties[unused] = list(type("object"));
  return object(properties);
}

Json properties_of(const std::string& name) {
  const Json head = {{"timestamp", time_schema()}, {"frame_id", type("string")}};
  const auto with = [&](const Json& more) {
    Json all = head;
    all.update(more);
    return all;
  };
  if (name == "foxglove.PoseInFrame") return with({{"pose", pose_schema()}});
  if (name == "foxglove.PosesInFrame") return with({{"poses", list(pose_schema())}});
  if (name == "foxglove.CompressedImage") return with({{"data", data_schema()}, {"format", type("string")}});
  if (name == "foxglove.PointCloud")
    return with(
        {{"pose", pose_schema()},
         {"point_stride", type("integer")},
         {"fields", list(object({{"name", type("string")}, {"offset", type("integer")}, {"type", type("integer")}}))},
         {"data", data_schema()}});
  if (name == "foxglove.FrameTransform")
    return {{"timestamp", time_schema()},
            {"parent_frame_id", type("string")},
            {"child_frame_id", type("string")},
            {"translation", numbers_schema({"x", "y", "z"})},
            {"rotation", numbers_schema({"x", "y", "z", "w"})}};
  if (name == "foxglove.CameraCalibration")
    return with({{"width", type("integer")},
                 {"height", type("integer")},
                 {"distortion_model", type("string")},
                 {"D", list(type("number"))},
                 {"K", list(type("number"))},
                 {"R", list(type("number"))},
                 {"P", list(type("number"))}});
  if (name == "foxglove.Log")
    return {{"timestamp", time_schema()}, {"level", type("integer")}, {"message", type("string")},
            {"name", type("string")},     {"file", type("string")},   {"line", type("integer")}};
  if (name == "foxglove.SceneUpdate")
    return {
        {"deletions", list(object({{"timestamp", time_schema()}, {"type", type("integer")}, {"id", type("string")}}))},
        {"entities", list(entity_schema())}};
  Json status = {{"timestamp", time_schema()}, {"index", type("integer")}};
  for (const char* text : {"health", "status", "method", "fallback", "failure"}) status[text] = type("string");
  for (const char* number : {"features", "static_features", "matches", "inliers"}) status[number] = type("integer");
  status["reasons"] = list(type("string"));
  status["covariance"] = list(type("number"));
  status["jump"] = type("number");
  status["is_keyframe"] = type("boolean");
  status["tracking_ms"] = type("number");
  return status;
}

}  // namespace

std::string schema_document(const std::string& name) {
  Json document = {{"title", name}};
  document.update(object(properties_of(name)));
  return document.dump();
}

}  // namespace holdfast::mcap

// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <cmath>

#include "records.hpp"

namespace holdfast::map_io {

namespace {

constexpr double largest_position = 1e9;     // [m] from the origin; beyond it single precision has lost the room
constexpr float largest_pixel = 1e6F;        // [px]
constexpr double largest_image = 16384.0;    // [px]
constexpr double largest_scale = 1e6;        // between the finest and the coarsest level
constexpr double rotation_tolerance = 1e-4;  // |R^T R - I|

std::string number(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof(text), value);
  return {text, end};
}

std::string wrong(const std::string& what, double found, const std::string& expected) {
  return what + " is " + number(found) + "; expected " + expected;
}

bool within(double value, double minimum, double maximum) { return value >= minimum && value <= maximum; }

std::string trouble_of_rotation(const Eigen::Matrix3d& rotation, const std::string& of) {
  const double error = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= rotation_tolerance)) return wrong("departure of " + of + " from a rotation", error, "at most 1e-4");
  if (!(rotation.determinant() > 0)) return wrong("determinant of the rotation", rotation.determinant(), "1");
  return "";
}

}  // namespace

std::string trouble_of_numbers(const Camera& camera) {
  const std::string size_text = "1 to " + number(largest_image) + " px";
  if (!within(camera.width, 1, largest_image)) return wrong("width", camera.width, size_text);
  if (!within(camera.height, 1, largest_image)) return wrong("height", camera.height, size_text);
  for (const double focal : {camera.fx, camera.fy})
    if (!within(focal, 1e-3, 1e6)) return wrong("focal length", focal, "0.001 to 1e6 px");
  for (const double centre : {camera.cx, camera.cy})
    if (!within(centre, -1e6, 1e6)) return wrong("principal point", centre, "-1e6 to 1e6 px");
  const Distortion& d = camera.distortion;
  for (const double value : {d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6})
    if (!within(value, -1e6, 1e6)) return wrong("distortion", value, "-1e6 to 1e6");
  if (!within(camera.baseline, 0, 1e6)) return wrong("baseline", camera.baseline, "0 to 1e6 m");
  if (!within(camera.frame_rate, 0, 1e6)) return wrong("frame rate", camera.frame_rate, "0 to 1e6 per second");
  if (camera.name.size() > 255) return wrong("length of the name", static_cast<double>(camera.name.size()), "0 to 255");
  for (const char letter : camera.name)
    if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F) return "the name holds a control character";
  return "";
}

std::string trouble_of(const Camera& camera) {
  if (std::string trouble = trouble_of_numbers(camera); !trouble.empty()) return trouble;
  if (std::string trouble = camera.trouble(); !trouble.empty()) return trouble;
  // The feature grid has the size of the undistorted image.
  Eigen::Vector2d minimum, maximum;
  camera.undistorted_bounds(minimum, maximum);
  for (const double bound : {minimum.x(), minimum.y(), maximum.x(), maximum.y()})
    if (!within(bound, -largest_image, 2 * largest_image))
      return wrong("border of the undistorted image", bound, "a distortion that fits the image");
  return "";
}

std::string trouble_of(const ScalePyramid& pyramid) {
  if (!within(pyramid.levels(), 1, 64)) return wrong("number of levels", pyramid.levels(), "1 to 64");
  if (!(pyramid.factor > 1.0 && std::pow(pyramid.factor, pyramid.levels() - 1) <= largest_scale))
    return wrong("factor between levels", pyramid.factor, "more than 1, and a last level of at most 1e6");
  return "";
}

std::string trouble_of(const KeyFrame& keyframe) {
  const Frame& frame = keyframe.frame;
  if (!std::isfinite(frame.timestamp)) return wrong("time stamp", frame.timestamp, "a finite number of seconds");
  const Eigen::Vector3d translation = frame.T_camera_world.translation();
  for (int i = 0; i < 3; ++i)
    if (!within(translation[i], -largest_position, largest_position))
      return wrong("translation of the pose", translation[i], "-1e9 to 1e9 m");
  if (std::string trouble = trouble_of_rotation(frame.T_camera_world.linear(), "the pose"); !trouble.empty())
    return trouble;
  for (const CovisibilityEdge& edge : keyframe.covisible)
    if (edge.weight < 1) return wrong("weight of a covisibility edge", edge.weight, "at least 1");
  return "";
}

std::string trouble_of_features(const Frame& frame) {
  const Features& f = frame.features;
  const std::size_t count = frame.size();
  for (const std::size_t size : {f.y.size(), f.angle.size(), f.response.size(), f.octave.size(), f.descriptors.size(),
                                 frame.x.size(), frame.y.size(), frame.depth.size(), frame.right_x.size(),
                                 frame.map_points.size(), frame.static_probability.size()})
    if (size != count) return wrong("length of an array of features", static_cast<double>(size), std::to_string(count));
  const auto check = [&](const std::vector<float>& values, const char* what, float minimum, float maximum,
                         bool may_be_nan, const char* expected) -> std::string {
    for (std::size_t i = 0; i < count; ++i)
      if (!within(values[i], minimum, maximum) && !(may_be_nan && std::isnan(values[i])))
        return "feature " + std::to_string(i) + ": " + wrong(what, values[i], expected);
    return "";
  };
  constexpr float most = 3.4e38F;
  for (const auto& [values, what] : {std::pair{&f.x, "raw column"}, std::pair{&f.y, "raw row"},
                                     std::pair{&frame.x, "column"}, std::pair{&frame.y, "row"}})
    if (std::string text = check(*values, what, -largest_pixel, largest_pixel, false, "-1e6 to 1e6 px"); !text.empty())
      return text;
  // Close to the camera the right column lies far outside the image.
  std::string text = check(frame.right_x, "right column", -most, most, true, "a finite number or NaN");
  if (text.empty()) text = check(frame.depth, "depth", 0, most, false, "0 or a finite depth");
  if (text.empty()) text = check(f.angle, "angle", -100, 100, false, "radians");
  if (text.empty()) text = check(f.response, "response", -most, most, false, "a finite number");
  if (text.empty()) text = check(frame.static_probability, "static probability", 0, 1, false, "0 to 1");
  for (std::size_t i = 0; i < count && text.empty(); ++i)
    if (f.octave[i] >= frame.pyramid->levels())
      text = "feature " + std::to_string(i) + ": " +
             wrong("octave", f.octave[i], "less than " + std::to_string(frame.pyramid->levels()));
  if (f.descriptors.type().kind != DescriptorKind::float32) return text;
  const DescriptorView descriptors = f.descriptors;
  for (std::size_t i = 0; i < count && text.empty(); ++i) {
    const auto* numbers = reinterpret_cast<const float*>(descriptors.row(i));
    for (std::uint32_t k = 0; k < descriptors.type().length && text.empty(); ++k)
      if (!std::isfinite(numbers[k]))
        text = "feature " + std::to_string(i) + ": " + wrong("number of the descriptor", numbers[k], "a finite number");
  }
  return text;
}

std::string trouble_of(const MapPoint& point) {
  for (int i = 0; i < 3; ++i) {
    if (!within(point.position[i], -largest_position, largest_position))
      return wrong("position", point.position[i], "-1e9 to 1e9 m");
    if (!within(point.viewing_direction[i], -1.001, 1.001))
      return wrong("viewing direction", point.viewing_direction[i], "-1 to 1");
  }
  for (const float distance : {point.minimum_distance, point.maximum_distance})
    if (!within(distance, 0, 1e15)) return wrong("distance", distance, "0 to 1e15 m");
  if (!std::isfinite(point.static_log_odds)) return wrong("evidence", point.static_log_odds, "finite log odds");
  if (point.visible_count < 1) return wrong("visible count", point.visible_count, "at least 1");
  if (point.observations.empty()) return wrong("number of observations", 0, "at least 1");
  return "";
}

std::string trouble_of_motion(const KeyFrame& keyframe) {
  if (keyframe.vertical && !within(keyframe.vertical->norm(), 0.999, 1.001))
    return wrong("length of the vertical", keyframe.vertical->norm(), "1");
  if (!keyframe.motion || keyframe.motion->is_possible()) return "";
  const auto& [velocity, bias] = *keyframe.motion;
  if (!within(velocity.norm(), 0, 1e9)) return wrong("speed", velocity.norm(), "0 to 1e9");
  return wrong("larger bias", std::max(bias.gyroscope.norm(), bias.accelerometer.norm()), "0 to 100");
}

std::string trouble_of(const MapInertia& inertia) {
  if (!within(inertia.gravity.norm(), 1.0, 100.0))
    return wrong("magnitude of gravity", inertia.gravity.norm(), "1 to 100 m/s^2");
  if (!within(inertia.scale, 1e-6, 1e6)) return wrong("scale", inertia.scale, "1e-6 to 1e6");
  const auto of_bias = [](const Eigen::Vector3d& bias) { return within(bias.norm(), 0, 100); };
  if (!of_bias(inertia.bias.gyroscope) || !of_bias(inertia.bias.accelerometer)) return "a bias is not within 100";
  for (const double offset : {inertia.time_offset, inertia.calibrated_time_offset})
    if (!within(offset, -10, 10)) return wrong("time offset", offset, "-10 to 10 s");
  for (const double deviation : {inertia.gravity_deviation, inertia.gyroscope_deviation,
                                 inertia.accelerometer_deviation, inertia.mounting_deviation,
                                 inertia.time_offset_deviation, inertia.position_deviation, inertia.rotation_deviation})
    if (!within(deviation, 0, 100)) return wrong("standard deviation", deviation, "0 to 100");
  if (!within(inertia.T_body_camera.translation().norm(), 0, 100))
    return "T_body_camera has a translation of more than 100 m";
  std::string trouble = trouble_of_rotation(inertia.mounting, "the correction of T_body_camera");
  return trouble.empty() ? trouble_of_rotation(inertia.T_body_camera.linear(), "T_body_camera") : trouble;
}

}  // namespace holdfast::map_io

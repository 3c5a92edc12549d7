// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/camera_file.hpp"

#include <array>
#include <set>
#include <string>

#include "holdfast/plugin/did_you_mean.hpp"
#include "yaml_numbers.hpp"

namespace holdfast {

namespace {

using yaml_numbers::location;

constexpr const char* expected_keys =
    "fx, fy, cx, cy, width, height, and optionally k1 to k6, p1, p2, lens, baseline, name, right";
constexpr const char* expected_right_keys =
    "fx, fy, cx, cy, width, height, T_left_right, and optionally k1 to k6, p1, p2, lens, name";

struct NumberKey {
  const char* name;
  double Camera::*member;
  double Distortion::*distortion_member;
  bool positive;
};

constexpr std::array<NumberKey, 13> number_keys = {{
    {"fx", &Camera::fx, nullptr, true},
    {"fy", &Camera::fy, nullptr, true},
    {"cx", &Camera::cx, nullptr, false},
    {"cy", &Camera::cy, nullptr, false},
    {"k1", nullptr, &Distortion::k1, false},
    {"k2", nullptr, &Distortion::k2, false},
    {"p1", nullptr, &Distortion::p1, false},
    {"p2", nullptr, &Distortion::p2, false},
    {"k3", nullptr, &Distortion::k3, false},
    {"k4", nullptr, &Distortion::k4, false},
    {"k5", nullptr, &Distortion::k5, false},
    {"k6", nullptr, &Distortion::k6, false},
    {"baseline", &Camera::baseline, nullptr, true},
}};

/// Reads one map of keys.
class CameraReader {
 public:
  CameraReader(const std::filesystem::path& file, const YAML::Node& node, Camera camera, bool is_right)
      : file_(file), node_(node), is_right_(is_right), camera_(std::move(camera)) {}

  Camera read() {
    if (!node_.IsMap())
      throw InputError(location(file_, node_.Mark()), std::string("holds no keys; expected ") + keys());
    camera_.distortion = {};
    std::set<std::string> seen;
    for (const auto& entry : node_) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : std::string();
      const SourceLocation place = location(file_, entry.first.Mark());
      if (!seen.insert(key).second) throw InputError(place, "key '" + key + "' is given twice; take one of them out");
      if (!read_entry(key, entry.second)) throw InputError(place, "unknown key '" + key + "'; expected " + keys());
    }
    std::string missing;
    for (const char* key : {"fx", "fy", "cx", "cy", "width", "height", "T_left_right"})
      if ((is_right_ || key != std::string("T_left_right")) && !seen.contains(key))
        missing += (missing.empty() ? "" : ", ") + std::string(key);
    if (!missing.empty())
      throw InputError(is_right_ ? location(file_, node_.Mark()) : SourceLocation{file_.string()},
                       "lacks " + missing + "; expected " + keys());
    if (const std::string trouble = camera_.trouble(); !trouble.empty())
      throw InputError(location(file_, node_[seen.contains("lens") ? "lens" : "k1"].Mark()), trouble);
    return camera_;
  }

  const Eigen::Isometry3d& T_left_right() const { return T_left_right_; }
  /// The node of the right camera, if there is one.
  const std::optional<YAML::Node>& right() const { return right_; }

 private:
  const char* keys() const { return is_right_ ? expected_right_keys : expected_keys; }

  /// False for a key that is not known.
  bool read_entry(const std::string& key, const YAML::Node& value) {
    for (const NumberKey& number_key : number_keys) {
      if (key != number_key.name || (is_right_ && number_key.member == &Camera::baseline)) continue;
      const double number = yaml_numbers::number(file_, value, key, number_key.positive);
      if (number_key.member != nullptr)
        camera_.*number_key.member = number;
      else
        camera_.distortion.*number_key.distortion_member = number;
      return true;
    }
    if (key == "width")
      camera_.width = yaml_numbers::size(file_, value, key);
    else if (key == "height")
      camera_.height = yaml_numbers::size(file_, value, key);
    else if (key == "name" && value.IsScalar())
      camera_.name = value.Scalar();
    else if (key == "lens")
      camera_.distortion.lens = read_lens(value);
    else if (key == "T_left_right" && is_right_)
      read_pose(value);
    else if (key == "right" && !is_right_)
      right_ = value;
    else
      return false;
    return true;
  }

  Lens read_lens(const YAML::Node& value) const {
    const std::string name = value.IsScalar() ? value.Scalar() : "";
    if (const std::optional<Lens> lens = find_lens(name)) return *lens;
    throw InputError(location(file_, value.Mark()),
                     "found '" + name + "' for lens; " + did_you_mean(name, lens_names()));
  }

  void read_pose(const YAML::Node& value) {
    std::vector<double> numbers;
    const bool has_rows = value.IsSequence() && value.size() > 0 && value[0].IsSequence();
    if (!has_rows) numbers = yaml_numbers::numbers(file_, value, "T_left_right", {16});
    for (std::size_t row = 0; has_rows && row < value.size(); ++row)
      for (const double number : yaml_numbers::numbers(file_, value[row], "a row of T_left_right", {4}))
        numbers.push_back(number);
    std::optional<Eigen::Isometry3d> motion;
    if (numbers.size() == 16) motion = yaml_numbers::rigid_motion(numbers);
    if (!motion)
      throw InputError(location(file_, value.Mark()),
                       "found a matrix for T_left_right that is not a rigid motion; expected the four rows of a "
                       "rotation with a translation [m], the last one 0 0 0 1");
    T_left_right_ = *motion;
  }

  const std::filesystem::path& file_;
  YAML::Node node_;
  bool is_right_;
  Camera camera_;
  Eigen::Isometry3d T_left_right_ = Eigen::Isometry3d::Identity();
  std::optional<YAML::Node> right_;
};

}  // namespace

CameraFile read_camera_file(const std::filesystem::path& file, const Camera& defaults, const std::string& setting) {
  const YAML::Node root = yaml_numbers::load(
      file, std::string("a YAML or JSON file with ") + expected_keys + "; correct `" + setting + "`");
  Camera camera = defaults;
  camera.name = file.filename().string();
  CameraReader reader(file, root, camera, false);
  CameraFile result;
  result.camera = reader.read();
  if (!reader.right()) return result;
  CameraReader right(file, *reader.right(), result.camera, true);
  StereoCameras pair;
  pair.left = result.camera;
  pair.right = right.read();
  pair.T_left_right = right.T_left_right();
  result.pair = pair;
  return result;
}

}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#include "coco_masks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/size_text.hpp"
#include "label_files.hpp"

namespace holdfast::precomputed_plugin {

namespace {

using Json = nlohmann::json;

constexpr int most_side = 16384;
constexpr const char* expected_file =
    "; expected the JSON of COCO's instances: an object with `images`, `annotations` and `categories`";

/// Reads the parts of a file; see read_coco().
class CocoReader {
 public:
  explicit CocoReader(const std::filesystem::path& file) : file_(file) {}

  CocoFile read(const Json& json) {
    for (const char* name : {"images", "annotations", "categories"})
      if (!json.is_object() || !json.contains(name) || !json[name].is_array())
        fail(std::string("has no list `") + name + "`" + expected_file);
    for (const Json& category : json["categories"]) {
      const int number = whole(category, "id", "a category", 65535);
      names_[number] = text(category, "name", "a category");
    }
    for (const Json& image : json["images"]) read_image(image);
    for (const Json& annotation : json["annotations"]) read_annotation(annotation);
    CocoFile result{std::move(images_), {}};
    std::stable_sort(result.images.begin(), result.images.end(),
                     [](const CocoImage& a, const CocoImage& b) { return a.timestamp < b.timestamp; });
    for (std::size_t i = 1; i < result.images.size(); ++i)
      if (result.images[i].timestamp == result.images[i - 1].timestamp)
        fail("has two images of the time stamp " + std::to_string(result.images[i].timestamp) +
             "; expected one of each");
    for (const auto& [number, name] : names_) result.categories.emplace_back(std::to_string(number), name);
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError({file_.string()}, message); }

  int whole(const Json& object, const char* name, const char* what, int most) const {
    if (object.is_object() && object.contains(name) && object[name].is_number_integer())
      if (const auto value = object[name].get<std::int64_t>(); value >= 0 && value <= most)
        return static_cast<int>(value);
    fail(std::string("has ") + what + " without `" + name + "`, a whole number from 0 to " + std::to_string(most) +
         expected_file);
  }
  std::string text(const Json& object, const char* name, const char* what) const {
    if (object.is_object() && object.contains(name) && object[name].is_string()) return object[name].get<std::string>();
    fail(std::string("has ") + what + " without `" + name + "`, a text" + expected_file);
  }

  void read_image(const Json& image) {
    const std::string name = text(image, "file_name", "an image");
    const std::optional<double> stamp = stamp_of(std::filesystem::path(name).stem().string());
    if (!stamp)
      fail("has an image '" + name + "', which is no time stamp; expected names such as 1305031102.175304.png");
    const int number = whole(image, "id", "an image", 2147483647);
    if (!number_.emplace(number, images_.size()).second)
      fail("has two images with the `id` " + std::to_string(number) + "; expected different ones");
    const cv::Size size(whole(image, "width", "an image", most_side), whole(image, "height", "an image", most_side));
    images_.push_back({*stamp, size, {}});
  }

  void read_annotation(const Json& annotation) {
    const int number = whole(annotation, "image_id", "an annotation", 2147483647);
    const auto image = number_.find(number);
    if (image == number_.end())
      fail("has an annotation of the image " + std::to_string(number) + ", which is not in `images`");
    CocoObject object;
    object.category = whole(annotation, "category_id", "an annotation", 65535);
    if (!names_.contains(object.category))
      fail("has an annotation of the category " + std::to_string(object.category) + ", which is not in `categories`");
    if (annotation.contains("score") && annotation["score"].is_number())
      object.score = std::clamp(annotation["score"].get<float>(), 0.0F, 1.0F);
    object.is_crowd = annotation.contains("iscrowd") && annotation["iscrowd"] == 1;
    if (!annotation.contains("segmentation")) return;  // a box alone is no mask
    read_mask(annotation["segmentation"], images_[image->second].size, object);
    images_[image->second].objects.push_back(std::move(object));
  }

  void read_mask(const Json& mask, const cv::Size& size, CocoObject& object) const {
    if (mask.is_array()) {
      for (const Json& polygon : mask) object.polygons.push_back(polygon_of(polygon));
      return;
    }
    if (!mask.is_object() || !mask.contains("counts") || !mask.contains("size"))
      fail(std::string("has a `segmentation` that is neither polygons nor run lengths") + expected_file);
    if (mask["size"] != Json::array({size.height, size.width}))
      fail("has run lengths of the size " + mask["size"].dump() + "; expected " +
           Json::array({size.height, size.width}).dump() + ", height and width of the image");
    if (mask["counts"].is_string())
      object.runs = decode_runs(mask["counts"].get<std::string>());
    else if (mask["counts"].is_array())
      for (const Json& count : mask["counts"])
        object.runs.push_back(count.is_number_unsigned() && count <= 0x7FFFFFFF ? count.get<std::uint32_t>()
                                                                                : 0xFFFFFFFF);
    std::uint64_t sum = 0;
    for (const std::uint32_t run : object.runs) sum += run;
    if (object.runs.empty() || sum != static_cast<std::uint64_t>(size.area()))
      fail("has run lengths of " + std::to_string(sum) + " pixels; expected " + std::to_string(size.area()) + ", " +
           size_text(size.width, size.height) + ", in `counts`");
  }

  std::vector<double> polygon_of(const Json& polygon) const {
    std::vector<double> numbers;
    if (polygon.is_array())
      for (const Json& number : polygon) numbers.push_back(number.is_number() ? number.get<double>() : std::nan(""));
    const bool is_sound =
        numbers.size() % 2 == 0 && numbers.size() >= 6 &&
        std::all_of(numbers.begin(), numbers.end(), [](double number) { return std::abs(number) <= 2.0 * most_side; });
    if (!is_sound)
      fail("has a polygon of " + std::to_string(numbers.size()) +
           " numbers; expected x, y of at least three corners, in pixels");
    return numbers;
  }

  const std::filesystem::path& file_;
  std::map<int, std::string> names_;   // of categories
  std::map<int, std::size_t> number_;  // of images, by id
  std::vector<CocoImage> images_;
};

}  // namespace

CocoFile read_coco(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  InputFile(file, largest_file::json, "annotations in the JSON of COCO").read_rest(bytes);
  const Json json = Json::parse(bytes.begin(), bytes.end(), nullptr, false);
  if (json.is_discarded()) throw InputError({file.string()}, std::string("is no JSON") + expected_file);
  return CocoReader(file).read(json);
}

std::vector<std::uint32_t> decode_runs(const std::string& text) {
  std::vector<std::uint32_t> runs;
  constexpr int bits = 5, most_groups = 7;
  for (std::size_t at = 0; at < text.size();) {
    std::int64_t value = 0;
    int groups = 0;
    bool goes_on = true;
    for (; goes_on; ++groups, ++at) {
      if (at == text.size() || groups == most_groups || text[at] < '0' || text[at] > 'o') return {};
      const int character = text[at] - '0';
      value |= std::int64_t{character & 0x1F} << (bits * groups);
      goes_on = (character & 0x20) != 0;
      if (!goes_on && (character & 0x10) != 0) value -= std::int64_t{1} << (bits * (groups + 1));  // negative
    }
    if (runs.size() > 2) value += runs[runs.size() - 2];
    if (value < 0 || value > 0x7FFFFFFF) return {};
    runs.push_back(static_cast<std::uint32_t>(value));
  }
  return runs;
}

cv::Mat mask_of(const CocoObject& object, const cv::Size& size) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  std::int64_t at = 0;
  for (std::size_t i = 0; i < object.runs.size(); at += object.runs[i++])
    if (i % 2 == 1)
      for (std::int64_t pixel = at; pixel < at + object.runs[i]; ++pixel)
        mask.at<std::uint8_t>(static_cast<int>(pixel % size.height), static_cast<int>(pixel / size.height)) = 255;
  constexpr int shift = 4;
  std::vector<std::vector<cv::Point>> outlines;
  for (const std::vector<double>& polygon : object.polygons) {
    std::vector<cv::Point>& outline = outlines.emplace_back();
    const auto place = [](double value) { return static_cast<int>(std::lround((value - 0.5) * (1 << shift))); };
    for (std::size_t i = 0; i + 1 < polygon.size(); i += 2)
      outline.emplace_back(place(polygon[i]), place(polygon[i + 1]));
  }
  for (const std::vector<cv::Point>& outline : outlines)
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{outline}, cv::Scalar(255), cv::LINE_8, shift);
  return mask;
}

}  // namespace holdfast::precomputed_plugin

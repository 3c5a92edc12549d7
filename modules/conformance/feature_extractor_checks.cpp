// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "check.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "scene.hpp"

namespace holdfast::conformance {

namespace {

const char* const extractor_header = "holdfast/interfaces/feature_extractor.hpp";
const char* const features_header = "holdfast/core/features.hpp";

cv::Mat picture(std::uint64_t index = 0) { return Scene::grey(Scene(standard_camera()).frame(index)); }

/// A picture of any size: a piece of the scene, repeated where it ends.
cv::Mat picture_of_size(int width, int height) {
  const cv::Mat whole = picture();
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at<std::uint8_t>(y, x) = whole.at<std::uint8_t>(y % whole.rows, x % whole.cols);
  return image;
}

Features extract(FeatureExtractor& extractor, const cv::Mat& grey, const cv::Mat& ignore = {}) {
  Features features;
  extractor.extract(grey, ignore, features);
  return features;
}

/// Features of the scene; there must be some, otherwise the checks would be empty.
Features some_features(const Maker& maker) {
  Features features = extract(*maker.make<FeatureExtractor>(), picture());
  EXPECT_FALSE(features.empty()) << "no feature in a 320x240 picture full of corners: there is nothing to check";
  return features;
}

void expect_whole(const Features& features) {
  for (const auto& [name, size] : {std::pair{"y", features.y.size()},
                                   {"angle", features.angle.size()},
                                   {"response", features.response.size()},
                                   {"octave", features.octave.size()},
                                   {"descriptors", features.descriptors.size()}})
    EXPECT_EQ(size, features.x.size()) << "the array '" << name << "' has another length than 'x'";
}

void expect_inside(const Features& features, const cv::Mat& image) {
  const auto columns = static_cast<float>(image.cols), rows = static_cast<float>(image.rows);
  for (std::size_t i = 0; i < std::min(features.x.size(), features.y.size()); ++i) {
    const float x = features.x[i], y = features.y[i];
    ASSERT_TRUE(x >= -0.5F && y >= -0.5F && x < columns - 0.5F && y < rows - 0.5F)
        << "feature " << i << " lies at (" << x << ", " << y << ") of an image of " << image.cols << "x" << image.rows
        << "; pixel centres are whole numbers";
  }
}

void expect_same(const Features& a, const Features& b, const std::string& when) {
  ASSERT_EQ(a.size(), b.size()) << when << ": another number of features";
  EXPECT_EQ(a.x, b.x) << when << ": other columns";
  EXPECT_EQ(a.y, b.y) << when << ": other rows";
  EXPECT_EQ(a.angle, b.angle) << when << ": other angles";
  EXPECT_EQ(a.response, b.response) << when << ": other responses";
  EXPECT_EQ(a.octave, b.octave) << when << ": other octaves";
  EXPECT_TRUE(a.descriptors == b.descriptors) << when << ": other descriptors";
}

void finds_features(const Maker& maker) { some_features(maker); }

void fills_every_array(const Maker& maker) { expect_whole(some_features(maker)); }

void positions_lie_inside(const Maker& maker) { expect_inside(some_features(maker), picture()); }

void angles_within_the_circle(const Maker& maker) {
  for (const float angle : some_features(maker).angle)
    ASSERT_TRUE(angle >= 0.0F && angle < 2.0F * std::numbers::pi_v<float>) << "an angle is " << angle << " rad";
}

void responses_are_finite(const Maker& maker) {
  for (const float response : some_features(maker).response)
    ASSERT_TRUE(std::isfinite(response)) << "a response is " << response;
}

void octaves_within_the_pyramid(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  for (const std::uint8_t octave : extract(*extractor, picture()).octave)
    ASSERT_LT(static_cast<int>(octave), extractor->pyramid().levels()) << "octave of a feature, levels of pyramid()";
}

void pyramid_is_whole_and_stays(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  const ScalePyramid before = extractor->pyramid();
  ASSERT_GT(before.levels(), 0) << "pyramid() has no levels";
  EXPECT_LE(before.levels(), 256) << "Features::octave has 8 bits";
  for (const std::size_t size : {before.inverse_scale.size(), before.sigma2.size(), before.inverse_sigma2.size()})
    ASSERT_EQ(size, before.scale.size()) << "the arrays of pyramid() differ in length";
  for (std::size_t level = 0; level < before.scale.size(); ++level)
    EXPECT_NEAR(before.scale[level] / std::pow(before.factor, static_cast<double>(level)), 1.0, 1e-4)
        << "scale of level " << level << " is not factor^level";
  extract(*extractor, picture());
  extract(*extractor, picture_of_size(64, 48));
  EXPECT_EQ(extractor->pyramid().scale, before.scale) << "pyramid() changed by extracting";
  EXPECT_EQ(extractor->pyramid().factor, before.factor) << "pyramid() changed by extracting";
}

void descriptors_are_of_the_type(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  const DescriptorType type = extractor->descriptor_type();
  ASSERT_EQ(trouble_of(type), "") << "descriptor_type() is impossible";
  const Features features = extract(*extractor, picture());
  const DescriptorView descriptors = features.descriptors;
  ASSERT_TRUE(descriptors.type() == type)
      << "the descriptors are of " << to_string(descriptors.type()) << ", descriptor_type() says " << to_string(type);
  EXPECT_TRUE(extractor->descriptor_type() == type) << "descriptor_type() changed by extracting";
  const std::size_t bytes = type.bytes(), padded = descriptors.units() * sizeof(Descriptor256);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const auto* row = reinterpret_cast<const std::uint8_t*>(descriptors.row(i));
    for (std::size_t k = bytes; k < padded; ++k)
      ASSERT_EQ(static_cast<int>(row[k]), 0) << "descriptor " << i << " is padded with something else than zeros";
    if (type.kind == DescriptorKind::binary && type.length % 8 != 0) {
      ASSERT_EQ(row[bytes - 1] >> (type.length % 8), 0) << "descriptor " << i << " has bits beyond its length";
    }
    if (type.kind != DescriptorKind::float32) continue;
    const auto* numbers = reinterpret_cast<const float*>(row);
    double squares = 0.0;
    for (std::uint32_t k = 0; k < type.length; ++k) {
      ASSERT_TRUE(std::isfinite(numbers[k])) << "descriptor " << i << " has the number " << numbers[k];
      squares += static_cast<double>(numbers[k]) * numbers[k];
    }
    if (type.metric == DescriptorMetric::cosine) {
      ASSERT_NEAR(squares, 1.0, 1e-3) << "descriptor " << i << " has no unit length";
    }
  }
}

void angles_are_as_promised(const Maker& maker) {
  if (maker.make<FeatureExtractor>()->has_angles()) return;
  for (const float angle : some_features(maker).angle) ASSERT_EQ(angle, 0.0F) << "has_angles() is false";
}

void honours_ignore(const Maker& maker) {
  const cv::Mat grey = picture();
  cv::Mat ignore(grey.size(), CV_8UC1, cv::Scalar(0));
  ignore(cv::Rect(0, 0, grey.cols / 2, grey.rows)) = cv::Scalar(1);
  ignore(cv::Rect(220, 60, 60, 90)) = cv::Scalar(255);
  const auto extractor = maker.make<FeatureExtractor>();
  const Features features = extract(*extractor, grey, ignore);
  expect_whole(features);
  expect_inside(features, grey);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const int reach = static_cast<int>(std::ceil(2.0F * extractor->pyramid().scale.at(features.octave[i])));
    const int x = static_cast<int>(std::lround(features.x[i])), y = static_cast<int>(std::lround(features.y[i]));
    bool allowed = false;
    for (int dy = -reach; dy <= reach && !allowed; ++dy)
      for (int dx = -reach; dx <= reach && !allowed; ++dx) {
        const int column = std::clamp(x + dx, 0, ignore.cols - 1), row = std::clamp(y + dy, 0, ignore.rows - 1);
        allowed = ignore.at<std::uint8_t>(row, column) == 0;
      }
    ASSERT_TRUE(allowed) << "feature " << i << " at (" << features.x[i] << ", " << features.y[i] << "), octave "
                         << static_cast<int>(features.octave[i]) << ", lies where ignore is not 0";
  }
}

void takes_nothing_where_all_is_ignored(const Maker& maker) {
  const cv::Mat grey = picture();
  const cv::Mat ignore(grey.size(), CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(extract(*maker.make<FeatureExtractor>(), grey, ignore).size(), 0U) << "features with all pixels ignored";
}

void finds_nothing_in_tiny_images(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  EXPECT_EQ(extract(*extractor, cv::Mat()).size(), 0U) << "features in an image of no size";
  EXPECT_EQ(extract(*extractor, cv::Mat(1, 1, CV_8UC1, cv::Scalar(9))).size(), 0U) << "features in an image of 1x1";
}

void takes_any_size(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  for (const cv::Size size :
       {cv::Size(2, 2), cv::Size(1, 300), cv::Size(300, 1), cv::Size(33, 7), cv::Size(65, 63), cv::Size(641, 97)}) {
    const cv::Mat grey = picture_of_size(size.width, size.height);
    SCOPED_TRACE("in an image of " + std::to_string(size.width) + "x" + std::to_string(size.height));
    const Features features = extract(*extractor, grey);
    expect_whole(features);
    expect_inside(features, grey);
    const cv::Mat ignore(grey.size(), CV_8UC1, cv::Scalar(1));
    EXPECT_EQ(extract(*extractor, grey, ignore).size(), 0U) << "features with all pixels ignored";
  }
  for (const int value : {0, 255}) {
    const cv::Mat flat(standard_camera().height, standard_camera().width, CV_8UC1, cv::Scalar(value));
    expect_inside(extract(*extractor, flat), flat);
  }
}

void takes_images_with_gaps(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  const cv::Mat grey = picture();
  cv::Mat ignore(grey.size(), CV_8UC1, cv::Scalar(0));
  ignore(cv::Rect(10, 10, 90, 100)) = cv::Scalar(1);
  expect_same(extract(*extractor, grey, ignore), extract(*extractor, with_gaps(grey), with_gaps(ignore)),
              "the same image inside a larger one, with a stride of its own");
}

void replaces_out(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  const Features fresh = extract(*extractor, picture());
  Features used = fresh;
  used.x.resize(fresh.size() + 17, 1e6F);
  used.y.resize(3);
  used.octave.assign(5000, 255);
  extractor->extract(picture(), {}, used);
  expect_whole(used);
  expect_same(fresh, used, "into an `out` that was not empty");
  extractor->extract(cv::Mat(), {}, used);
  EXPECT_TRUE(used.empty()) << "features of the image before were left in `out`";
  expect_whole(used);
}

void writes_to_no_image(const Maker& maker) {
  const cv::Mat grey = picture();
  const cv::Mat ignore(grey.size(), CV_8UC1, cv::Scalar(0));
  const std::uint64_t grey_before = digest(grey), ignore_before = digest(ignore);
  extract(*maker.make<FeatureExtractor>(), grey, ignore);
  EXPECT_EQ(digest(grey), grey_before) << "the grey image was written to";
  EXPECT_EQ(digest(ignore), ignore_before) << "the mask was written to";
}

void same_image_same_features(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  const Features first = extract(*extractor, picture());
  expect_same(first, extract(*extractor, picture()), "on a second call");
  extract(*extractor, picture(7));
  extract(*extractor, picture_of_size(100, 90));
  expect_same(first, extract(*extractor, picture()), "after other images");
  expect_same(first, extract(*maker.make<FeatureExtractor>(), picture()), "by a second instance");
}

void budget_comes_and_goes(const Maker& maker) {
  const cv::Mat grey = picture();
  const auto extractor = maker.make<FeatureExtractor>();
  const Features before = extract(*extractor, grey);
  extractor->set_budget(2.0);
  const Features more = extract(*extractor, grey);
  EXPECT_GE(more.size(), before.size()) << "a larger budget gives fewer features";
  extractor->set_budget(1.0);
  expect_same(before, extract(*extractor, grey), "after a larger budget has come and gone");
}

void may_change_threads(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  const cv::Mat grey = picture();
  const Features here = extract(*extractor, grey);
  Features there;
  run_side_by_side([&] { extractor->extract(grey, {}, there); }, [] {});
  expect_same(here, there, "in another thread than the one that made the extractor");
}

void instances_do_not_meet(const Maker& maker) {
  const auto one = maker.make<FeatureExtractor>(), two = maker.make<FeatureExtractor>();
  const std::vector<cv::Mat> images{picture(0), picture(4), picture_of_size(201, 150)};
  std::vector<Features> alone;
  for (const cv::Mat& image : images) alone.push_back(extract(*one, image));
  std::vector<Features> first(images.size()), second(images.size());
  run_side_by_side(
      [&] {
        for (int turn = 0; turn < 3; ++turn)
          for (std::size_t i = 0; i < images.size(); ++i) one->extract(images[i], {}, first[i]);
      },
      [&] {
        for (int turn = 0; turn < 3; ++turn)
          for (std::size_t i = images.size(); i-- > 0;) two->extract(images[i], {}, second[i]);
      });
  for (std::size_t i = 0; i < images.size(); ++i) {
    expect_same(alone[i], first[i], "beside another instance in another thread");
    expect_same(alone[i], second[i], "beside another instance in another thread");
  }
}

void time(const Maker& maker) {
  const auto extractor = maker.make<FeatureExtractor>();
  const cv::Mat grey = picture_of_size(640, 480);
  Features features;
  report_time("features/" + maker.entry().description.name + ", 640x480", 9,
              [&] { extractor->extract(grey, {}, features); });
}

}  // namespace

std::vector<Check> feature_extractor_checks() {
  const Promise same{
      extractor_header,
      "The same image gives the same features in the same order, on every call and at every SIMD level."};
  const Promise any_size{extractor_header,
                         "Extracts features from a grey image (8UC1, any size); an empty image or one too small for a "
                         "feature gives none."};
  const Promise ignore{
      extractor_header,
      "`ignore` is empty or 8UC1 of the same size; no features are extracted where it is not 0, with a "
      "tolerance of two pixels of the feature's octave."};
  const Promise threads{extractor_header,
                        "Used by one thread at a time; implementations may keep buffers between images."};
  return {
      {"FindsFeatures", {extractor_header, "Detects and describes features."}, finds_features},
      {"FillsEveryArray", {features_header, "entry i of every array belongs to feature i."}, fills_every_array},
      {"PositionsLieInsideTheImage",
       {features_header,
        "Positions are raw (distorted) pixels of level 0, as the extractor found them; Frame adds the undistorted "
        "positions."},
       positions_lie_inside},
      {"AnglesLieWithinTheCircle",
       {features_header, "orientation [rad, 0 to 2 pi), from the x axis towards the y axis"},
       angles_within_the_circle},
      {"ResponsesAreFinite",
       {features_header, "corner strength, larger is stronger; comparable within one image only"},
       responses_are_finite},
      {"OctavesLieWithinThePyramid", {features_header, "pyramid level"}, octaves_within_the_pyramid},
      {"PyramidIsWholeAndStays",
       {extractor_header, "The scale pyramid to which Features::octave refers; constant after construction."},
       pyramid_is_whole_and_stays},
      {"DescriptorsAreOfTheType",
       {extractor_header,
        "The type of all descriptors that extract() returns, with the distances that this extractor recommends; "
        "constant after construction."},
       descriptors_are_of_the_type},
      {"AnglesAreAsPromised",
       {extractor_header,
        "Whether Features::angle is the orientation of a feature, which turns with the image. Otherwise all angles are "
        "0."},
       angles_are_as_promised},
      {"BudgetComesAndGoes",
       {extractor_header, "The same image with the same budget gives the same features."},
       budget_comes_and_goes},
      {"HonoursIgnore", ignore, honours_ignore},
      {"TakesNothingWhereAllIsIgnored", ignore, takes_nothing_where_all_is_ignored},
      {"FindsNothingInTinyImages", any_size, finds_nothing_in_tiny_images},
      {"TakesImagesOfAnySize", any_size, takes_any_size},
      {"TakesImagesWithGaps", any_size, takes_images_with_gaps},
      {"ReplacesOut", {extractor_header, "`out` is replaced."}, replaces_out},
      {"WritesToNoImage", {extractor_header, "Neither image is written to."}, writes_to_no_image},
      {"SameImageSameFeatures", same, same_image_same_features},
      {"MayChangeThreads", threads, may_change_threads},
      {"InstancesDoNotMeet", threads, instances_do_not_meet},
      {"Time", threads, time},
  };
}

}  // namespace holdfast::conformance

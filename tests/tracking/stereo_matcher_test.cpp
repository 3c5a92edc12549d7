// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/stereo_matcher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/median.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/core/stereo_calibration.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "holdfast/tracking/pair_depth.hpp"
#include "semi_global_stereo.hpp"

namespace holdfast {
namespace {

constexpr int width = 320, height = 240;

/// A pair of images of one texture, whose disparity changes from row to row, and features with descriptors of their
/// own.
class StereoMatcherTest : public ::testing::Test {
 protected:
  StereoMatcherTest() : left_(height, width, CV_8UC1) {
    Camera camera;
    camera.width = width, camera.height = height;
    camera.fx = camera.fy = 200.0;
    camera.cx = 160.0, camera.cy = 120.0;
    camera.baseline = 0.1;
    frame_.camera = std::make_shared<const Camera>(camera);
    frame_.pyramid = std::make_shared<const ScalePyramid>();
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column)
        left_.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(random_.next() % 200);
    cv::GaussianBlur(left_, left_, cv::Size(), 1.5);
    cv::normalize(left_, left_, 10, 200, cv::NORM_MINMAX);
    show(8.0F, 0);
  }

  /// The right image and the features, of one octave, for a disparity of `first_disparity_` in the first row.
  void show(float first_disparity, std::uint8_t octave) {
    first_disparity_ = first_disparity;
    cv::Mat map_x(height, width, CV_32FC1), map_y(height, width, CV_32FC1);
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column) {
        map_x.at<float>(row, column) = static_cast<float>(column) + disparity_at(static_cast<float>(row));
        map_y.at<float>(row, column) = static_cast<float>(row);
      }
    cv::remap(left_, right_, map_x, map_y, cv::INTER_CUBIC, cv::BORDER_REFLECT);
    right_ += cv::Scalar(12);  // its exposure differs
    right_features_.clear();
    frame_.features.clear();
    frame_.x.clear(), frame_.y.clear();
    for (int y = 20; y < height - 20; y += 20)
      for (int x = 60; x < width - 20; x += 20) add(static_cast<float>(x), static_cast<float>(y), octave);
  }

  float disparity_at(float row) const { return first_disparity_ + 0.043F * row; }

  void add(float x, float y, std::uint8_t octave) {
    Descriptor256 descriptor;
    for (std::uint64_t& word : descriptor.words) word = random_.next();
    // The keypoint in the right image is off by up to a pixel of its level.
    const double scale = frame_.pyramid->scale[octave];
    const auto noise = [&] { return static_cast<float>(random_.uniform(-scale, scale)); };
    push(frame_.features, x, y, octave, descriptor);
    push(right_features_, x - disparity_at(y) + noise(), y + noise(), octave, descriptor);
    frame_.x.push_back(x), frame_.y.push_back(y);
  }
  static void push(Features& features, float x, float y, std::uint8_t octave, const Descriptor256& descriptor) {
    features.x.push_back(x), features.y.push_back(y), features.angle.push_back(0), features.response.push_back(1);
    features.octave.push_back(octave), features.descriptors.push_back(descriptor);
  }
  void match(const StereoSettings& settings = {}) {
    StereoMatcher(settings).match(left_, right_, right_features_, frame_);
  }
  std::size_t with_depth() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < frame_.size(); ++i) count += frame_.has_depth(i) ? 1 : 0;
    return count;
  }

  Random random_{7};
  float first_disparity_ = 0.0F;  // px, in the first row
  cv::Mat left_, right_;
  Frame frame_;
  Features right_features_;
};

TEST_F(StereoMatcherTest, TheDisparityIsThatOfTheImagesNotThatOfTheKeypoints) {
  match();
  EXPECT_GT(with_depth(), frame_.size() * 9 / 10);
  for (std::size_t i = 0; i < frame_.size(); ++i) {
    if (!frame_.has_depth(i)) continue;
    const float disparity = frame_.x[i] - frame_.right_x[i];
    EXPECT_NEAR(disparity, disparity_at(frame_.y[i]), 0.15F) << i;
    EXPECT_NEAR(frame_.depth[i], 20.0F / disparity, 1e-4F) << i;
  }
}

TEST_F(StereoMatcherTest, TheDisparityHasNoBiasAtAnyDistanceOrOctave) {
  for (const float first_disparity : {1.0F, 3.0F, 8.0F, 25.0F})
    for (const int octave : {0, 3, 7}) {
      show(first_disparity, static_cast<std::uint8_t>(octave));
      match();
      double sum = 0.0;
      for (std::size_t i = 0; i < frame_.size(); ++i)
        if (frame_.has_depth(i)) sum += frame_.x[i] - frame_.right_x[i] - disparity_at(frame_.y[i]);
      ASSERT_GT(with_depth(), frame_.size() / 2);
      EXPECT_NEAR(sum / static_cast<double>(with_depth()), 0.0, 0.015) << first_disparity << " px, octave " << octave;
    }
}

TEST_F(StereoMatcherTest, ErrorsOfThePairAreCorrectedInRowsAndColumns) {
  constexpr float lower = 3.4F, to_the_right = 0.4F;
  const cv::Matx23f shift(1, 0, to_the_right, 0, 1, lower);
  cv::warpAffine(right_.clone(), right_, shift, right_.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  for (float& x : right_features_.x) x += to_the_right;
  for (float& y : right_features_.y) y += lower;
  // Of a long focal length, a rotation displaces all columns and rows alike.
  Camera camera = *frame_.camera;
  camera.fx = camera.fy = 2000.0;
  camera.baseline = 0.01;
  frame_.camera = std::make_shared<const Camera>(camera);
  match();
  const std::size_t without = with_depth();
  PairErrors errors;
  errors.rotation.x() = -lower / frame_.camera->fy;
  errors.column_offset = to_the_right;
  StereoMatcher matcher({});
  matcher.match(left_, right_, right_features_, frame_, errors);
  EXPECT_GT(with_depth(), std::max(frame_.size() * 8 / 10, 2 * without));
  double sum = 0.0;
  for (std::size_t i = 0; i < frame_.size(); ++i) {
    if (!frame_.has_depth(i)) continue;
    const float disparity = frame_.x[i] - frame_.right_x[i];
    EXPECT_NEAR(disparity, disparity_at(frame_.y[i]), 0.25F) << i;
    EXPECT_NEAR(frame_.depth[i], 20.0F / disparity, 1e-4F) << i;
    sum += disparity - disparity_at(frame_.y[i]);
  }
  EXPECT_NEAR(sum / static_cast<double>(with_depth()), 0.0, 0.08);  // a parabola prefers whole pixels
  ASSERT_GT(matcher.row_differences().size(), frame_.size() / 2);
  double rows = 0.0;
  for (const RowDifference& row : matcher.row_differences()) rows += row.difference;
  EXPECT_NEAR(rows / static_cast<double>(matcher.row_differences().size()), lower, 0.3);
}

TEST_F(StereoMatcherTest, AFeatureWithoutItsLikeInTheRowHasNoDepth) {
  right_features_.descriptors.of_256_bits()[5].words = {1, 2, 3, 4};
  right_features_.y[6] += 5.0F;
  right_features_.octave[7] = 3;
  right_features_.x[8] += 40.0F;
  match();
  for (const std::size_t i : {5U, 6U, 7U, 8U}) {
    EXPECT_FALSE(frame_.has_depth(i)) << i;
    EXPECT_TRUE(std::isnan(frame_.right_x[i])) << i;
  }
}

TEST_F(StereoMatcherTest, ARightFeatureBelongsToTheLeftOneThatIsMoreAlike) {
  // Feature 1 has the descriptor of feature 0 but for one bit, and stands beside it.
  frame_.features.x[1] = frame_.x[1] = frame_.x[0] + 1.0F;
  frame_.features.descriptors.of_256_bits()[1] = frame_.features.descriptors.of_256_bits()[0];
  frame_.features.descriptors.of_256_bits()[1].words[0] ^= 1U;
  right_features_.descriptors.of_256_bits()[1].words = {1, 2, 3, 4};
  match();
  EXPECT_TRUE(frame_.has_depth(0));
  EXPECT_FALSE(frame_.has_depth(1));
}

TEST_F(StereoMatcherTest, DepthsOutsideTheRangeAreLeftOut) {
  StereoSettings near;
  near.minimum_depth = 20.0 / 12.0;  // 12 px
  match(near);
  EXPECT_LT(with_depth(), frame_.size() * 6 / 10);
  for (std::size_t i = 0; i < frame_.size(); ++i) {
    if (frame_.has_depth(i)) {
      EXPECT_LE(frame_.x[i] - frame_.right_x[i], 12.0F);
    }
  }
  StereoSettings far;
  far.minimum_disparity = 12.0;
  match(far);
  for (std::size_t i = 0; i < frame_.size(); ++i) {
    if (frame_.has_depth(i)) {
      EXPECT_GE(frame_.x[i] - frame_.right_x[i], 12.0F);
    }
  }
}

/// Gives the features of each image of the pair.
class PairExtractor final : public FeatureExtractor {
 public:
  PairExtractor(const cv::Mat& left, const Features& of_left, const Features& of_right)
      : left_(left), of_left_(of_left), of_right_(of_right) {}
  void extract(const cv::Mat& image, const cv::Mat&, Features& out) override {
    out = image.data == left_.data ? of_left_ : of_right_;
  }
  const ScalePyramid& pyramid() const override { return pyramid_; }

 private:
  const cv::Mat& left_;
  const Features &of_left_, &of_right_;
  ScalePyramid pyramid_;
};

TEST_F(StereoMatcherTest, AnExchangedPairIsRecognised) {
  for (const float disparity : {3.0F, 12.0F}) {
    show(disparity, 0);
    PairExtractor extractor(left_, frame_.features, right_features_);
    PairDepth stereo(*frame_.camera, {});
    Frame right_order = frame_, exchanged = frame_;
    const auto is_exchanged = [&](const cv::Mat& left, const cv::Mat& right, Frame& frame) {
      SensorFrame pair;
      pair.right = right;
      stereo.begin(pair, left);
      stereo.extract(left, {}, extractor, frame);
      frame.x = frame.features.x, frame.y = frame.features.y;
      stereo.read(pair, frame);
      return stereo.is_pair_exchanged(frame);
    };
    EXPECT_FALSE(is_exchanged(left_, right_, right_order)) << disparity;
    EXPECT_TRUE(is_exchanged(right_, left_, exchanged)) << disparity;
  }
}

TEST_F(StereoMatcherTest, WithoutRightFeaturesNothingHasDepth) {
  right_features_.clear();
  match();
  EXPECT_EQ(with_depth(), 0U);
}

cv::Mat depth_image(PairDepth& pair, const cv::Mat& left, const cv::Mat& right) {
  SensorFrame frame;
  frame.right = right;
  pair.begin(frame, left);
  pair.add_image(frame);
  return frame.depth;
}

/// Errors of the disparities of a depth image [px]; `disparity_at` of column and row, 0 = not compared.
std::vector<double> disparity_errors(const cv::Mat& depth, double fx_baseline,
                                     const std::function<double(int, int)>& disparity_at) {
  std::vector<double> errors;
  for (int row = 0; row < depth.rows; ++row)
    for (int column = 0; column < depth.cols; ++column) {
      const double expected = disparity_at(column, row), found = depth.at<float>(row, column);
      if (expected > 0.0 && found > 0.0) errors.push_back(std::abs(fx_baseline / found - expected));
    }
  return errors;
}

TEST_F(StereoMatcherTest, TheDepthImageIsThatOfTheImagesAndIsCorrectedByTheErrorsOfThePair) {
  const auto errors_of = [&](StereoCalibration* calibration, int first_column) {
    PairDepth stereo(*frame_.camera, {.calibration = calibration});
    return disparity_errors(depth_image(stereo, left_, right_), 20.0,
                            [&](int x, int y) { return x < first_column ? 0.0 : disparity_at(static_cast<float>(y)); });
  };
  std::vector<double> errors = errors_of(nullptr, 0);
  EXPECT_GT(errors.size(), width * height * 9 / 10) << "up to the left border";
  EXPECT_LT(upper_median(errors), 0.1);
  // Two pixels lower, and 1.5 px to the right.
  cv::warpAffine(right_.clone(), right_, cv::Matx23f(1, 0, 1.5F, 0, 1, 2), right_.size(), cv::INTER_CUBIC,
                 cv::BORDER_REFLECT);
  PairErrors pair;
  pair.column_offset = 1.5;
  pair.rotation.x() = -2.0 / frame_.camera->fy;
  StereoCalibration calibration(*frame_.camera, pair, false);
  errors = errors_of(&calibration, 60);
  EXPECT_GT(errors.size(), (width - 60) * height * 8 / 10);
  EXPECT_LT(upper_median(errors), 0.2);
  errors = errors_of(nullptr, 60);
  EXPECT_GT(errors.empty() ? 9.0 : upper_median(errors), 1.0);
}

TEST_F(StereoMatcherTest, FarSurfacesAndPairsWithoutADenseMatcherHaveNoDepthImage) {
  show(1.0F, 0);  // up to 11 px: 20 m to 1.8 m
  PairDepth stereo(*frame_.camera, {}), off(*frame_.camera, {.settings = {.dense = DenseStereoMethod::off}});
  EXPECT_TRUE(depth_image(off, left_, right_).empty());
  const cv::Mat depth = depth_image(stereo, left_, right_);
  double farthest = 0.0;
  cv::minMaxLoc(depth, nullptr, &farthest);
  EXPECT_GT(farthest, 3.0);
  EXPECT_LT(farthest, 6.0);  // 0.17 px are 0.3 m here
}

TEST_F(StereoMatcherTest, ASmallNearObjectHasDepth) {
  const cv::Rect object(200, 100, 64, 64);
  cv::Mat(left_(object) + cv::Scalar(12)).copyTo(right_(object - cv::Point(40, 0)));  // 40 px of disparity: 0.5 m
  PairDepth stereo(*frame_.camera, {});
  const cv::Mat depth = depth_image(stereo, left_, right_)(object);
  EXPECT_GT(cv::countNonZero(cv::abs(depth - 0.5F) < 0.025F), object.area() * 6 / 10);
}

/// A matcher of the caller.
class SameDisparity final : public DenseStereo {
 public:
  void match(const cv::Mat& left, const cv::Mat&, cv::Mat& disparity) override {
    disparity.create(left.size(), CV_32FC1);
    disparity.setTo(10.0F);
  }
};

TEST_F(StereoMatcherTest, AnotherDenseMatcherTakesThePlaceOfTheBuiltInOne) {
  SameDisparity same;
  PairDepth stereo(*frame_.camera, {.dense = &same});
  EXPECT_EQ(cv::countNonZero(depth_image(stereo, left_, right_) == 2.0F), width * height);
}

TEST(DenseDepth, IsFoundUpToTheLastColumnAndEachRightPixelShowsOneSurface) {
  constexpr int columns = 323, rows = 91, far = 6, near = 24;  // px; the width is no multiple of vectors
  Random random(11);
  cv::Mat left(rows, columns, CV_8UC1);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      left.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(random.next() % 200);
  cv::GaussianBlur(left, left, cv::Size(), 1.5);
  cv::normalize(left, left, 10, 200, cv::NORM_MINMAX);
  cv::Mat right;
  cv::warpAffine(left, right, cv::Matx23f(1, 0, -far, 0, 1, 0), left.size(), cv::INTER_NEAREST, cv::BORDER_REFLECT);
  const cv::Rect object(120, 20, 80, 50);
  left(object).copyTo(right(object - cv::Point(near, 0)));
  cv::Mat disparity;
  SemiGlobalStereo(40.0, columns).match(left, right, disparity);
  const cv::Mat last = disparity(cv::Rect(columns - 7, 0, 7, rows));
  EXPECT_GT(cv::countNonZero(cv::abs(last - far) < 0.5), static_cast<int>(last.total() * 8 / 10));
  const cv::Mat middle = disparity(cv::Rect(140, 30, 40, 30));
  EXPECT_GT(cv::countNonZero(cv::abs(middle - near) < 0.5), static_cast<int>(middle.total() * 8 / 10));
  // Left of the object the right image shows the object, so that the surface behind has no disparity.
  const cv::Mat hidden = disparity(cv::Rect(120 - near + far + 4, 30, near - far - 8, 30));
  EXPECT_LT(cv::countNonZero(cv::abs(hidden - far) < 0.5), static_cast<int>(hidden.total() / 10));
  for (int row = 0; row < rows; ++row) {
    std::vector<float> nearest(columns, 0.0F), farthest(columns, 1e9F);
    for (int column = 0; column < columns; ++column) {
      const float value = disparity.at<float>(row, column);
      if (value == 0.0F) continue;
      const auto place = static_cast<std::size_t>(std::max(column - static_cast<int>(value + 0.5F), 0));
      nearest[place] = std::max(nearest[place], value), farthest[place] = std::min(farthest[place], value);
    }
    for (int place = 0; place < columns; ++place)
      EXPECT_LE(nearest[static_cast<std::size_t>(place)] - farthest[static_cast<std::size_t>(place)], 3.0F) << row;
  }
}

TEST(DenseDepth, OfASimulatedPairAgreesWithTheTrueDepth) {
  Camera camera = find_camera("tum_fr3").value();
  camera.baseline = 0.11;
  simulation::Scene scene;
  scene.seed = 1, scene.duration = 0.1;
  simulation::Simulator simulator(scene, camera);
  const SensorFrame frame = simulator.stereo_frame(0, camera.baseline);
  const cv::Mat truth = simulator.render(0).depth;
  cv::Mat left, right;
  cv::cvtColor(frame.colour, left, cv::COLOR_BGR2GRAY);
  cv::cvtColor(frame.right, right, cv::COLOR_BGR2GRAY);
  PairDepth stereo(camera, {});
  const double fx_baseline = camera.fx * camera.baseline;
  auto errors = disparity_errors(depth_image(stereo, left, right), fx_baseline, [&](int x, int y) -> double {
    const float z = truth.at<float>(y, x);
    return z > 0.4F && fx_baseline / z < x ? fx_baseline / z : 0.0;
  });
  EXPECT_GT(errors.size(), truth.total() * 45 / 100);  // of the others, most show plain walls
  EXPECT_LT(upper_median(errors), 0.2);
  const auto wrong = std::count_if(errors.begin(), errors.end(), [](double error) { return error > 1.0; });
  EXPECT_LT(wrong, static_cast<std::ptrdiff_t>(errors.size() / 10));
}

}  // namespace
}  // namespace holdfast

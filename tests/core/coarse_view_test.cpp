// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/coarse_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <tuple>

#include "holdfast/core/check.hpp"
#include "holdfast/core/coarse_cells.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/core/sensor_frame.hpp"

namespace holdfast {
namespace {

Camera without_distortion() {
  Camera camera = find_camera("tum_fr1").value();
  camera.distortion = {};
  return camera;
}

/// Each pixel's value is a linear function of its place, so that a value tells where it was read.
float ramp(double column, double row) { return static_cast<float>(1.0 + column + 1000.0 * row); }
cv::Mat ramp_image(const Camera& camera) {
  cv::Mat image(camera.height, camera.width, CV_32FC1);
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) image.at<float>(row, column) = ramp(column, row);
  return image;
}

TEST(MeasuredDepth, IsWhatASensorCanHaveMeasured) {
  for (const float depth : {1e-3F, 0.5F, 655.0F, 1e5F}) EXPECT_TRUE(is_measured_depth(depth)) << depth;
  for (const float depth :
       {0.0F, -1.0F, 1e10F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
    EXPECT_FALSE(is_measured_depth(depth)) << depth;
}

TEST(CoarseGrid, ACellHoldsItsCentreAndNothingBeyondItsBorder) {
  const CoarseGrid grid{.columns = 7, .rows = 5, .left = -3.25F, .top = 10.5F};
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const int cell = row * grid.columns + column;
      const float x = grid.x_of(column), y = grid.y_of(row);
      EXPECT_EQ(grid.cell_of(x, y), cell);
      EXPECT_EQ(grid.cell_of(x - 1.99F, y - 1.99F), cell);
      EXPECT_EQ(grid.cell_of(x + 1.99F, y + 1.99F), cell);
      EXPECT_NE(grid.cell_of(x + 2.01F, y), cell);
      EXPECT_NE(grid.cell_of(x, y - 2.01F), cell);
    }
  EXPECT_EQ(grid.cell_of(-3.3F, 20.0F), -1);
  EXPECT_EQ(grid.cell_of(0.0F, 10.4F), -1);
  EXPECT_EQ(grid.cell_of(grid.left + 7 * 4 + 0.01F, 20.0F), -1);
  EXPECT_EQ(grid.cell_of(0.0F, grid.top + 5 * 4 + 0.01F), -1);
  EXPECT_EQ(grid.cell_of(1e30F, 20.0F), -1);
  EXPECT_EQ(grid.cell_of(-1e30F, 20.0F), -1);
}

TEST(CoarseGrid, CellsOfManyPixelsAreThoseOfEach) {
  const CoarseGrid grid{.columns = 37, .rows = 23, .left = -3.25F, .top = 10.5F};
  std::vector<float> x, y;
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    x.push_back(static_cast<float>(random.uniform(-20, 160)));
    y.push_back(static_cast<float>(random.uniform(0, 120)));
  }
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const float right = grid.left + 37 * 4, bottom = grid.top + 23 * 4;
  for (const float special : {grid.left, grid.top, right, bottom, std::nextafter(right, 0.0F),
                              std::nextafter(bottom, 0.0F), -0.0F, 1e30F, -1e30F, infinity, -infinity})
    for (const float other : {20.0F, special}) {
      x.push_back(special), y.push_back(other);
      x.push_back(other), y.push_back(special);
    }
  std::vector<std::int32_t> cells(x.size());
  find_cells(grid, x, y, cells);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(cells[i], grid.cell_of(x[i], y[i])) << x[i] << " " << y[i];
  find_cells(grid, x, y, cells, 2);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const int column = grid.column_of(x[i]), row = grid.row_of(y[i]);
    const bool is_inner = column >= 2 && row >= 2 && column + 2 < grid.columns && row + 2 < grid.rows;
    EXPECT_EQ(cells[i], is_inner ? grid.cell_of(x[i], y[i]) : -1) << x[i] << " " << y[i];
  }
  EXPECT_THROW(find_cells(grid, x, y, std::span(cells).first(5)), CheckError);
}

TEST(CoarseSampler, MarkedCellsBecomeSquaresWithinTheImage) {
  for (const Camera& camera : {without_distortion(), find_camera("tum_fr1").value()}) {
    const CoarseSampler sampler(camera);
    std::vector<std::uint8_t> marked(static_cast<std::size_t>(sampler.grid().size()), 0);
    EXPECT_TRUE(sampler.pixels_of(marked).empty());
    cv::Mat expected = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
    // Every seventh cell: some of them at each border.
    for (int cell = 0; cell < sampler.grid().size(); cell += 7) {
      marked[static_cast<std::size_t>(cell)] = 1;
      if (sampler.raw_pixel(cell) < 0) continue;
      const int x = sampler.raw_pixel(cell) % camera.width, y = sampler.raw_pixel(cell) / camera.width;
      expected(cv::Rect(x - 2, y - 2, 5, 5) & cv::Rect(0, 0, camera.width, camera.height)) = 255;
    }
    EXPECT_EQ(cv::norm(sampler.pixels_of(marked), expected, cv::NORM_INF), 0.0) << camera.name;
  }
}

TEST(CoarseSampler, CoversAnUndistortedImageExactly) {
  const Camera camera = without_distortion();
  const CoarseSampler sampler(camera);
  EXPECT_EQ(sampler.grid().columns, 160);
  EXPECT_EQ(sampler.grid().rows, 120);
  for (int cell = 0; cell < sampler.grid().size(); ++cell) EXPECT_GE(sampler.raw_pixel(cell), 0);
}

TEST(CoarseSampler, ReadsTheRawPixelAtEachCellsCentre) {
  for (const Camera& camera : {without_distortion(), find_camera("tum_fr1").value(), find_camera("tum_fr2").value()}) {
    const CoarseSampler sampler(camera);
    const CoarseGrid& grid = sampler.grid();
    CoarseView view;
    view.static_log_odds.assign(3, 1.0F);
    view.mask.labels.assign(3, 1);
    sampler.sample_depth(ramp_image(camera), view);
    EXPECT_EQ(view.grid, grid);
    EXPECT_TRUE(view.static_log_odds.empty());
    EXPECT_TRUE(view.mask.empty());
    ASSERT_EQ(view.depth.size(), static_cast<std::size_t>(grid.size()));
    int inside = 0;
    for (int row = 0; row < grid.rows; ++row)
      for (int column = 0; column < grid.columns; ++column) {
        const int cell = row * grid.columns + column;
        const float value = view.depth[static_cast<std::size_t>(cell)];
        const std::int32_t raw = sampler.raw_pixel(cell);
        EXPECT_EQ(value == 0.0F, raw < 0);
        if (raw < 0) continue;
        ++inside;
        const int x = raw % camera.width, y = raw / camera.width;
        EXPECT_EQ(value, ramp(x, y));
        const Eigen::Vector2d back = camera.undistort({x, y});
        EXPECT_LE(std::abs(back.x() - grid.x_of(column)), 0.75) << camera.name << " " << column << " " << row;
        EXPECT_LE(std::abs(back.y() - grid.y_of(row)), 0.75) << camera.name << " " << column << " " << row;
      }
    EXPECT_GE(inside, grid.size() * 8 / 10);
  }
}

TEST(CoarseSampler, EveryPixelOfTheImageHasACell) {
  for (const Camera& camera : {without_distortion(), find_camera("tum_fr1").value(), find_camera("tum_fr2").value()}) {
    const CoarseSampler sampler(camera);
    const CoarseGrid& grid = sampler.grid();
    for (int y = 0; y < camera.height; y += camera.height - 1)
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector2d pixel = camera.undistort({x, y});
        const int cell = grid.cell_of(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
        ASSERT_GE(cell, 0) << camera.name << " " << x << " " << y;
        const std::int32_t raw = sampler.raw_pixel(cell);
        if (raw < 0) continue;    // the cell's centre lies outside
        constexpr int reach = 5;  // px: half a cell, stretched by the distortion
        EXPECT_LE(std::abs(raw % camera.width - x), reach) << camera.name << " " << x << " " << y;
        EXPECT_LE(std::abs(raw / camera.width - y), reach) << camera.name << " " << x << " " << y;
      }
  }
}

TEST(CoarseSampler, AMissingDepthIsTakenFromTheNextPixelOnly) {
  const Camera camera = without_distortion();
  const CoarseSampler sampler(camera);
  const int cell = 60 * sampler.grid().columns + 80;
  const int x = sampler.raw_pixel(cell) % camera.width, y = sampler.raw_pixel(cell) / camera.width;
  const auto sampled = [&](cv::Mat depth) {
    CoarseView view;
    sampler.sample_depth(depth, view);
    return view.depth[static_cast<std::size_t>(cell)];
  };
  cv::Mat depth = cv::Mat::zeros(camera.height, camera.width, CV_32FC1);
  EXPECT_EQ(sampled(depth), 0.0F);
  depth.at<float>(y, x + 2) = 4.0F;
  EXPECT_EQ(sampled(depth), 0.0F);
  depth.at<float>(y + 1, x) = 3.0F;
  EXPECT_EQ(sampled(depth), 3.0F);
  depth.at<float>(y, x) = 2.0F;
  EXPECT_EQ(sampled(depth), 2.0F);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.0F}) {
    depth.at<float>(y, x) = bad;
    EXPECT_EQ(sampled(depth), 3.0F);
  }
  const CoarseView empty = [&] {
    CoarseView view;
    sampler.sample_depth(cv::Mat(), view);
    return view;
  }();
  ASSERT_EQ(empty.depth.size(), static_cast<std::size_t>(sampler.grid().size()));
  EXPECT_EQ(*std::max_element(empty.depth.begin(), empty.depth.end()), 0.0F);
}

TEST(CoarseSampler, OfSeveralMeasuredNeighboursTheOneInTheSameRowCounts) {
  const Camera camera = without_distortion();
  const CoarseSampler sampler(camera);
  const int cell = 60 * sampler.grid().columns + 80;
  const int x = sampler.raw_pixel(cell) % camera.width, y = sampler.raw_pixel(cell) / camera.width;
  cv::Mat depth = cv::Mat::zeros(camera.height, camera.width, CV_32FC1);
  CoarseView view;
  for (const auto& [column, row, value] :
       {std::tuple{x, y + 1, 4.0F}, {x, y - 1, 3.0F}, {x + 1, y, 2.0F}, {x - 1, y, 1.0F}}) {
    depth.at<float>(row, column) = value;
    sampler.sample_depth(depth, view);
    EXPECT_EQ(view.depth[static_cast<std::size_t>(cell)], value);
  }
}

TEST(CoarseSampler, ReadsAPartOfALargerImage) {
  const Camera camera = find_camera("tum_fr1").value();
  const CoarseSampler sampler(camera);
  cv::Mat larger(camera.height + 10, camera.width + 20, CV_32FC1, cv::Scalar(7.0));
  const cv::Mat part = larger(cv::Rect(13, 4, camera.width, camera.height));
  ramp_image(camera).copyTo(part);
  CoarseView of_part, of_image;
  sampler.sample_depth(part, of_part);
  sampler.sample_depth(ramp_image(camera), of_image);
  EXPECT_EQ(of_part.depth, of_image.depth);
}

TEST(CoarseSampler, LabelsOutsideTheImageAreWhatTheCallerSays) {
  const Camera camera = find_camera("tum_fr1").value();
  const CoarseSampler sampler(camera);
  cv::Mat labels(camera.height, camera.width, CV_8UC1);
  for (int row = 0; row < labels.rows; ++row)
    for (int column = 0; column < labels.cols; ++column)
      labels.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>((row * 7 + column) % 100);
  std::vector<std::uint8_t> cells;
  sampler.sample_labels(labels, 200, cells);
  ASSERT_EQ(cells.size(), static_cast<std::size_t>(sampler.grid().size()));
  int outside = 0;
  for (int cell = 0; cell < sampler.grid().size(); ++cell) {
    const std::int32_t raw = sampler.raw_pixel(cell);
    outside += raw < 0 ? 1 : 0;
    EXPECT_EQ(cells[static_cast<std::size_t>(cell)],
              raw < 0 ? 200 : labels.at<std::uint8_t>(raw / camera.width, raw % camera.width));
  }
  EXPECT_GT(outside, 0);  // the lens bends the border of the image
}

TEST(CoarseSampler, ImagesOfAnotherSizeOrTypeAreRefused) {
  const Camera camera = without_distortion();
  const CoarseSampler sampler(camera);
  CoarseView view;
  std::vector<std::uint8_t> cells;
  EXPECT_THROW(sampler.sample_depth(cv::Mat::zeros(240, 320, CV_32FC1), view), CheckError);
  EXPECT_THROW(sampler.sample_depth(cv::Mat::zeros(480, 640, CV_16UC1), view), CheckError);
  EXPECT_THROW(sampler.sample_labels(cv::Mat::zeros(240, 320, CV_8UC1), 0, cells), CheckError);
  EXPECT_THROW(sampler.sample_labels(cv::Mat::zeros(480, 640, CV_32FC1), 0, cells), CheckError);
}

}  // namespace
}  // namespace holdfast

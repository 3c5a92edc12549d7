// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/stereo_calibration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

/// A pair on a street, whose right camera is turned and has another focal length, and points that it sees.
class StereoCalibrationTest : public ::testing::Test {
 protected:
  StereoCalibrationTest() {
    camera_.width = 1226, camera_.height = 370;
    camera_.fx = 707.0, camera_.fy = 690.0;
    camera_.cx = 602.0, camera_.cy = 183.0;
    camera_.baseline = 0.54;
  }

  struct Sight {
    double x, y;              // in the left image [px]
    double disparity;         // of a perfect pair [px]
    double right_x, right_y;  // as the pair shows it [px]
  };

  /// Points between 6 m and 60 m. The right image is that of the rotation and focal length themselves, without
  /// linearisation.
  std::vector<Sight> look(std::size_t count) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(truth_.rotation.norm(), truth_.rotation.normalized()).toRotationMatrix();
    std::vector<Sight> sights;
    while (sights.size() < count) {
      Sight sight{random_.uniform(20.0, 1206.0), random_.uniform(20.0, 350.0), 0.0, 0.0, 0.0};
      const double depth = 1.0 / random_.uniform(1.0 / 60.0, 1.0 / 6.0);
      const Eigen::Vector3d point = camera_.back_project(sight.x, sight.y, depth);
      const Eigen::Vector3d in_right = turn * (point - Eigen::Vector3d(camera_.baseline, 0.0, 0.0));
      sight.disparity = camera_.fx * camera_.baseline / depth;
      sight.right_x = camera_.cx + truth_.focal_ratio * camera_.fx * in_right.x() / in_right.z();
      sight.right_y = camera_.cy + truth_.focal_ratio * camera_.fy * in_right.y() / in_right.z();
      sights.push_back(sight);
    }
    return sights;
  }

  void learn_rows(StereoCalibration& calibration, int frames) {
    for (int frame = 0; frame < frames; ++frame) {
      std::vector<RowDifference> rows;
      for (const Sight& s : look(400)) rows.push_back({s.right_x, s.y, s.right_y - s.y + 0.7 * random_.normal(), 0.7});
      for (std::size_t i = 0; i < rows.size(); i += 10) rows[i].difference += 8.0;  // wrong matches
      calibration.learn_rows(rows);
    }
  }
  /// Rows as PairErrors describes them, also those of a lens.
  void learn_modelled_rows(StereoCalibration& calibration, int frames, std::size_t count, double sigma) {
    for (int frame = 0; frame < frames; ++frame) {
      std::vector<RowDifference> rows;
      for (const Sight& s : look(count))
        rows.push_back({s.x, s.y, truth_.row(camera_, s.x, s.y) + sigma * random_.normal(), sigma});
      calibration.learn_rows(rows);
    }
  }
  /// The coefficients that bundle adjustment finds.
  ColumnEstimate columns(const PairErrors& used, double sigma) {
    const double turn = camera_.fx * (truth_.rotation.y() - used.rotation.y());
    ColumnEstimate estimate;
    estimate.value << turn + truth_.column_offset - used.column_offset, turn,
        camera_.fx * (truth_.focal_ratio - used.focal_ratio), camera_.fx * (truth_.radial - used.radial);
    for (double& value : estimate.value) value += sigma * random_.normal();
    estimate.information.diagonal().setConstant(1.0 / (sigma * sigma));
    return estimate;
  }
  void learn_columns(StereoCalibration& calibration, int windows, double sigma) {
    for (int window = 0; window < windows; ++window)
      calibration.learn_columns(columns(calibration.errors(), sigma), calibration.errors(), true);
  }

  Random random_{3};
  Camera camera_;
  PairErrors truth_;
};

TEST_F(StereoCalibrationTest, RowsDetermineRollPitchAndFocalRatioAndMotionTheRest) {
  truth_.rotation = {0.001, -0.0008, 0.0012};
  truth_.focal_ratio = 1.002;
  truth_.column_offset = 0.3;
  StereoCalibration calibration(camera_, {}, true);
  learn_rows(calibration, 10);
  EXPECT_EQ(calibration.errors().rotation.y(), 0.0) << "no motion yet";
  EXPECT_EQ(calibration.estimate().rotation_sigma.y(), 0.0);
  EXPECT_EQ(calibration.estimate().shift_sigma, 0.0);
  learn_columns(calibration, 4, 0.03);
  const PairEstimate found = calibration.estimate();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(found.errors.rotation[axis], truth_.rotation[axis], 1e-4) << axis;
    EXPECT_GT(found.rotation_sigma[axis], 0.0) << axis;
    EXPECT_LT(found.rotation_sigma[axis], 2e-4) << axis;
  }
  EXPECT_NEAR(found.errors.focal_ratio, 1.002, 2e-4);
  EXPECT_NEAR(found.errors.column_offset, 0.3, 0.1);
  EXPECT_NEAR(found.shift, camera_.fx * -0.0008 + 0.3, 0.05);
  EXPECT_NEAR(found.shift_sigma, 0.021, 0.007);
}

TEST_F(StereoCalibrationTest, CorrectedDisparitiesAndRowsAreThoseOfAPerfectPair) {
  truth_.rotation = {0.001, -0.0008, 0.0012};
  truth_.focal_ratio = 1.002;
  StereoCalibration calibration(camera_, {}, true);
  learn_rows(calibration, 20);
  learn_columns(calibration, 4, 0.03);
  double before = 0.0, after = 0.0, rows_before = 0.0, rows_after = 0.0;
  const PairErrors errors = calibration.errors();
  for (const Sight& s : look(500)) {
    before += std::abs(s.x - s.right_x - s.disparity);
    after += std::abs(s.x - s.right_x + errors.column(camera_, s.right_x, s.y) - s.disparity);
    rows_before += std::abs(s.right_y - s.y);
    rows_after += std::abs(s.right_y - s.y - errors.row(camera_, s.right_x, s.y));
  }
  EXPECT_LT(after, 0.1 * before);
  EXPECT_LT(rows_after, 0.2 * rows_before);
}

/// The estimate of a growing window replaces the one before: the same keyframes do not count twice.
TEST_F(StereoCalibrationTest, AWindowCountsOnce) {
  truth_.column_offset = 0.5;
  StereoCalibration once(camera_, {}, true), often(camera_, {}, true);
  const ColumnEstimate estimate = columns({}, 0.04);
  once.learn_columns(estimate, {}, true);
  for (int i = 0; i < 5; ++i) often.learn_columns(estimate, {}, i == 4);
  EXPECT_EQ(once.estimate().shift_sigma, often.estimate().shift_sigma);
  once.learn_columns(estimate, {}, true);
  EXPECT_LT(once.estimate().shift_sigma, 0.8 * often.estimate().shift_sigma);
}

TEST_F(StereoCalibrationTest, ARestOfDistortionIsTakenNeitherForRollNorForAFocalLength) {
  StereoCalibration calibration(camera_, {}, true);
  for (int frame = 0; frame < 10; ++frame) {
    std::vector<RowDifference> rows;
    for (const Sight& s : look(400)) {
      // Facades: most points are above the middle.
      const double x = (s.x - camera_.cx) / camera_.fx, y = (0.5 * s.y - camera_.cy) / camera_.fy;
      rows.push_back({s.x, 0.5 * s.y, 7.0 * x * y + 0.7 * random_.normal(), 0.7});
    }
    calibration.learn_rows(rows);
  }
  EXPECT_EQ(calibration.errors().rotation, PairErrors().rotation);
  EXPECT_EQ(calibration.errors().focal_ratio, 1.0);
  EXPECT_NEAR(calibration.errors().row_product() * camera_.fy, 7.0, 0.7);
}

/// Brown's model of a lens, and the errors that PairErrors says are those of it.
TEST_F(StereoCalibrationTest, ALensWithRadialAndDecentringDistortionIsDescribed) {
  constexpr double turn = 0.0005, k1 = -0.003, p2 = -0.006;
  PairErrors errors;
  errors.rotation.y() = turn + 3.0 * p2;
  errors.column_offset = -3.0 * p2 * camera_.fx;
  errors.radial = k1;
  errors.decentring = p2;
  for (const double column : {30.0, 400.0, 700.0, 1190.0})
    for (const double row : {10.0, 100.0, 250.0, 360.0}) {
      const Eigen::Vector2d at = camera_.normalised(column, row);
      const double x = at.x(), y = at.y(), square = at.squaredNorm();
      const double dx = turn * (1.0 + x * x) + k1 * x * square + p2 * (square + 2.0 * x * x);
      const double dy = turn * x * y + k1 * y * square + 2.0 * p2 * x * y;
      EXPECT_NEAR(errors.column(camera_, column, row), camera_.fx * dx, 1e-9);
      EXPECT_NEAR(errors.row(camera_, column, row), camera_.fy * dy, 1e-9);
    }
}

/// Motion tells c + q r^2, rows the product x y; the rest of both is that of a lens.
TEST_F(StereoCalibrationTest, DecentringFollowsFromRowsAndMotion) {
  truth_.rotation.y() = 0.8 / camera_.fx;
  truth_.column_offset = -0.7;
  truth_.decentring = (0.8 - 6.5) / camera_.fx;
  StereoCalibration calibration(camera_, {}, true);
  learn_modelled_rows(calibration, 20, 400, 0.7);
  EXPECT_NEAR(calibration.errors().row_product() * camera_.fy, 6.5, 0.5);
  EXPECT_EQ(calibration.errors().rotation.y(), 0.0) << "no motion yet";
  learn_columns(calibration, 4, 0.05);
  const PairErrors found = calibration.errors();
  EXPECT_NEAR(found.row_product() * camera_.fy, 6.5, 0.5);
  EXPECT_NEAR(found.decentring * camera_.fx, 0.8 - 6.5, 0.6);
  for (const double column : {30.0, 700.0, 1190.0})
    for (const double row : {10.0, 250.0, 360.0})
      EXPECT_NEAR(found.column(camera_, column, row), truth_.column(camera_, column, row), 0.15)
          << column << ' ' << row;
}

TEST_F(StereoCalibrationTest, RadialDistortionShowsInRowsToo) {
  truth_.radial = -6.0 / camera_.fx;
  StereoCalibration calibration(camera_, {}, true);
  learn_modelled_rows(calibration, 60, 800, 0.3);
  EXPECT_NEAR(calibration.errors().radial * camera_.fx, -6.0, 1.0);
}

TEST_F(StereoCalibrationTest, MotionAloneDeterminesTheRatioOfFocalLengths) {
  truth_.focal_ratio = 1.001;
  StereoCalibration calibration(camera_, {}, true);
  learn_columns(calibration, 4, 0.1);
  EXPECT_NEAR(calibration.errors().focal_ratio, 1.001, 3e-4);
  EXPECT_EQ(calibration.estimate().rotation_sigma.x(), 0.0) << "of rows only";
}

/// What is in use stays in use, also where a later estimate would not begin it.
TEST_F(StereoCalibrationTest, RadialDistortionInUseStays) {
  truth_.radial = -1.5 / camera_.fx;
  StereoCalibration calibration(camera_, {}, true);
  learn_columns(calibration, 4, 0.1);
  ASSERT_NE(calibration.errors().radial, 0.0);
  truth_.radial = 0.0;
  learn_columns(calibration, 40, 0.1);
  EXPECT_NE(calibration.errors().radial, 0.0);
  EXPECT_NEAR(calibration.errors().radial * camera_.fx, -1.5 * 4.0 / 44.0, 0.1);
}

TEST_F(StereoCalibrationTest, RadialDistortionIsFoundByMotionWhereItIsSignificant) {
  for (const double pixels : {-2.0, 0.1}) {
    truth_.radial = pixels / camera_.fx;
    StereoCalibration calibration(camera_, {}, true);
    learn_columns(calibration, 4, 0.1);
    if (pixels < -1.0) {
      EXPECT_NEAR(calibration.errors().radial * camera_.fx, pixels, 0.3);
      EXPECT_GT(calibration.estimate().radial_sigma, 0.0);
    } else {
      EXPECT_EQ(calibration.errors().radial, 0.0);
    }
  }
}

/// Ratio and radial distortion displace columns by 0.06 and 0.05 px at the border, which alone is not worth a
/// correction.
TEST_F(StereoCalibrationTest, ColumnsThatAreCorrectedAreCorrectedInFull) {
  truth_.focal_ratio = 1.0001;
  truth_.radial = 1e-4;
  for (const double turn : {0.0, 0.001}) {
    truth_.rotation.y() = turn;
    StereoCalibration calibration(camera_, {}, true);
    learn_columns(calibration, 8, 0.01);
    const PairErrors found = calibration.errors();
    if (turn == 0.0) {
      EXPECT_EQ(found, PairErrors());
      continue;
    }
    EXPECT_NEAR(found.rotation.y(), turn, 3e-5);
    EXPECT_NEAR(found.focal_ratio, 1.0001, 3e-5);
    EXPECT_NEAR(found.radial, 1e-4, 3e-5);
  }
}

TEST_F(StereoCalibrationTest, APerfectPairIsLeftAlone) {
  StereoCalibration calibration(camera_, {}, true);
  learn_rows(calibration, 30);
  learn_columns(calibration, 30, 0.05);
  EXPECT_EQ(calibration.errors(), PairErrors());
}

TEST_F(StereoCalibrationTest, ErrorsThatMotionDoesNotDetermineAreNotUsed) {
  truth_.column_offset = 0.7;
  StereoCalibration calibration(camera_, {}, true);
  calibration.learn_columns(columns({}, 0.5), {}, true);
  EXPECT_EQ(calibration.errors(), PairErrors());
}

/// The term of columns by r^2 is several times less certain than the constant one.
TEST_F(StereoCalibrationTest, ATurnIsTheCauseOfColumnsUnlessMotionContradictsIt) {
  const double turn = 0.001 * camera_.fx;  // px
  const auto errors_after = [&](const Eigen::Vector2d& found, const PairErrors& given) {
    ColumnEstimate estimate;
    estimate.value.head<2>() = found;
    estimate.information.diagonal() << 1.0 / (0.02 * 0.02), 1.0 / (0.06 * 0.06), 1.0 / (0.1 * 0.1), 1.0 / (0.2 * 0.2);
    StereoCalibration calibration(camera_, given, true);
    calibration.learn_columns(estimate, given, true);
    return calibration.errors();
  };
  const PairErrors of_noise = errors_after({turn + 0.01, turn - 0.18}, {});
  EXPECT_NEAR(of_noise.rotation.y(), 0.001, 3e-5);
  EXPECT_NEAR(of_noise.column_offset, 0.0, 1e-9);
  const PairErrors of_lens = errors_after({turn, turn + 0.8}, {});
  EXPECT_NEAR(of_lens.column_offset, -0.8, 0.02);
  // What is given is contradicted by motion only, too.
  const PairErrors turned_later = errors_after({turn + 0.01, turn - 0.18}, of_lens);
  EXPECT_NEAR(turned_later.rotation.y(), of_lens.rotation.y() + 0.001, 4e-5);
  EXPECT_NEAR(turned_later.column_offset, of_lens.column_offset, 1e-9);
}

TEST_F(StereoCalibrationTest, FixedErrorsStay) {
  truth_.rotation = {0.001, -0.0008, 0.0012};
  PairErrors given;
  given.rotation = {0.0, 0.0005, 0.0};
  StereoCalibration calibration(camera_, given, false);
  learn_rows(calibration, 5);
  calibration.learn_columns(columns({}, 0.01), {}, true);
  EXPECT_EQ(calibration.errors(), given);
  EXPECT_FALSE(calibration.is_estimated());
}

}  // namespace
}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <ostream>

#include <cstdlib>

#include "holdfast/evaluation/evaluation.hpp"

namespace holdfast {
namespace {

// Trajectories that others published for TUM sequences. The expected figures were computed with the TUM benchmark's
// evaluation scripts, to the digits printed here.

std::filesystem::path data_folder() {
  const char* folder = std::getenv("HOLDFAST_DATA");
  return folder ? folder : "";
}

struct Expected {
  const char* estimate;
  const char* sequence;
  std::size_t pairs;
  double rmse, mean, median, maximum;              // ATE [m]
  double relative_translation, relative_rotation;  // RPE per second, RMSE [m], [deg]

  friend void PrintTo(const Expected& expected, std::ostream* stream) { *stream << expected.estimate; }
};

class PublishedTrajectory : public ::testing::TestWithParam<Expected> {};

TEST_P(PublishedTrajectory, HasTheBenchmarksFigures) {
  const std::filesystem::path folder = data_folder() / "tum_fr3";
  if (data_folder().empty() || !std::filesystem::exists(folder))
    GTEST_SKIP() << "set HOLDFAST_DATA to a folder that holds tum_fr3";
  const Expected& expected = GetParam();
  const std::string sequence = std::string("fr3_") + expected.sequence + ".txt";
  const Evaluation evaluation =
      evaluate(read_trajectory(folder / "groundtruth" / sequence),
               read_trajectory(folder / "published" / (std::string(expected.estimate) + ".txt")), {},
               read_frame_stamps(folder / "associations" / sequence));
  constexpr double last_digit = 0.5000001e-6;
  EXPECT_EQ(evaluation.poses.size(), expected.pairs);
  EXPECT_NEAR(evaluation.absolute_error.rmse, expected.rmse, last_digit);
  EXPECT_NEAR(evaluation.absolute_error.mean, expected.mean, last_digit);
  EXPECT_NEAR(evaluation.absolute_error.median, expected.median, last_digit);
  EXPECT_NEAR(evaluation.absolute_error.maximum, expected.maximum, last_digit);
  EXPECT_NEAR(evaluation.error_per_time.translation.rmse, expected.relative_translation, last_digit);
  EXPECT_NEAR(evaluation.error_per_time.rotation.rmse, expected.relative_rotation, last_digit);
  EXPECT_TRUE(evaluation.warnings.empty()) << evaluation.warnings.front().message;
  ASSERT_TRUE(evaluation.coverage.has_value());
  EXPECT_EQ(evaluation.coverage->poses, evaluation.estimate_poses) << "every pose has the stamp of a frame";
  EXPECT_EQ(evaluation.coverage->ratio() < 1.0, std::string(expected.estimate) == "walking_xyz_orbslam2");
}

INSTANTIATE_TEST_SUITE_P(Tum, PublishedTrajectory,
                         ::testing::Values(Expected{"walking_xyz_dyna", "walking_xyz", 826, 0.015449, 0.013397,
                                                    0.011407, 0.058548, 0.019365, 0.602667},
                                           Expected{"walking_xyz_orbslam2", "walking_xyz", 680, 0.656076, 0.562545,
                                                    0.587079, 1.502284, 0.366183, 6.924481},
                                           Expected{"walking_static_orbslam2", "walking_static", 714, 0.378868,
                                                    0.345465, 0.289259, 0.660806, 0.212673, 3.813051},
                                           Expected{"walking_static_dyna", "walking_static", 714, 0.013178, 0.011447,
                                                    0.010252, 0.036711, 0.012994, 0.313914},
                                           Expected{"sitting_xyz_dyna", "sitting_xyz", 1216, 0.011730, 0.010308,
                                                    0.009486, 0.076597, 0.013358, 0.509499},
                                           Expected{"walking_halfsphere_dyna", "walking_halfsphere", 1018, 0.027084,
                                                    0.024131, 0.022680, 0.073258, 0.025507, 0.737192}),
                         [](const auto& tested) { return tested.param.estimate; });

TEST(PublishedTrajectories, WithScaleOtherPairingAndOtherStep) {
  const std::filesystem::path folder = data_folder() / "tum_fr3";
  if (data_folder().empty() || !std::filesystem::exists(folder))
    GTEST_SKIP() << "set HOLDFAST_DATA to a folder that holds tum_fr3";
  const Trajectory truth = read_trajectory(folder / "groundtruth" / "fr3_walking_xyz.txt");
  const Trajectory estimate = read_trajectory(folder / "published" / "walking_xyz_orbslam2.txt");
  EvaluationOptions options;
  options.max_time_difference = 0.01;
  options.time_step = 0.5;
  const RelativeError relative = evaluate(truth, estimate, options).error_per_time;
  EXPECT_EQ(relative.pairs, 676u);
  EXPECT_NEAR(relative.translation.rmse, 0.22097641122922432, 1e-9);
  EXPECT_NEAR(relative.translation.median, 0.10813290225457892, 1e-9);
  EXPECT_NEAR(relative.rotation.rmse, 4.1812073415229385, 1e-8);
  EXPECT_NEAR(relative.rotation.maximum, 17.396291232313278, 1e-8);

  options.alignment = AlignmentKind::sim3;
  const Evaluation evaluation = evaluate(truth, estimate, options);
  EXPECT_NEAR(evaluation.alignment.scale, 0.14925481858730152, 1e-9);
  EXPECT_NEAR(evaluation.absolute_error.rmse, 0.29170781187722816, 1e-9);
  EXPECT_NEAR(evaluation.absolute_error.maximum, 0.6438298797527378, 1e-9);
  EXPECT_NEAR(evaluation.path_length, 5.744688570147851, 1e-9);
}

TEST(PublishedTrajectories, FramesOfASequenceAreItsColourDepthPairs) {
  const std::filesystem::path folder = data_folder() / "tum_fr1_xyz";
  if (data_folder().empty() || !std::filesystem::exists(folder))
    GTEST_SKIP() << "set HOLDFAST_DATA to a folder that holds tum_fr1_xyz";
  EXPECT_EQ(read_frame_stamps(folder).size(), 792u);
  EXPECT_EQ(read_frame_stamps(folder / "rgb.txt").size(), 798u);
}

}  // namespace
}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/coverage.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Stamps = std::vector<double>;

TEST(Coverage, CountsGapsAsMissing) {
  const Stamps frames{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  const Stamps poses{1, 2, 5, 6, 7, 8};  // missing: 0; 3 and 4; 9
  const Coverage coverage = measure_coverage(frames, poses);
  EXPECT_EQ(coverage.frames, 10u);
  EXPECT_EQ(coverage.poses, 6u);
  EXPECT_DOUBLE_EQ(coverage.ratio(), 0.6);
  ASSERT_EQ(coverage.gaps.size(), 3u);
  EXPECT_EQ(coverage.longest_gap(), 2u);
  EXPECT_EQ(coverage.gaps[0].begin, 0.0);
  EXPECT_EQ(coverage.gaps[0].end, 1.0);
  EXPECT_EQ(coverage.gaps[1].begin, 2.0);
  EXPECT_EQ(coverage.gaps[1].end, 5.0);
  EXPECT_EQ(coverage.gaps[1].frames, 2u);
  EXPECT_EQ(coverage.gaps[2].begin, 8.0);
  EXPECT_EQ(coverage.gaps[2].end, 9.0);
}

TEST(Coverage, DoesNotCountPosesOfNoFrame) {
  const Stamps frames{0.0, 0.1, 0.2, 0.3};
  const Stamps poses{0.0, 0.0005, 0.05, 0.1001, 0.15, 0.198};  // 0.0005 comes second, 0.198 is 2 ms off
  const Coverage coverage = measure_coverage(frames, poses);
  EXPECT_EQ(coverage.poses, 2u);
  EXPECT_EQ(coverage.poses_of_no_frame, 4u);
  EXPECT_DOUBLE_EQ(coverage.ratio(), 0.5);
}

TEST(Coverage, OfNoPoseIsOneGap) {
  const Coverage coverage = measure_coverage(Stamps{1.0, 2.0, 3.0}, {});
  EXPECT_EQ(coverage.ratio(), 0.0);
  ASSERT_EQ(coverage.gaps.size(), 1u);
  EXPECT_EQ(coverage.gaps[0].frames, 3u);
}

TEST(Coverage, OfEveryFrameHasNoGap) {
  const Coverage coverage = measure_coverage(Stamps{1.0, 2.0}, Stamps{1.0, 2.0});
  EXPECT_EQ(coverage.ratio(), 1.0);
  EXPECT_TRUE(coverage.gaps.empty());
  EXPECT_EQ(coverage.longest_gap(), 0u);
}

class FrameList : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("holdfast_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name) << content;
    return folder_ / name;
  }
  static std::string error_of(const std::filesystem::path& source) {
    try {
      read_frame_stamps(source);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  std::filesystem::path folder_;
};

TEST_F(FrameList, ReadsTheFirstColumnOfAList) {
  EXPECT_THAT(read_frame_stamps(write("a.txt",
                                      "# timestamp filename\n2.5 rgb/b.png 2.6 depth/b.png\r\n\n1.5 rgb/a.png\n"
                                      "2.5 rgb/b.png\n")),
              ElementsAre(1.5, 2.5));
}

TEST_F(FrameList, SkipsAByteOrderMark) {
  EXPECT_THAT(read_frame_stamps(write("a.txt",
                                      "\xef\xbb\xbf"
                                      "1.5 a.png\n")),
              ElementsAre(1.5));
}

TEST_F(FrameList, PairsColourAndDepthOfAFolder) {
  write("rgb.txt", "1.00 rgb/a\n1.03 rgb/b\n1.06 rgb/c\n1.09 rgb/d\n");
  write("depth.txt", "1.001 depth/a\n1.028 depth/b\n1.2 depth/x\n1.071 depth/c\n");
  EXPECT_THAT(read_frame_stamps(folder_), ElementsAre(1.00, 1.03, 1.06));  // 1.071 is nearer to 1.06 than to 1.09
}

TEST_F(FrameList, NamesTheLineOfAnError) {
  EXPECT_THAT(error_of(write("a.txt", "1.0 rgb/a\nrgb/b 2.0\n")), HasSubstr("a.txt:2: found 'rgb/b 2.0'"));
  EXPECT_THAT(error_of(write("a.txt", "1.0x rgb/a\n")), HasSubstr("a.txt:1:"));
  EXPECT_THAT(error_of(write("a.txt", "# nothing\n")), HasSubstr("a.txt: holds no frame"));
}

TEST_F(FrameList, NamesWhatIsMissing) {
  EXPECT_THAT(error_of(folder_ / "absent"), HasSubstr("no such file or folder"));
  write("rgb.txt", "1.0 rgb/a\n");
  EXPECT_THAT(error_of(folder_), HasSubstr("depth.txt: no such file"));
  write("depth.txt", "1.5 depth/a\n");
  EXPECT_THAT(error_of(folder_), HasSubstr("no colour frame of rgb.txt has a depth frame"));
}

}  // namespace
}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/cloud_ply.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class CloudPlyTest : public ::testing::Test {
 protected:
  ~CloudPlyTest() override {
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
  void write(const std::string& bytes) const { std::ofstream(file_, std::ios::binary) << bytes; }
  std::string refusal(const std::string& bytes) const {
    write(bytes);
    try {
      read_cloud_ply(file_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  }

  fs::path file_ = fs::temp_directory_path() / ("cloud_ply_test." + std::to_string(getpid()) + ".ply");
  std::vector<CloudPoint> cloud_{{1.5F, -2, 3, 4, 5, 255}, {0, 0, 1e-3F, 0, 10, 13}};
};

TEST_F(CloudPlyTest, ReadsWhatItWrites) {
  for (const std::vector<CloudPoint>& cloud : {cloud_, std::vector<CloudPoint>()}) {
    write_cloud_ply(file_, cloud);
    EXPECT_EQ(read_cloud_ply(file_), cloud);
  }
}

TEST_F(CloudPlyTest, LeavesOtherCloudsAlone) {
  write("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n");
  EXPECT_EQ(read_cloud_ply(file_), std::nullopt);
  write("ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nend_header\n");
  EXPECT_EQ(read_cloud_ply(file_), std::nullopt);
}

TEST_F(CloudPlyTest, SaysWhatIsWrong) {
  const std::string good = cloud_ply(cloud_);
  EXPECT_EQ(refusal(good), "taken");
  EXPECT_THAT(refusal("points"), HasSubstr("is no PLY file"));
  EXPECT_THAT(refusal(good.substr(0, 40)), HasSubstr("its header has no end"));
  for (const std::size_t length : {good.size() - 1, good.size() - 15})
    EXPECT_THAT(refusal(good.substr(0, length)), HasSubstr("states 2 points and has"));
  EXPECT_THAT(refusal(good + std::string(15, '\0')), HasSubstr("states 2 points and has 45 bytes"));
  for (const char* count : {"-1", "18446744073709551617", "two", ""}) {
    std::string bytes = good;
    bytes.replace(bytes.find("vertex 2") + 7, 1, count);
    EXPECT_THAT(refusal(bytes), HasSubstr("points and has")) << count;
  }
  std::string bytes = good;
  bytes.replace(bytes.size() - 30, 4, std::string("\0\0\xc0\x7f", 4));
  EXPECT_THAT(refusal(bytes), HasSubstr("not finite"));
  fs::remove(file_);
  EXPECT_THROW(read_cloud_ply(file_), InputError);
}

}  // namespace
}  // namespace holdfast

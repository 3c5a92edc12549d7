// SPDX-License-Identifier: BSD-3-Clause
// Lists of images, associations and time stamps, and inertial measurements.
#include <cmath>

#include "fuzz.hpp"
#include "holdfast/core/imu_plausibility.hpp"
#include "holdfast/image_files/image_list.hpp"
#include "holdfast/image_files/recorded_imu.hpp"

using namespace holdfast;

namespace {

void check(const std::vector<ListedImage>& images) {
  fuzz::require(!images.empty(), "an accepted list is not empty");
  for (std::size_t i = 0; i < images.size(); ++i) {
    fuzz::require(std::isfinite(images[i].timestamp), "stamps are finite");
    fuzz::require(i == 0 || images[i - 1].timestamp < images[i].timestamp, "stamps increase strictly");
    stamp_text(images[i].timestamp);
  }
}

void check(const std::vector<ImuSample>& samples) {
  fuzz::require(!samples.empty(), "accepted measurements are not empty");
  std::string text = imu_header;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    fuzz::require(std::isfinite(samples[i].timestamp), "stamps are finite");
    fuzz::require(samples[i].angular_velocity.allFinite() && samples[i].acceleration.allFinite(), "values are finite");
    fuzz::require(i == 0 || samples[i - 1].timestamp < samples[i].timestamp, "stamps increase strictly");
    text += imu_sample_text(samples[i]);
  }
  imu_suspicions(samples);
  const auto written =
      fuzz::folder().write("written.csv", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  fuzz::require(read_imu_samples(written) == samples, "what is written is read as it was");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("list.txt", {data, size});
  fuzz::accepts([&] { check(read_image_list(file)); });
  fuzz::accepts([&] { check(read_stamp_list(file)); });
  fuzz::accepts([&] { read_association_list(file); });
  fuzz::accepts([&] { check(read_imu_samples(file)); });
  return 0;
}

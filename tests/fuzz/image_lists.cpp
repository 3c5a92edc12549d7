// SPDX-License-Identifier: BSD-3-Clause
// Lists of images, associations and time stamps.
#include <cmath>

#include "fuzz.hpp"
#include "holdfast/image_files/image_list.hpp"

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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("list.txt", {data, size});
  fuzz::accepts([&] { check(read_image_list(file)); });
  fuzz::accepts([&] { check(read_stamp_list(file)); });
  fuzz::accepts([&] { read_association_list(file); });
  return 0;
}

// SPDX-License-Identifier: BSD-3-Clause
// Label maps, as after --label-map and in classes.yaml, applied to an image.
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "fuzz.hpp"
#include "label_folder.hpp"

using namespace holdfast;

namespace {

std::filesystem::path folder_with_image() {
  const std::filesystem::path file = fuzz::folder().path() / "image.png";
  cv::imwrite(file.string(), cv::Mat_<std::uint8_t>({1, 4}, {0, 1, 7, 255}));
  return file;
}

void read(const std::filesystem::path& image, const std::string& map) {
  fuzz::accepts([&] {
    LabelFolder labels(image.parent_path(), map, "--label-map");
    fuzz::require(labels.classes().size() <= 255, "labels fit into a byte");
    labels.read(image);
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path image = folder_with_image();
  fuzz::folder().write("classes.yaml", {data, size});
  read(image, fuzz::text_of({data, size}));
  read(image, "");
  return 0;
}

// SPDX-License-Identifier: BSD-3-Clause
// Masks that others wrote, for the segmenter `precomputed`: an array of NumPy, an archive of arrays, or annotations in
// COCO's JSON, as the first byte says; the rest is the file.
#include <algorithm>
#include <opencv2/core.hpp>

#include "coco_masks.hpp"
#include "fuzz.hpp"
#include "label_array.hpp"

using namespace holdfast;
using namespace holdfast::precomputed_plugin;

namespace {

constexpr int most_pixels = 1 << 16;  // of an image whose masks are drawn

void read_arrays(const std::filesystem::path& file) {
  const LabelArray array = read_label_array(file);
  fuzz::require(array.is_of_instances || array.images.size() == 1, "labels are one image");
  for (const cv::Mat& image : array.images)
    fuzz::require(image.type() == CV_16UC1 && image.size() == array.images.front().size(), "images have one size");
}

void read_annotations(const std::filesystem::path& file) {
  const CocoFile coco = read_coco(file);
  for (std::size_t i = 0; i < coco.images.size(); ++i) {
    const CocoImage& image = coco.images[i];
    fuzz::require(i == 0 || coco.images[i - 1].timestamp < image.timestamp, "time stamps increase");
    if (image.size.area() == 0 || image.size.area() > most_pixels) continue;
    for (const CocoObject& object : image.objects) {
      const bool has_category = std::any_of(coco.categories.begin(), coco.categories.end(), [&](const auto& category) {
        return category.first == std::to_string(object.category);
      });
      fuzz::require(has_category, "an object's category is in the table");
      fuzz::require(object.score >= 0.0F && object.score <= 1.0F, "a score is in its range");
      fuzz::require(mask_of(object, image.size).size() == image.size, "a mask has the size of its image");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const fuzz::Bytes bytes = {data + 1, size - 1};
  const int format = data[0] % 3;
  const std::filesystem::path file = fuzz::folder().write(format == 0   ? "a.npy"
                                                          : format == 1 ? "a.npz"
                                                                        : "a.json",
                                                          bytes);
  fuzz::accepts([&] { format == 2 ? read_annotations(file) : read_arrays(file); });
  return 0;
}

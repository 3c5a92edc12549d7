// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "holdfast/bridge/messages.hpp"

namespace holdfast::bridge {

enum class ImageKind : std::uint8_t { colour, depth, right };

/// An image with its stamp and the time of its arrival on a steady clock [s].
struct StampedImage {
  Stamp stamp = 0;
  cv::Mat image;
  double arrival = 0.0;
};

/// The images of a frame. Images of kinds that a frame does not have are empty.
struct ImageSet {
  StampedImage colour, depth, right;
  double arrival() const;  ///< of the image that came last [s]
};

/// Pairs each colour image with the depth image and the right image nearest to it in time, as soon as these are
/// certain. ROS' approximate synchroniser waits for the next image of each topic, up to a period longer: here a partner
/// is certain as well if it is nearer than half the usual period of its topic. One thread.
class ImagePairing {
 public:
  ImagePairing(bool has_depth, bool has_right, Stamp tolerance);

  /// Adds an image; those of one kind may come in any order. An image that is not after the last set is dropped.
  void add(ImageKind kind, StampedImage image);
  /// The next set, by stamp; nothing if more images must come first.
  std::optional<ImageSet> next();
  /// Forgets all images and stamps.
  void clear();

  /// Colour images without a partner within the tolerance.
  std::uint64_t unpaired() const { return unpaired_; }
  std::optional<Stamp> last_stamp() const { return last_; }

 private:
  struct Topic {
    bool is_needed = false;
    std::deque<StampedImage> images;  // by stamp
    std::optional<Stamp> newest;
    double period = 0.0;  // usual time between two images [ns]; 0 = unknown
  };
  enum class Answer : std::uint8_t { found, wait, none };

  Topic& topic(ImageKind kind) { return topics_[static_cast<std::size_t>(kind)]; }
  Answer find(const Topic& topic, Stamp stamp, std::size_t& best) const;
  void drop_oldest_colour();

  Stamp tolerance_;
  std::array<Topic, 3> topics_;
  std::optional<Stamp> last_;
  std::uint64_t unpaired_ = 0;
};

}  // namespace holdfast::bridge

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {

/// Where a frame lies in a network's input: a rectangle of whole pixels, all of the input if it is stretched, otherwise
/// in its centre (letterbox).
struct FramePlace {
  cv::Size frame, input;
  cv::Rect content;

  /// The part of a box of the input that lies in the frame, in the frame's pixels; empty if there is none.
  cv::Rect2f box_in_frame(const cv::Rect2f& box) const;
};

/// The place of a frame in an input. A letterbox keeps the aspect ratio up to rounding.
FramePlace place_of_frame(const cv::Size& frame, const cv::Size& input, bool letterbox);

/// The pixels of an image that a box covers: those with their centre in it, and at least one of each axis. Empty for a
/// box without area or outside the image.
cv::Rect pixels_of(const cv::Rect2f& box, const cv::Size& image);

/// The mask of an object as YOLACT defines it (Bolya et al., ICCV 2019): the linear combination of the prototypes
/// (32F, 1 x coefficients x height x width, an image of the input) with its coefficients, resized bilinearly to the
/// frame, where it is positive. 8UC1 of the size of `pixels`, a rectangle of the frame: 255 = object. Values that are
/// not finite are none of the object's.
cv::Mat prototype_mask(const cv::Mat& prototypes, std::span<const float> coefficients, const FramePlace& place,
                       const cv::Rect& pixels);

/// The mask of an object from an image of its own (32F): its values, resized bilinearly from the part `covered` of the
/// network's input that it shows, where they are above `threshold`. 8UC1 of the size of `pixels`, a rectangle of the
/// frame: 255 = object. Values that are not finite are none of the object's.
cv::Mat image_mask(const cv::Mat& image, const cv::Rect2f& covered, float threshold, const FramePlace& place,
                   const cv::Rect& pixels);

/// The mask of an object in a box by depth: the pixels whose depth is at most 0.25 m before or behind the largest
/// cluster of depths in the middle of the box, half as wide and half as high as the box, and those without depth.
/// Clusters are separated by gaps of 0.1 m, or of 3 % of the depth if that is more. All of the box without a depth
/// image, and where less than a tenth of its middle has depth. 8UC1 of the size of `pixels`, a rectangle of the frame:
/// 255 = object.
cv::Mat depth_mask(const cv::Mat& depth, const cv::Rect& pixels);

/// An object and its mask.
struct ObjectMask {
  Instance instance;
  cv::Rect pixels = {};     ///< of the frame
  cv::Mat mask = {};        ///< 8UC1 of the size of `pixels`: 255 = object
  bool is_movable = false;  ///< its class can move
};

/// Joins objects, by decreasing score, to a segmentation with instances. Where masks overlap, a movable object covers
/// others, then the higher score. The confidence of an object's pixel is (1 + score) / 2, as that of a network which
/// decides between two classes; other pixels are background, label 0, and certain.
Segmentation join_objects(const std::vector<ObjectMask>& objects, const cv::Size& frame);

}  // namespace holdfast

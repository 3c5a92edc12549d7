// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/core.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <stdexcept>
#include <string>

namespace cv_bridge {

class Exception : public std::runtime_error {
 public:
  explicit Exception(const std::string& description);
};

class CvImage {
 public:
  std_msgs::msg::Header header;
  std::string encoding;
  cv::Mat image;

  CvImage();
  CvImage(const std_msgs::msg::Header& header, const std::string& encoding, const cv::Mat& image = cv::Mat());
  sensor_msgs::msg::Image::SharedPtr toImageMsg() const;
  void toImageMsg(sensor_msgs::msg::Image& ros_image) const;
};
using CvImagePtr = std::shared_ptr<CvImage>;
using CvImageConstPtr = std::shared_ptr<CvImage const>;

CvImagePtr toCvCopy(const sensor_msgs::msg::Image::ConstSharedPtr& source, const std::string& encoding = std::string());
CvImageConstPtr toCvShare(const sensor_msgs::msg::Image::ConstSharedPtr& source,
                          const std::string& encoding = std::string());

}  // namespace cv_bridge

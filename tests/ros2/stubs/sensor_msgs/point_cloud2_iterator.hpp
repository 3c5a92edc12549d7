// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <string>

namespace sensor_msgs {

class PointCloud2Modifier {
 public:
  explicit PointCloud2Modifier(msg::PointCloud2& cloud);
  std::size_t size() const;
  void reserve(std::size_t size);
  void resize(std::size_t size);
  void clear();
  void setPointCloud2Fields(int n_fields, ...);
  void setPointCloud2FieldsByString(int n_fields, ...);
};

template <typename T>
class PointCloud2Iterator {
 public:
  PointCloud2Iterator(msg::PointCloud2& cloud, const std::string& field_name);
  T& operator[](std::size_t i) const;
  T& operator*() const;
  PointCloud2Iterator& operator++();
  PointCloud2Iterator operator+(int i);
  PointCloud2Iterator& operator+=(int i);
  bool operator!=(const PointCloud2Iterator& other) const;
  PointCloud2Iterator end() const;
};

}  // namespace sensor_msgs

// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/descriptor.hpp"

#include <cmath>
#include <cstring>

#include "holdfast/core/check.hpp"

namespace holdfast {

std::size_t DescriptorType::bytes() const {
  switch (kind) {
    case DescriptorKind::binary:
      return (static_cast<std::size_t>(length) + 7) / 8;
    case DescriptorKind::float32:
      return static_cast<std::size_t>(length) * sizeof(float);
    case DescriptorKind::int8:
      return length;
  }
  return 0;
}

const char* to_string(DescriptorKind kind) {
  switch (kind) {
    case DescriptorKind::binary:
      return "binary";
    case DescriptorKind::float32:
      return "float32";
    case DescriptorKind::int8:
      return "int8";
  }
  return "?";
}

const char* to_string(DescriptorMetric metric) {
  switch (metric) {
    case DescriptorMetric::hamming:
      return "hamming";
    case DescriptorMetric::euclidean:
      return "euclidean";
    case DescriptorMetric::cosine:
      return "cosine";
  }
  return "?";
}

std::string to_string(const DescriptorType& type) {
  const std::string unit = type.kind == DescriptorKind::binary ? "bits" : to_string(type.kind);
  return std::to_string(type.length) + " " + unit + " (" + to_string(type.metric) + ")";
}

std::string trouble_of(const DescriptorType& type) {
  constexpr std::uint32_t longest = 16384;
  if (type.kind > DescriptorKind::int8) return "the kind is unknown; expected binary, float32 or int8";
  if (type.metric > DescriptorMetric::cosine) return "the metric is unknown; expected hamming, euclidean or cosine";
  if (type.length < 1 || type.length > longest)
    return "the length is " + std::to_string(type.length) + "; expected 1 to " + std::to_string(longest);
  if ((type.kind == DescriptorKind::binary) != (type.metric == DescriptorMetric::hamming))
    return std::string("the metric of ") + to_string(type.kind) + " descriptors is " + to_string(type.metric) +
           "; expected hamming for binary ones, euclidean or cosine for others";
  if (!(type.strict_distance > 0.0F) || !(type.loose_distance >= type.strict_distance) ||
      !std::isfinite(type.loose_distance))
    return "the strict and the loose distance are " + std::to_string(type.strict_distance) + " and " +
           std::to_string(type.loose_distance) + "; expected positive numbers, the loose one not below the strict one";
  return "";
}

bool operator==(const DescriptorView& a, const DescriptorView& b) {
  return a.type_ == b.type_ && a.count_ == b.count_ &&
         (a.count_ == 0 || std::memcmp(a.rows_, b.rows_, a.count_ * a.units_ * sizeof(Descriptor256)) == 0);
}

void DescriptorBlock::reset(const DescriptorType& type, std::size_t count) {
  if (type != type_) {
    const std::string trouble = trouble_of(type);
    HOLDFAST_CHECK(trouble.empty(), "descriptors: " << trouble);
    rows_.clear();
    type_ = type;
    units_ = DescriptorView::units_of(type);
  }
  resize(count);
}

std::span<float> DescriptorBlock::numbers(std::size_t i) {
  HOLDFAST_CHECK(type_.kind == DescriptorKind::float32, "descriptors of " << to_string(type_) << ", not of float32");
  return {reinterpret_cast<float*>(&rows_[i * units_]), type_.length};
}

std::span<Descriptor256> DescriptorBlock::of_256_bits() {
  HOLDFAST_CHECK(type_.is_comparable(DescriptorType()), "descriptors of " << to_string(type_) << ", not of 256 bits");
  return rows_;
}

std::span<const Descriptor256> DescriptorBlock::of_256_bits() const {
  HOLDFAST_CHECK(type_.is_comparable(DescriptorType()), "descriptors of " << to_string(type_) << ", not of 256 bits");
  return rows_;
}

void DescriptorBlock::refuse(const DescriptorType& type) const {
  HOLDFAST_CHECK(false, "descriptors of " << to_string(type) << " among those of " << to_string(type_));
}

}  // namespace holdfast

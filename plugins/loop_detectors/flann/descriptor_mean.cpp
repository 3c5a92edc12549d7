// SPDX-License-Identifier: BSD-3-Clause
#include "descriptor_mean.hpp"

#include <bit>
#include <cmath>

namespace holdfast::flann_plugin {

DescriptorMean::DescriptorMean(const DescriptorType& type) : type_(type) {
  if (type.kind == DescriptorKind::binary)
    bits_set_.assign(type.length, 0);
  else
    sums_.assign(type.length, 0.0);
}

void DescriptorMean::add(const Descriptor256* descriptor) {
  ++count_;
  if (type_.kind == DescriptorKind::binary) {
    const std::size_t words = (bits_set_.size() + 63) / 64;
    for (std::size_t i = 0; i < words; ++i)
      for (std::uint64_t rest = descriptor[i / 4].words[i % 4]; rest != 0; rest &= rest - 1)
        ++bits_set_[64 * i + static_cast<std::size_t>(std::countr_zero(rest))];
  } else if (type_.kind == DescriptorKind::float32) {
    const auto* numbers = reinterpret_cast<const float*>(descriptor);
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += numbers[i];
  } else {
    const auto* numbers = reinterpret_cast<const std::int8_t*>(descriptor);
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += numbers[i];
  }
}

void DescriptorMean::write(Descriptor256* descriptor) const {
  if (count_ == 0) return;
  if (type_.kind == DescriptorKind::binary)
    write_majority(descriptor);
  else
    write_numbers(descriptor);
}

void DescriptorMean::write_majority(Descriptor256* descriptor) const {
  for (std::size_t bit = 0; bit < bits_set_.size(); ++bit) {
    const std::uint64_t mask = std::uint64_t{1} << (bit % 64);
    std::uint64_t& word = descriptor[bit / 256].words[bit / 64 % 4];
    if (2 * bits_set_[bit] > count_) word |= mask;
    if (2 * bits_set_[bit] < count_) word &= ~mask;
  }
}

void DescriptorMean::write_numbers(Descriptor256* descriptor) const {
  double scale = 1.0 / static_cast<double>(count_);
  if (type_.metric == DescriptorMetric::cosine && type_.kind == DescriptorKind::float32) {
    double squares = 0.0;
    for (const double sum : sums_) squares += sum * sum;
    if (squares <= 0.0) return;
    scale = 1.0 / std::sqrt(squares);
  }
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (type_.kind == DescriptorKind::float32)
      reinterpret_cast<float*>(descriptor)[i] = static_cast<float>(sums_[i] * scale);
    else
      reinterpret_cast<std::int8_t*>(descriptor)[i] = static_cast<std::int8_t>(std::lround(sums_[i] * scale));
  }
}

}  // namespace holdfast::flann_plugin

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace holdfast {

/// Type of the elements of a descriptor.
enum class DescriptorKind : std::uint8_t {
  binary,   ///< bits
  float32,  ///< finite numbers in single precision
  int8      ///< whole numbers from -128 to 127
};

/// How the distance of two descriptors is computed.
enum class DescriptorMetric : std::uint8_t {
  hamming,    ///< number of differing bits; for binary descriptors only
  euclidean,  ///< length of their difference, in the unit of their numbers
  cosine      ///< 1 minus the cosine of the angle between them, 0 to 2; float32 descriptors have unit length
};

/// Type of all descriptors of an extractor, with the matching distances that the extractor recommends for it.
struct DescriptorType {
  DescriptorKind kind = DescriptorKind::binary;
  DescriptorMetric metric = DescriptorMetric::hamming;
  std::uint32_t length = 256;     ///< number of bits or of numbers
  float strict_distance = 50.0F;  ///< largest distance of a match without any prediction
  float loose_distance = 100.0F;  ///< largest distance of a match near its prediction
  bool operator==(const DescriptorType&) const = default;

  /// Whether distances between descriptors of both types are defined; the recommended distances may differ.
  bool is_comparable(const DescriptorType& other) const {
    return kind == other.kind && metric == other.metric && length == other.length;
  }
  /// Length of a descriptor in bytes, without padding.
  std::size_t bytes() const;
  /// Interpolates between the strict (share 0) and the loose (share 1) distance.
  float distance_between(float share) const { return strict_distance + share * (loose_distance - strict_distance); }
};

/// Describes why a type is invalid, such as a length of 0; "" if it is valid.
std::string trouble_of(const DescriptorType& type);
/// For messages: "256 bits (hamming)", "128 float32 (euclidean)".
std::string to_string(const DescriptorType& type);
const char* to_string(DescriptorKind kind);
const char* to_string(DescriptorMetric metric);

/// The configured limit, or the recommended one if the configuration has 0.
inline float distance_limit(double configured, float recommended) {
  return configured > 0.0 ? static_cast<float>(configured) : recommended;
}

/// A binary descriptor of 256 bits (Rublee et al. 2011); bit i is bit i % 64 of word i / 64. It is the unit of memory
/// of all descriptors: longer ones, and those of other kinds, occupy several units, padded with zeros.
struct alignas(32) Descriptor256 {
  std::array<std::uint64_t, 4> words{};
  friend bool operator==(const Descriptor256&, const Descriptor256&) = default;
};
static_assert(sizeof(Descriptor256) == 32);

/// Number of bits in which two descriptors differ. Loops over many descriptors should use DescriptorDistances.
inline int hamming_distance(const Descriptor256& a, const Descriptor256& b) {
  int distance = 0;
  for (int i = 0; i < 4; ++i) distance += std::popcount(a.words[i] ^ b.words[i]);
  return distance;
}

/// Non-owning view of contiguous descriptors of one type.
class DescriptorView {
 public:
  DescriptorView() = default;
  DescriptorView(const DescriptorType& type, const Descriptor256* rows, std::size_t count)
      : type_(type), rows_(rows), count_(count), units_(units_of(type)) {}
  /// Descriptors of 256 bits, with the distances that ORB-SLAM2 uses.
  DescriptorView(std::span<const Descriptor256> descriptors)  // NOLINT(google-explicit-constructor)
      : rows_(descriptors.data()), count_(descriptors.size()) {}
  DescriptorView(const std::vector<Descriptor256>& descriptors)  // NOLINT(google-explicit-constructor)
      : DescriptorView(std::span(descriptors)) {}

  const DescriptorType& type() const { return type_; }
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  /// Units of memory per descriptor.
  std::size_t units() const { return units_; }
  /// The first unit of descriptor i; descriptors are contiguous.
  const Descriptor256* row(std::size_t i) const { return rows_ + i * units_; }
  /// The bytes of descriptor i, without padding.
  std::span<const std::byte> bytes(std::size_t i) const {
    return {reinterpret_cast<const std::byte*>(row(i)), type_.bytes()};
  }
  DescriptorView subview(std::size_t first, std::size_t count) const { return {type_, row(first), count}; }
  friend bool operator==(const DescriptorView& a, const DescriptorView& b);

  static std::size_t units_of(const DescriptorType& type) {
    return (type.bytes() + sizeof(Descriptor256) - 1) / sizeof(Descriptor256);
  }

 private:
  DescriptorType type_;
  const Descriptor256* rows_ = nullptr;
  std::size_t count_ = 0;
  std::size_t units_ = 1;
};

/// Descriptors of one type in one contiguous block, each aligned to 32 bytes and padded with zeros.
class DescriptorBlock {
 public:
  /// An empty block of descriptors of 256 bits.
  DescriptorBlock() = default;
  /// `count` descriptors of zeros.
  explicit DescriptorBlock(const DescriptorType& type, std::size_t count = 0) { reset(type, count); }

  /// Sets type and number of the descriptors; all are zeros unless the type is unchanged. Throws CheckError for an
  /// invalid type.
  void reset(const DescriptorType& type, std::size_t count);
  /// Changes the number of descriptors; new ones are zeros.
  void resize(std::size_t count) { rows_.resize(count * units_); }
  void clear() { rows_.clear(); }
  void reserve(std::size_t count) { rows_.reserve(count * units_); }
  /// Appends descriptor i of others. An empty block takes over their type; otherwise the types must be comparable.
  void append(const DescriptorView& others, std::size_t i) {
    if (rows_.empty()) reset(others.type(), 0);
    check_comparable(others.type());
    rows_.insert(rows_.end(), others.row(i), others.row(i) + units_);
  }

  /// Appends a descriptor of 256 bits. Throws CheckError if the block holds descriptors of another type.
  void push_back(const Descriptor256& descriptor) { append(std::span(&descriptor, 1), 0); }

  const DescriptorType& type() const { return type_; }
  std::size_t size() const { return rows_.size() / units_; }
  bool empty() const { return rows_.empty(); }
  operator DescriptorView() const { return view(); }  // NOLINT(google-explicit-constructor)
  DescriptorView view() const { return {type_, rows_.data(), size()}; }

  /// The first unit of descriptor i.
  Descriptor256* row(std::size_t i) { return &rows_[i * units_]; }
  const Descriptor256* row(std::size_t i) const { return &rows_[i * units_]; }
  /// The bytes of descriptor i, without padding, which must stay zero.
  std::span<std::byte> bytes(std::size_t i) {
    return {reinterpret_cast<std::byte*>(&rows_[i * units_]), type_.bytes()};
  }
  /// The numbers of descriptor i of the kind float32. Throws CheckError for another kind.
  std::span<float> numbers(std::size_t i);
  /// All descriptors, which must be of 256 bits. Throws CheckError for other ones.
  std::span<Descriptor256> of_256_bits();
  std::span<const Descriptor256> of_256_bits() const;

  friend bool operator==(const DescriptorBlock& a, const DescriptorBlock& b) { return a.view() == b.view(); }

 private:
  void check_comparable(const DescriptorType& type) const {
    if (!type_.is_comparable(type)) refuse(type);
  }
  [[noreturn]] void refuse(const DescriptorType& type) const;

  DescriptorType type_;
  std::size_t units_ = 1;
  std::vector<Descriptor256> rows_;
};

}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "bag.hpp"

namespace holdfast::rosbag_plugin {

/// A recording of one file or of several, which follow each other. Messages of ROS 2 that zstd compressed one by one
/// (rosbag2 with compression of messages) are decompressed.
class SplitBag final : public Bag {
 public:
  /// `path` is the recording as the user named it.
  SplitBag(const std::filesystem::path& path, std::vector<std::unique_ptr<Bag>> parts);

  std::string place_of(const BagMessage& message) const override;
  Bytes read(const BagMessage& message, std::uint64_t most) override;

  using Bag::suspect;

 private:
  struct Origin {
    std::size_t part = 0;
    std::uint32_t connection = 0;  // in that part
  };
  std::pair<Bag*, BagMessage> message_in_part(const BagMessage& message) const;

  std::vector<std::unique_ptr<Bag>> parts_;
  std::vector<Origin> origins_;  // by connection
  std::vector<std::uint8_t> buffer_;
};

}  // namespace holdfast::rosbag_plugin

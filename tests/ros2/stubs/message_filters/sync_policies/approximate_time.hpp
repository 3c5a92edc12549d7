// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

namespace message_filters::sync_policies {

template <typename... Messages>
struct ApproximateTime {
  ApproximateTime(std::uint32_t queue_size);  // NOLINT
};

}  // namespace message_filters::sync_policies

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <message_filters/subscriber.hpp>
#include <message_filters/sync_policies/approximate_time.hpp>

namespace message_filters {

template <class Policy>
class Synchronizer;

template <typename... Messages>
class Synchronizer<sync_policies::ApproximateTime<Messages...>> {
 public:
  Synchronizer(const sync_policies::ApproximateTime<Messages...>& policy, Subscriber<Messages>&... filters);
  template <class T>
  void registerCallback(void (T::*callback)(const std::shared_ptr<const Messages>&...), T* object);
};

}  // namespace message_filters

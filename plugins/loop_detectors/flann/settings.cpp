// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/flann.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void FlannSettings::describe(ParameterTable<FlannSettings>& table) {
  table
      .add("radius", &FlannSettings::radius,
           "a descriptor that differs by no more than this from a word is that word; else it becomes a new one")
      .range(0, 128)
      .unit("bit");
  table
      .add("descriptors", &FlannSettings::descriptors,
           "descriptors used of a keyframe, evenly spread over its list; time and memory are in proportion")
      .range(10, 100000);
  table
      .add("probes", &FlannSettings::probes,
           "buckets of words searched for a descriptor; more find more of the words that are there, at a cost")
      .range(1, 64);
  table
      .add("checks", &FlannSettings::checks,
           "centres of buckets that FLANN compares a descriptor with before it stops looking for nearer ones")
      .range(1, 10000);
}

}  // namespace holdfast

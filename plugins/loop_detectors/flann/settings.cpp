// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/flann.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void FlannSettings::describe(ParameterTable<FlannSettings>& table) {
  table
      .add("radius", &FlannSettings::radius,
           "maximum distance between a descriptor and its word, in the unit of the extractor; without such a word, it "
           "becomes a new one; 0 = 0.64 times the extractor's strict distance (orb: 32 bits)")
      .range(0, 1e6);
  table
      .add("descriptors", &FlannSettings::descriptors,
           "maximum number of descriptors used per keyframe, evenly sampled from its list; time and memory are "
           "proportional to it")
      .range(10, 100000);
  table
      .add("probes", &FlannSettings::probes,
           "number of buckets of words that are searched per descriptor; more find more words at a higher cost")
      .range(1, 64);
  table
      .add("checks", &FlannSettings::checks,
           "number of bucket centres that FLANN compares per descriptor before it stops")
      .range(1, 10000);
  table
      .add(
          "class_weights", &FlannSettings::class_weights,
          "weights of the features of some classes of the segmenter, such as { chair: 0.1 }; features of other classes "
          "count fully; also turns on loop_closing.class_agreement")
      .range(0, 1);
}

}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace holdfast {

struct Segmentation;

/// Keeps a region of `label` only if at least one of its pixels has a confidence of `certainty` or more: the rule of
/// two thresholds of Canny (A computational approach to edge detection, PAMI 1986, section VIII) with the network's own
/// decision as the lower one. Regions are 8-connected. The pixels of other regions become background (label 0) with
/// confidence 0, so that they are evidence of nothing. Does nothing without a confidence.
void drop_uncertain_regions(Segmentation& segmentation, std::uint8_t label, std::uint8_t certainty);

}  // namespace holdfast

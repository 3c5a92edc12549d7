// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace holdfast {

/// Edits that turn one word into the other: insertions, deletions, substitutions and swaps of neighbours (Damerau 1964,
/// in the restricted form that edits no part twice).
int edit_distance(std::string_view a, std::string_view b);

/// The known name that somebody who wrote `name` probably meant: the nearest by edit_distance (case and '-' against '_'
/// do not count), the first of several; nothing when even that is too far, which is more than a third of the longer
/// word. A known name that begins with `name` (at least three letters) counts as near.
std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known);

/// "did you mean 'orb'?" when there is a nearest name, else "known are a, b", else "none is known".
std::string did_you_mean(std::string_view name, const std::vector<std::string>& known);

}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace holdfast {

/// Restricted Damerau-Levenshtein distance: the number of insertions, deletions, substitutions and transpositions of
/// adjacent characters that turn one word into the other, where no substring is edited twice (Damerau 1964).
int edit_distance(std::string_view a, std::string_view b);

/// The known name that is most similar to a misspelled `name`: the nearest by edit_distance, ignoring case and the
/// difference between '-' and '_'; the first in case of a tie. Nothing if the distance exceeds a third of the longer
/// word. A known name that begins with `name` (at least three letters) counts as near.
std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known);

/// Returns "did you mean 'orb'?" if there is a nearest name, otherwise "known are a, b" or "none is known".
std::string did_you_mean(std::string_view name, const std::vector<std::string>& known);

}  // namespace holdfast

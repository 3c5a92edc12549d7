// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/slurm_options.hpp"

#include "holdfast/core/parsed_number.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

void set_slurm_option(const std::string& name, const PlacedText& value, SlurmOptions& options,
                      std::vector<Diagnostic>& diagnostics) {
  const std::vector<std::pair<std::string, std::string*>> texts = {{"partition", &options.partition},
                                                                   {"account", &options.account},
                                                                   {"time", &options.time},
                                                                   {"memory", &options.memory},
                                                                   {"constraint", &options.constraint}};
  std::vector<std::string> known = {"processors", "array_size", "poll_seconds"};
  for (const auto& [key, member] : texts) {
    known.push_back(key);
    if (key == name) {
      *member = value.text;
      return;
    }
  }
  const auto parsed = parsed_number<double>(value.text);
  const double number = parsed.value_or(0.0);
  const auto refuse = [&](const std::string& expected) {
    diagnostics.push_back(
        {value.location, "found '" + value.text + "' for '" + name + "' of slurm; expected " + expected});
  };
  const bool is_whole = number >= 1.0 && number <= 1e6 && number == static_cast<double>(static_cast<int>(number));
  if (name == "processors")
    is_whole ? void(options.processors = static_cast<int>(number)) : refuse("a whole number of at least 1");
  else if (name == "array_size")
    is_whole ? void(options.array_size = static_cast<std::size_t>(number)) : refuse("a whole number of at least 1");
  else if (name == "poll_seconds")
    number >= 0.1 && number <= 3600.0 ? void(options.poll_seconds = number) : refuse("seconds from 0.1 to 3600");
  else
    diagnostics.push_back({value.location, "slurm has no option '" + name + "'; " + did_you_mean(name, known)});
}

}  // namespace holdfast

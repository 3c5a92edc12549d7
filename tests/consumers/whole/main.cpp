// SPDX-License-Identifier: BSD-3-Clause
// consumer CONFIG: tracks what a configuration says, alone and twice at once; all three runs give the same bits.
#include "holdfast/holdfast.hpp"

#include <iostream>
#include <thread>

namespace {

std::string track(const char* file) {
  holdfast::BuiltPipeline built = holdfast::build_pipeline(holdfast::load_configuration(file));
  while (const auto frame = built.source->next()) built.pipeline.feed(*frame);
  built.pipeline.finish();
  return holdfast::trajectory_text(built.pipeline.trajectory());
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2) return 2;
  try {
    const std::string alone = track(arguments[1]);
    std::string first, second;
    std::thread other([&] { second = track(arguments[1]); });
    first = track(arguments[1]);
    other.join();
    std::cout << alone;
    return alone.size() > 500 && first == alone && second == alone ? 0 : 3;
  } catch (const holdfast::Error& error) {
    std::cerr << error.what() << '\n';
    return 4;
  }
}

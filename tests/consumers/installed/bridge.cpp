// SPDX-License-Identifier: BSD-3-Clause
// A node of somebody's middleware: an installed bridge says what is wrong, and begins.
#include <cstdio>
#include <fstream>
#include <string>

#include "holdfast/bridge/bridge.hpp"

namespace bridge = holdfast::bridge;

struct Silent final : bridge::Listener {
  void on_frame(const bridge::FrameOutput&) override {}
  void on_message(bridge::Diagnostics::Level, const std::string&) override {}
};

int main() {
  Silent listener;
  bridge::Parameters parameters;
  parameters.configuration = "no_such_file.yaml";
  try {
    bridge::Bridge node(parameters, listener);
    return 1;
  } catch (const std::exception& error) {
    if (std::string(error.what()).find("no_such_file.yaml") == std::string::npos) return 2;
  }
  parameters.configuration = "bridge.yaml";
  std::ofstream(parameters.configuration) << "source: bridge\ncamera: auto\nfeatures: orb\noptimizer: schur\n";
  const bridge::Bridge node(parameters, listener);
  std::puts(node.diagnostics().message.c_str());
  return node.is_paused() ? 3 : 0;
}

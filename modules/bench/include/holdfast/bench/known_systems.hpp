// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/bench/matrix.hpp"

namespace holdfast {

/// Wrapper of an external system (modules/bench/systems/systems.yaml): its command and requirements. The systems are
/// not part of Holdfast.
struct KnownSystem {
  std::string name;
  std::string about;
  std::string address;                ///< where people get it
  std::string variable;               ///< ${NAME} of the folder of its build
  std::vector<std::string> needs;     ///< files in that folder
  std::vector<std::string> programs;  ///< in PATH
  std::string build;                  ///< how it is built and run without a screen, in a sentence
  ConfigurationNode wrapper;          ///< the other keys, as those of a system of a matrix
};

/// All known systems, in the order of the file.
const std::vector<KnownSystem>& known_systems();

/// Puts the keys of the named wrapper into each system of a matrix that has `wrapper: NAME`, where it has none of its
/// own. An unknown name is appended to `diagnostics`.
void follow_wrappers(ConfigurationNode& matrix, std::vector<Diagnostic>& diagnostics);

/// Files and programs of a known system that are found or missing on this machine.
struct SystemCheck {
  std::string name;
  std::vector<std::string> found;
  std::vector<std::string> missing;
};
/// Variables are those given, then the environment's.
std::vector<SystemCheck> check_known_systems(const Variables& variables);
/// The checks as text, with address and build instructions of each system.
std::string doctor_text(const std::vector<SystemCheck>& checks);

}  // namespace holdfast

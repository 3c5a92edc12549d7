// SPDX-License-Identifier: BSD-3-Clause
// run_and_report CONFIG FOLDER: what `holdfast run` does; FOLDER gets run.json, report.html, the trajectory and the
// map.
#include <iostream>

#include "holdfast/run/results.hpp"
#include "holdfast/run/run.hpp"

int main(int argument_count, char** arguments) try {
  if (argument_count != 3) throw holdfast::Error("usage: run_and_report CONFIG FOLDER");
  const holdfast::RunRecord record = holdfast::run(holdfast::load_configuration(arguments[1]));
  holdfast::write_results(record, arguments[2]);
  std::cout << holdfast::summary_text(record);
  return record.failure.empty() && record.coverage() > 0.9 ? 0 : 1;
} catch (const holdfast::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}

// SPDX-License-Identifier: BSD-3-Clause
// Matrices of the bench, files of published figures, and dataset recipes: three readers of YAML.
#include "holdfast/bench/matrix.hpp"
#include "fuzz.hpp"
#include "holdfast/bench/dataset_recipe.hpp"
#include "holdfast/bench/published.hpp"
#include "holdfast/bench/run_plan.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("matrix.yaml", {data, size});
  fuzz::accepts([&] {
    std::vector<Diagnostic> problems;
    Matrix matrix = read_matrix(file, {{"DATA", "/data"}}, problems);
    Registry no_modules;
    if (problems.empty()) plan_text(make_run_plan(std::move(matrix), no_modules, {}, problems));
  });
  fuzz::accepts([&] {
    std::vector<Diagnostic> problems;
    read_published(file, problems);
  });
  fuzz::accepts([&] {
    std::vector<Diagnostic> problems;
    read_recipes(fuzz::text_of({data, size}), "recipes.yaml", problems);
  });
  return 0;
}

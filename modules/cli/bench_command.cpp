// SPDX-License-Identifier: BSD-3-Clause
#include "bench_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "holdfast/bench/bench_report.hpp"
#include "holdfast/bench/error_text.hpp"
#include "holdfast/bench/executor.hpp"
#include "holdfast/bench/known_systems.hpp"
#include "holdfast/bench/paper_tables.hpp"
#include "holdfast/bench/published.hpp"
#include "holdfast/bench/run_plan.hpp"
#include "holdfast/bench/run_scheduler.hpp"
#include "holdfast/bench/slurm_options.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "program_host.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

struct BenchArguments {
  std::string matrix;
  fs::path output;
  int jobs = 1;
  bool resume = false, attach = false, dry_run = false, timing = false, keep_copies = false, quiet = false;
  std::vector<std::string> data, tables, statistics, columns, slurm;
  std::string executor, run;
};

Variables variables_of(const std::vector<std::string>& data) {
  Variables variables;
  for (const std::string& each : data) {
    const std::size_t equals = each.find('=');
    if (equals == std::string::npos || equals == 0)
      throw ConfigurationError(SourceLocation{"--data " + each}, "expected NAME=VALUE, such as HOLDFAST_TUM=/data/tum");
    variables[each.substr(0, equals)] = each.substr(equals + 1);
  }
  return variables;
}

/// The rows and names of columns that options give take the place of the matrix's.
void read_table_options(const BenchArguments& arguments, MatrixAnalysis& analysis,
                        std::vector<Diagnostic>& diagnostics) {
  for (const std::string& name : arguments.tables) add_paper_table(name, analysis);
  if (!arguments.statistics.empty()) analysis.statistics.clear();
  for (const std::string& name : arguments.statistics)
    add_table_statistic({name, {"--statistic " + name}}, analysis, diagnostics);
  for (const std::string& each : arguments.columns) {
    const SourceLocation location{"--column " + each};
    const std::size_t equals = each.find('=');
    if (equals == std::string::npos || equals == 0)
      diagnostics.push_back({location, "expected VARIANT=TEXT, such as full=Ours"});
    else
      analysis.columns.insert(analysis.columns.begin(), {{each.substr(0, equals), location}, each.substr(equals + 1)});
  }
}

/// File by file, from top to bottom; what has no line comes last.
void sort_diagnostics(std::vector<Diagnostic>& diagnostics) {
  std::stable_sort(diagnostics.begin(), diagnostics.end(), [](const Diagnostic& a, const Diagnostic& b) {
    const auto key = [](const SourceLocation& l) { return std::tuple(l.file, l.line == 0, l.line, l.column); };
    return key(a.location) < key(b.location);
  });
}

std::string duration_text(double seconds) {
  const int whole = static_cast<int>(seconds + 0.5);
  if (whole < 100) return std::to_string(whole) + " s";
  return whole < 6000 ? std::to_string((whole + 30) / 60) + " min" : fixed_text(seconds / 3600.0, 1) + " h";
}

void print_end(const PlannedRun& run, const RunResult& result, const RunCost& cost, const BenchProgress& progress) {
  std::string text = "[" + std::to_string(progress.done) + "/" + std::to_string(progress.total) + "] " + run.id + ": ";
  text += result.counts() ? "ATE RMSE " + error_text(result.errors[0][0]) + " m, coverage " +
                                fixed_text(100.0 * result.coverage(), 1) + " %"
                          : red(outcome_text(result), STDERR_FILENO);
  text += ", " + duration_text(cost.process.wall_seconds);
  if (progress.done < progress.total) text += "; " + duration_text(progress.seconds_left) + " left";
  std::fprintf(stderr, "%s\n", text.c_str());
}

fs::path own_program() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) throw Error("the path of this program cannot be found: " + error.message() + "; is /proc mounted?");
  return program;
}

void prepare_folder(const BenchArguments& arguments) {
  std::error_code ignored;
  if (!arguments.resume && !arguments.attach && fs::exists(arguments.output, ignored) &&
      !fs::is_empty(arguments.output, ignored))
    throw InputError({arguments.output.string()},
                     "the output folder is not empty; go on with what is there by --resume, or name another one");
  fs::create_directories(arguments.output, ignored);
  if (!fs::is_directory(arguments.output, ignored))
    throw InputError({arguments.output.string()}, "the output folder cannot be made");
}

std::string command_to_resume(const BenchArguments& arguments, const ProgramHost& host) {
  std::string text;
  for (const std::string& word : host.command) text += word + " ";
  if (text.empty()) text = "holdfast ";
  text += "bench " + arguments.matrix + " --output " + arguments.output.string() + " --resume";
  if (!arguments.executor.empty()) text += " --executor " + arguments.executor;
  for (const std::string& each : arguments.slurm) text += " --slurm " + each;
  if (arguments.jobs != 1) text += " --jobs " + std::to_string(arguments.jobs);
  if (arguments.timing) text += " --timing";
  if (arguments.keep_copies) text += " --keep-copies";
  for (const std::string& each : arguments.tables) text += " --table " + each;
  for (const std::string& each : arguments.statistics) text += " --statistic " + each;
  for (const std::string& each : arguments.columns) text += " --column '" + each + "'";
  for (const std::string& each : arguments.data) text += " --data " + each;
  return text;
}

/// What executes one run of this bench on another machine that has the same files, when `--run ID` is added.
std::vector<std::string> command_of_one_run(const BenchArguments& arguments, const Matrix& matrix,
                                            const std::vector<std::string>& program) {
  std::vector<std::string> words = program;
  words.insert(words.end(),
               {"bench", fs::absolute(arguments.matrix).string(), "--output", fs::absolute(arguments.output).string()});
  if (matrix.timing) words.emplace_back("--timing");
  for (const std::string& each : arguments.data) words.insert(words.end(), {"--data", each});
  return words;
}

/// The executor of the matrix, as options of the command change it.
void choose_executor(const BenchArguments& arguments, const Matrix& matrix, BenchOptions& options,
                     std::vector<Diagnostic>& diagnostics) {
  const std::string& name = arguments.executor.empty() ? matrix.executor.name : arguments.executor;
  options.executor = name == "slurm" ? ExecutorKind::slurm : ExecutorKind::local;
  for (const auto& [key, value] : matrix.executor.settings) set_slurm_option(key, value, options.slurm, diagnostics);
  for (const std::string& each : arguments.slurm) {
    const std::size_t equals = std::min(each.find('='), each.size());
    set_slurm_option(each.substr(0, equals), {each.substr(std::min(equals + 1, each.size())), {"--slurm " + each}},
                     options.slurm, diagnostics);
  }
  if (arguments.attach && options.executor != ExecutorKind::slurm)
    diagnostics.push_back({{"--attach"}, "the executor is local, whose runs end with it; expected --executor slurm"});
}

/// One run, as a task of an executor. Reports nothing but what is wrong.
void execute_one(const BenchArguments& arguments, const RunPlan& plan, const BenchOptions& options, int& exit_code) {
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    if (plan.runs[i].id != arguments.run) continue;
    fs::create_directories(options.output / "runs");
    exit_code = execute_run(plan, i, options) ? 0 : interrupted_exit_code();
    return;
  }
  throw UsageError("the matrix has no run '" + arguments.run + "'; --dry-run lists all");
}

void bench(const BenchArguments& arguments, const ProgramHost& host, int& exit_code) {
  std::vector<Diagnostic> diagnostics;
  Matrix matrix = read_matrix(arguments.matrix, variables_of(arguments.data), diagnostics);
  matrix.timing = matrix.timing || arguments.timing;
  read_table_options(arguments, matrix.analysis, diagnostics);
  PublishedResults published;
  if (matrix.published) published = read_published(matrix.published->text, diagnostics);
  Registry registry = host.modules();
  BenchOptions options;
  choose_executor(arguments, matrix, options, diagnostics);
  const RunPlan plan =
      make_run_plan(std::move(matrix), registry, pipeline_sections(), diagnostics, arguments.run,
                    [&](const Configuration& configuration) { build_pipeline(configuration, registry); });
  if (!arguments.dry_run) diagnostics.insert(diagnostics.end(), plan.missing.begin(), plan.missing.end());
  sort_diagnostics(diagnostics);
  if (!diagnostics.empty()) throw ConfigurationError(std::move(diagnostics));
  exit_code = 0;
  if (arguments.dry_run) {
    std::fputs(plan_text(plan).c_str(), stdout);
    return;
  }
  if (arguments.output.empty()) throw UsageError("--output is required, the folder for the results");

  catch_interrupts();
  options.output = fs::absolute(arguments.output);
  options.program = host.command.empty() ? std::vector<std::string>{own_program().string()} : host.command;
  options.jobs = arguments.jobs;
  options.stop = interrupted;
  options.keep_copies = arguments.keep_copies;
  if (!arguments.run.empty()) {
    execute_one(arguments, plan, options, exit_code);
    return;
  }
  options.run_command = command_of_one_run(arguments, plan.matrix, options.program);
  prepare_folder(arguments);
  const BenchResults results = run_bench(
      plan, options,
      [&](const PlannedRun& run, const RunResult& result, const RunCost& cost, const BenchProgress& progress) {
        if (!arguments.quiet) print_end(run, result, cost, progress);
      });
  write_file_atomically(arguments.output / "matrix.yaml",
                        file_content(arguments.matrix, largest_file::configuration, "a matrix"));
  write_bench_reports(arguments.output, plan, results, published);
  if (results.was_stopped) {
    const auto done = std::count_if(results.results.begin(), results.results.end(),
                                    [](const auto& result) { return result.has_value(); });
    std::fprintf(stderr, "interrupted; %td of %zu runs are done. Go on with: %s\n", done, plan.runs.size(),
                 command_to_resume(arguments, host).c_str());
    exit_code = interrupted_exit_code();
    return;
  }
  for (const std::string& name : arguments.tables)
    for (const PaperTable& table : paper_tables(name, plan, analyse(plan, results), published))
      std::printf("%s\n", to_markdown(table).c_str());
  if (arguments.quiet) return;
  if (results.kept > 0) std::printf("%zu of %zu runs were finished before\n", results.kept, plan.runs.size());
  for (const Comparison& comparison : analyse(plan, results).comparisons)
    if (comparison.quantity == Quantity::ate) std::printf("%s\n", sentence(plan, comparison).c_str());
  std::printf("%s\n", (arguments.output / "report.html").c_str());
}

}  // namespace

void add_bench_command(CLI::App& app, int& exit_code, const ProgramHost& host) {
  auto arguments = std::make_shared<BenchArguments>();
  CLI::App* command = app.add_subcommand("bench", "Run a matrix of systems, configurations, sequences and repeats");
  command->footer(
      "\nEverything that is wrong with the matrix or with a configuration that follows from it is reported at once,\n"
      "before anything runs. A run that crashes, hangs or loses its way is a result, shown as such.\n\n"
      "Writes into the output folder:\n"
      "  report.md     accuracy: what helps, by how much, is it sure    tables/*.csv  the same for programs\n"
      "  cost.md       time and memory, and the machine                 results.json  everything\n"
      "  report.html   all of it to sort, plot and browse, offline\n"
      "  runs/VARIANT/SEQUENCE/RUN  configuration, log and results of every run\n\n"
      "Exits 0 when every run has a result, 130 on Ctrl-C, 143 on SIGTERM, 2 when the matrix is wrong or something is\n"
      "missing, 1 for anything else.\n\n"
      "Examples\n"
      "  holdfast bench benchmarks/simulated.yaml --dry-run\n"
      "  holdfast bench benchmarks/composed.yaml --data HOLDFAST_COMPOSED=/data/composed --output out/composed\n"
      "  holdfast bench benchmarks/composed.yaml --output out/composed --resume\n"
      "  holdfast bench doctor");
  command
      ->add_option("MATRIX", arguments->matrix,
                   "Matrix in YAML; `doctor` says what of other systems is found on this machine")
      ->required();
  command->add_option("-o,--output", arguments->output, "Folder for the results")->type_name("DIR");
  command->add_option("--jobs", arguments->jobs, "Runs at once; more than one disturbs times, not errors")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--resume", arguments->resume, "Go on with an interrupted bench: finished runs are not repeated");
  command->add_flag("--attach", arguments->attach,
                    "As --resume, for jobs on a cluster that an earlier command submitted and that may still run");
  command
      ->add_option("--executor", arguments->executor,
                   "Where runs are executed, in place of the matrix's `executor`: local, slurm (job arrays)")
      ->type_name("NAME")
      ->check(CLI::IsMember(std::vector<std::string>{"local", "slurm"}));
  command
      ->add_option("--slurm", arguments->slurm,
                   "KEY=VALUE of partition, account, time, memory, constraint, processors, array_size, poll_seconds")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command
      ->add_option("--run", arguments->run,
                   "Execute only the run with this id (as --dry-run lists them) and write no report: for executors")
      ->type_name("ID");
  command->add_flag("--dry-run", arguments->dry_run, "List the runs, and what is missing for them; run nothing");
  command->add_flag("--timing", arguments->timing, "Every run alone, whatever --jobs says");
  command->add_flag("--keep-copies", arguments->keep_copies,
                    "Keep the recordings in OUTPUT/copies that external systems got, perturbed or of other sources");
  command
      ->add_option("--table", arguments->tables,
                   "Print a table as papers do, and write tables/NAME.tex, .md and .csv: paper2 (ATE), paper3 (RPE)")
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(paper_table_names()));
  command
      ->add_option("--statistic", arguments->statistics,
                   "Row of these tables, such as rmse; may be repeated; without it all six, as papers print them")
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(table_statistic_names()));
  command
      ->add_option("--column", arguments->columns,
                   "VARIANT=TEXT: what these tables call a variant, such as full=Ours; may be repeated")
      ->type_name("VARIANT=TEXT")
      ->allow_extra_args(false);
  command->add_option("--data", arguments->data, "NAME=VALUE: of ${NAME} in the matrix; else the environment's")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command->add_flag("-q,--quiet", arguments->quiet, "No progress, no summary");
  command->callback([arguments, host, &exit_code] {
    if (arguments->matrix == "doctor") {
      std::fputs(doctor_text(check_known_systems(variables_of(arguments->data))).c_str(), stdout);
      exit_code = 0;
    } else {
      bench(*arguments, host, exit_code);
    }
  });
}

}  // namespace holdfast

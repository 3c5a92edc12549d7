// SPDX-License-Identifier: BSD-3-Clause
// The program as users run it, with a segmenter in Python: whole runs, errors, Ctrl-C and the end of the process.
#include <gmock/gmock.h>

#include <csignal>

#include "cli/program.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::Program;
using testing::AllOf;
using testing::HasSubstr;

class PythonProgram : public testing::Test {
 protected:
  PythonProgram() {
    program_.write("run.yaml",
                   "source: { simulated: { duration: 1 } }\ncamera: tum_fr1\n"
                   "features: { orb: { count: 1000 } }\noptimizer: ceres\nfilters: [semantic_mask]\n"
                   "segmenter: { python: { file: segmenter.py } }\nsegmentation: { on: every_n, every: 2 }\n");
  }
  /// `body` is that of segment().
  void write_segmenter(const std::string& body) const {
    program_.write("segmenter.py",
                   "import atexit, time\nimport numpy\n\n"
                   "calls = []\n"
                   "atexit.register(lambda: open('calls.txt', 'w').write(str(len(calls))))\n\n"
                   "class Segmenter:\n    classes = ['background', 'person']\n\n"
                   "    def segment(self, image):\n        calls.append(1)\n        " +
                       body + "\n");
  }
  Outcome run(const std::string& mode) const {
    return program_.run({"run", "run.yaml", "--set", "run.mode=" + mode, "--output", mode, "--quiet"});
  }

  Program program_;
};

TEST_F(PythonProgram, RunsToTheEndInBothModes) {
  write_segmenter("print('segmented'); return (image[:, :, 0] > 250).astype(numpy.uint8)");
  for (const std::string mode : {"sequential", "threaded"}) {
    fs::remove(program_.path("calls.txt"));
    const Outcome outcome = run(mode);
    ASSERT_EQ(outcome.exit_code, 0) << mode << ": " << outcome.errors;
    EXPECT_TRUE(fs::exists(program_.path(mode + "/trajectory.txt")));
    EXPECT_GE(std::atoi(program_.text("calls.txt").c_str()), 2) << mode << ": functions of atexit must run";
    EXPECT_THAT(outcome.output, HasSubstr("segmented")) << mode << ": what Python printed must not be lost";
  }
}

TEST_F(PythonProgram, EndsCleanlyWithTheErrorOfPython) {
  write_segmenter("return numpy.zeros(image.shape, numpy.uint8) if len(calls) > 2 else None");
  for (const std::string mode : {"sequential", "threaded"}) {
    const Outcome outcome = run(mode);
    EXPECT_EQ(outcome.exit_code, 1) << mode << ": " << outcome.errors;
    EXPECT_THAT(outcome.errors, AllOf(HasSubstr("segmenter.py"), HasSubstr("labels of shape (480, 640, 3)"),
                                      HasSubstr("with shape (480, 640)")))
        << mode;
    EXPECT_TRUE(fs::exists(program_.path(mode + "/trajectory.txt"))) << mode << ": what was found stays the user's";
    EXPECT_TRUE(fs::exists(program_.path("calls.txt"))) << mode << ": functions of atexit must run";
  }
}

TEST_F(PythonProgram, TellsOfAFileThatCannotBeRunBeforeTheFirstFrame) {
  program_.write("segmenter.py", "import no_such_network\n");
  const Outcome outcome = run("sequential");
  EXPECT_LT(outcome.exit_code, 128);
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("segmenter.py:1"), HasSubstr("No module named 'no_such_network'")));
}

TEST_F(PythonProgram, StopsAtCtrlC) {
  write_segmenter("open('started', 'w').close(); time.sleep(0.05); return None");
  for (const std::string mode : {"sequential", "threaded"}) {
    fs::remove(program_.path("started"));
    fs::remove(program_.path("calls.txt"));
    const pid_t process = program_.start({"run", "run.yaml", "--set", "run.mode=" + mode, "--set",
                                          "source.simulated.duration=600", "--output", mode, "--quiet"});
    program_.wait_until(process, [&] { return fs::exists(program_.path("started")); });
    kill(process, SIGINT);
    const Outcome outcome = program_.finish(process);
    EXPECT_EQ(outcome.exit_code, 130) << mode << ": " << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr("interrupted")) << mode;
    EXPECT_TRUE(fs::exists(program_.path("calls.txt"))) << mode << ": functions of atexit must run";
  }
}

}  // namespace
}  // namespace holdfast

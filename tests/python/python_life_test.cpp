// SPDX-License-Identifier: BSD-3-Clause
// Instances, threads and lifetimes: one Python for the process, whoever calls.
#include <gmock/gmock.h>

#include <csignal>
#include <cstdlib>
#include <future>

#include "holdfast/config/configuration.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "python/python_file.hpp"

namespace holdfast {
namespace {

using testing::HasSubstr;
using PythonLife = test::PythonFiles;

const std::string counting =
    "import numpy\nclass Segmenter:\n  classes = ['a', 'b']\n  calls = 0\n  def segment(self, image):\n"
    "    Segmenter.calls += 1\n    return numpy.full(image.shape[:2], Segmenter.calls % 2, numpy.uint8)\n";

std::uint8_t first_label(Segmenter& segmenter, const SensorFrame& frame) {
  return segmenter.segment(frame).labels.at<std::uint8_t>(0, 0);
}

TEST_F(PythonLife, InstancesOfOneFileShareNothing) {
  const std::string file = write(counting);
  const auto one = make(file), two = make(file);
  EXPECT_EQ(first_label(*one, frame()), 1);
  EXPECT_EQ(first_label(*two, frame()), 1);
  EXPECT_EQ(first_label(*one, frame()), 0);
  EXPECT_EQ(first_label(*two, frame()), 0);
}

TEST_F(PythonLife, AFileThatChangedIsRunAnew) {
  const std::string file = write(counting);
  EXPECT_EQ(make(file)->classes().size(), 2U);
  write("class Segmenter:\n  classes = ['a']\n  def segment(self, image): return None\n");
  EXPECT_EQ(make(file)->classes().size(), 1U);
}

TEST_F(PythonLife, ThreadsTakeTurns) {
  const std::string file = write(counting);
  const auto work = [&] {
    const auto segmenter = make(file);
    int sum = 0;
    for (int i = 0; i < 50; ++i) sum += first_label(*segmenter, frame());
    return sum;
  };
  auto one = std::async(std::launch::async, work), two = std::async(std::launch::async, work);
  EXPECT_EQ(one.get(), 25);
  EXPECT_EQ(two.get(), 25);
}

TEST_F(PythonLife, MayBeMadeUsedAndEndedByDifferentThreads) {
  const std::string file = write(counting);
  auto segmenter = std::async(std::launch::async, [&] { return make(file); }).get();
  EXPECT_EQ(std::async(std::launch::async, [&] { return first_label(*segmenter, frame()); }).get(), 1);
  std::async(std::launch::async, [&] { segmenter.reset(); }).get();
}

TEST_F(PythonLife, TheObjectEndsWithTheSegmenter) {
  const std::string mark = (folder_ / "ended").string();
  auto segmenter =
      make(write("class Segmenter:\n  classes = ['a']\n  def segment(self, image): return None\n"
                 "  def __del__(self, open=open): open('" +
                 mark + "', 'w').close()\n"));
  EXPECT_FALSE(std::filesystem::exists(mark));
  segmenter.reset();
  EXPECT_TRUE(std::filesystem::exists(mark));
}

volatile std::sig_atomic_t signals_seen = 0;

TEST_F(PythonLife, SignalsStayWithTheProgram) {
  const auto before = std::signal(SIGINT, [](int) { signals_seen = signals_seen + 1; });
  const auto segmenter = make(write(counting));
  std::raise(SIGINT);
  EXPECT_EQ(signals_seen, 1);
  EXPECT_EQ(first_label(*segmenter, frame()), 1) << "no KeyboardInterrupt";
  std::signal(SIGINT, before);
}

/// The end of processes, each a new run of this program.
class PythonEnd : public test::PythonFiles {
 protected:
  PythonEnd() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
  std::unique_ptr<Segmenter> with_last_words() const {
    return make(
        write("import atexit, sys\natexit.register(lambda: print('last words', file=sys.stderr))\n" + counting));
  }
};

TEST_F(PythonEnd, FunctionsOfAtexitRun) {
  EXPECT_EXIT(
      {
        first_label(*with_last_words(), frame());
        std::exit(0);
      },
      testing::ExitedWithCode(0), "last words");
}

TEST_F(PythonEnd, ASegmenterMayOutliveMain) {
  EXPECT_EXIT(
      {
        static const auto kept = with_last_words();
        first_label(*kept, frame());
        std::exit(0);
      },
      testing::ExitedWithCode(0), "");
}

TEST_F(PythonEnd, APythonThreadThatStillRunsDoesNotHinder) {
  EXPECT_EXIT(
      {
        make(write("import threading, time\nthreading.Thread(target=time.sleep, args=(3600,), daemon=True).start()\n" +
                   counting))
            ->segment(frame());
        std::exit(0);
      },
      testing::ExitedWithCode(0), "");
}

/// A pipeline on simulated frames with the segmenter of a file.
/// A segmenter in its own process, whose segment() has this body; `self.calls` counts from 1.
class PythonProcess : public test::PythonFiles {
 protected:
  std::unique_ptr<Segmenter> with_calls(const std::string& body, ParameterValues values = {}) const {
    values["process"] = std::string("own");
    return make(write("import numpy, os, signal, time\nclass Segmenter:\n  classes = ['background', 'person']\n"
                      "  movable = ['person']\n  calls = 0\n  def segment(self, image):\n    self.calls += 1\n"
                      "    ones = numpy.ones(image.shape[:2], numpy.uint8)\n    " +
                      body + "\n"),
                values);
  }
};

TEST_F(PythonProcess, GivesWhatPythonReturned) {
  const auto segmenter = with_calls("return ones, ones * 77, ones * 5");
  EXPECT_EQ(segmenter->classes(), (std::vector<std::string>{"background", "person"}));
  EXPECT_EQ(segmenter->movable(), std::vector<std::string>{"person"});
  const Segmentation result = segmenter->segment(frame());
  EXPECT_EQ(cv::countNonZero(result.labels == 1), 24);
  EXPECT_EQ(cv::countNonZero(result.confidence == 77), 24);
  EXPECT_EQ(cv::countNonZero(result.instances == 1), 24);
  ASSERT_EQ(result.found.size(), 1U);
  EXPECT_EQ(result.found[0].label, 1);
  EXPECT_EQ(result.found[0].box, cv::Rect2f(0, 0, 6, 4));
  EXPECT_TRUE(segmenter->warnings().empty());
  EXPECT_TRUE(with_calls("return None")->segment(frame()).empty());
}

TEST_F(PythonProcess, ErrorsAreThoseOfTheSharedProcess) {
  EXPECT_THAT(error_of([&] { with_calls("raise RuntimeError('no memory')")->segment(frame()); }),
              testing::AllOf(HasSubstr("segmenter.py:9: Segmenter.segment raised RuntimeError: no memory"),
                             HasSubstr("labels for frame 3"), HasSubstr("Traceback")));
  EXPECT_THAT(error_of([&] {
                make(write("import nothing_like_it\n"), {{"process", std::string("own")}});
              }),
              HasSubstr("segmenter.py:1: running the file raised ModuleNotFoundError"));
  EXPECT_THAT(error_of([&] {
                make(write("import os\nos._exit(7)\n"), {{"process", std::string("own")}});
              }),
              HasSubstr("its process ended with exit code 7 before it was ready"));
}

TEST_F(PythonProcess, ACrashCostsTheMaskOfAFrame) {
  const auto segmenter = with_calls("os.kill(os.getpid(), signal.SIGSEGV) if self.calls == 2 else None; return ones");
  EXPECT_FALSE(segmenter->segment(frame()).empty());
  EXPECT_TRUE(segmenter->segment(frame()).empty());
  EXPECT_FALSE(segmenter->segment(frame()).empty());
  const Warnings warnings = segmenter->warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0].message, testing::AllOf(HasSubstr("failed at 1 of 3 segmented frames"),
                                                  HasSubstr("signal 11"), HasSubstr("at frame 3")));
}

TEST_F(PythonProcess, OneThatHangsIsEnded) {
  const auto segmenter = with_calls("time.sleep(1000 if self.calls == 2 else 0); return ones", {{"timeout", 0.5}});
  EXPECT_FALSE(segmenter->segment(frame()).empty());
  EXPECT_TRUE(segmenter->segment(frame()).empty());
  EXPECT_THAT(segmenter->warnings().at(0).message, HasSubstr("took longer than 0.5 s and was ended at frame 3"));
}

TEST_F(PythonProcess, ThreeFailuresInSuccessionAreAnError) {
  const auto segmenter = with_calls("os._exit(3)");
  EXPECT_TRUE(segmenter->segment(frame()).empty());
  EXPECT_TRUE(segmenter->segment(frame()).empty());
  EXPECT_THAT(error_of([&] { segmenter->segment(frame()); }),
              testing::AllOf(HasSubstr("ended with exit code 3 at frame 3"), HasSubstr("3 frames in succession")));
}

TEST_F(PythonProcess, ItsEndIsAnOrderlyOne) {
  const std::string mark = (folder_ / "ended").string();
  with_calls("import atexit; atexit.register(lambda open=open: open('" + mark + "', 'w').close()); return ones")
      ->segment(frame());
  EXPECT_TRUE(std::filesystem::exists(mark));
}

class PythonPipeline : public test::PythonFiles {
 protected:
  struct Run {
    int fed = 0;
    std::string error;
  };
  Run run(const std::string& mode) {
    const std::string text =
        "source: { simulated: { duration: 0.5 } }\n"
        "camera: { width: 160, height: 120, fx: 130, fy: 130, cx: 79.5, cy: 59.5, frame_rate: 10 }\n"
        "features: { orb: { count: 300 } }\noptimizer: ceres\nfilters: [semantic_mask]\n"
        "segmenter: { python: { file: segmenter.py } }\nsegmentation: { on: every_n, every: 2, latency: 1 }\n"
        "run: { mode: " +
        mode + " }\n";
    const Configuration configuration =
        resolve_configuration(parse_yaml(text, "test.yaml", folder_), "test.yaml", registry_, pipeline_sections());
    BuiltPipeline built = build_pipeline(configuration, registry_);
    Run result;
    try {
      while (const auto frame = built.source->next()) {
        built.pipeline.feed(*frame);
        ++result.fed;
      }
      built.pipeline.finish();
    } catch (const InputError& error) {
      result.error = error.what();
    }
    return result;
  }
};

TEST_F(PythonPipeline, RunsInBothModes) {
  const std::string mark = (folder_ / "calls").string();
  write(
      "import numpy\nclass Segmenter:\n  classes = ['background', 'person']\n  def segment(self, image):\n"
      "    open('" +
      mark + "', 'a').write('.')\n    return numpy.zeros(image.shape[:2], numpy.uint8)\n");
  for (const std::string mode : {"sequential", "threaded"}) {
    std::filesystem::remove(mark);
    const Run result = run(mode);
    EXPECT_EQ(result.error, "") << mode;
    EXPECT_EQ(result.fed, 15) << mode;
    EXPECT_GE(std::filesystem::file_size(mark), 2U) << mode;
  }
}

TEST_F(PythonPipeline, ErrorsComeBackInBothModes) {
  write(
      "class Segmenter:\n  classes = ['background', 'person']\n  def segment(self, image):\n"
      "    raise RuntimeError('out of memory on the card')\n");
  for (const std::string mode : {"sequential", "threaded"}) {
    const std::string error = run(mode).error;
    EXPECT_THAT(error, HasSubstr("segmenter.py:4: Segmenter.segment raised RuntimeError: out of memory on the card"))
        << mode;
    EXPECT_THAT(error, HasSubstr("Traceback")) << mode;
  }
}

}  // namespace
}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "python/python_file.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using PythonErrors = test::PythonFiles;

TEST_F(PythonErrors, FilesThatAreNoSegmenter) {
  EXPECT_THAT(error_of([&] { make("/nowhere/absent.py"); }),
              AllOf(HasSubstr("/nowhere/absent.py"), HasSubstr("is missing"), HasSubstr("`segmenter.python.file`")));
  EXPECT_THAT(error_of([&] { make(folder_.string()); }), HasSubstr("is no file"));
  EXPECT_THAT(error_of([&] { make(write("x = 1\n")); }),
              AllOf(HasSubstr("segmenter.py"), HasSubstr("no `class Segmenter`")));
  EXPECT_THAT(error_of([&] { make(write("class Segmenter:\n  classes = ['a']\n")); }), HasSubstr("no method segment"));
  EXPECT_THAT(error_of([&] { make(write("class Segmenter:\n  def segment(self, image): return None\n")); }),
              HasSubstr("has no `classes`"));
}

TEST_F(PythonErrors, PlacesInFilesThatCannotBeRun) {
  EXPECT_THAT(error_of([&] { make(write("import numpy\n\nclass Segmenter\n")); }),
              AllOf(HasSubstr("segmenter.py:3: running the file raised SyntaxError"), HasSubstr("Python says:")));
  EXPECT_THAT(error_of([&] { make(write("import no_such_module\n")); }),
              AllOf(HasSubstr("segmenter.py:1: running the file raised ModuleNotFoundError"),
                    HasSubstr("No module named 'no_such_module'"), HasSubstr("Traceback (most recent call last)")));
  EXPECT_THAT(error_of([&] { make(write("import sys\nsys.exit(7)\n")); }),
              HasSubstr("segmenter.py:2: running the file raised SystemExit: 7"));
}

TEST_F(PythonErrors, ClassesThatAreNoNames) {
  const auto with_classes = [&](const std::string& classes) {
    return error_of([&] {
      make(write("class Segmenter:\n  classes = " + classes + "\n  def segment(self, image): return None\n"));
    });
  };
  EXPECT_THAT(with_classes("'person'"),
              AllOf(HasSubstr("Segmenter.classes is 'person'"), HasSubstr("expected a list")));
  EXPECT_THAT(with_classes("[1, 2]"), HasSubstr("Segmenter.classes is [1, 2]"));
  EXPECT_THAT(with_classes("['a', 'a']"), HasSubstr("different names"));
  EXPECT_THAT(with_classes("[]"), HasSubstr("has 0 names; expected 1 to 255"));
  EXPECT_THAT(with_classes("[str(i) for i in range(256)]"), HasSubstr("has 256 names"));
  EXPECT_THAT(with_classes("['background', 'person']\n  movable = ['persn']"),
              AllOf(HasSubstr("Segmenter.movable names 'persn'"), HasSubstr("did you mean 'person'?")));
}

TEST_F(PythonErrors, ParametersThatTheClassDoesNotKnow) {
  const std::string file = write(
      "class Segmenter:\n  classes = ['a']\n  def __init__(self, threshold): pass\n"
      "  def segment(self, image): return None\n");
  EXPECT_THAT(error_of([&] {
                make(file, {{"parameters", TextMap{{"treshold", "1"}}}});
              }),
              AllOf(HasSubstr("`segmenter.python.parameters`"), HasSubstr("TypeError"), HasSubstr("'treshold'")));
}

TEST_F(PythonErrors, ExceptionsComeWithTracebackAndLine) {
  const auto segmenter =
      make(write("class Segmenter:\n  classes = ['a', 'b']\n"
                 "  def half(self, image):\n    return image / self.nothing\n"
                 "  def segment(self, image):\n    return self.half(image)\n"));
  EXPECT_THAT(error_of([&] { segmenter->segment(frame()); }),
              AllOf(HasSubstr("segmenter.py:4: Segmenter.segment raised AttributeError"), HasSubstr("frame 3"),
                    HasSubstr("Traceback (most recent call last)"), HasSubstr("line 6, in segment"),
                    HasSubstr("return image / self.nothing")));
  // Whatever a library raises, it is the user's line that counts.
  EXPECT_THAT(error_of([&] { with_body("return numpy.zeros(-1)")->segment(frame()); }),
              HasSubstr("segmenter.py:7: Segmenter.segment raised ValueError"));
}

TEST_F(PythonErrors, ExceptionsThatCannotBePrinted) {
  const auto segmenter =
      make(write("class Strange(Exception):\n  def __str__(self): raise ValueError('no')\n"
                 "class Segmenter:\n  classes = ['a']\n"
                 "  def segment(self, image): raise Strange()\n"));
  EXPECT_THAT(error_of([&] { segmenter->segment(frame()); }), HasSubstr("segmenter.py:5: Segmenter.segment raised"));
}

TEST_F(PythonErrors, ResultsOfTheWrongForm) {
  const auto result = [&](const std::string& expression) {
    return error_of([&] { with_body("return " + expression)->segment(frame()); });
  };
  const std::string shape = "expected labels as a numpy array of uint8 with shape (4, 6)";
  EXPECT_THAT(result("'abc'"), AllOf(HasSubstr("an object of type str"), HasSubstr(shape)));
  EXPECT_THAT(result("image[:, :, 0].tolist()"), AllOf(HasSubstr("an object of type list"), HasSubstr(shape)));
  EXPECT_THAT(result("image[:, :, 0].astype(int)"),
              AllOf(HasSubstr("labels of dtype int64"), HasSubstr(".astype(numpy.uint8)")));
  EXPECT_THAT(result("image[:, :, 0] > 3"), HasSubstr("labels of dtype bool"));
  EXPECT_THAT(result("image"), AllOf(HasSubstr("labels of shape (4, 6, 3)"), HasSubstr(shape)));
  EXPECT_THAT(result("numpy.zeros((6, 4), numpy.uint8)"), HasSubstr("labels of shape (6, 4)"));
  EXPECT_THAT(
      result("(1, 2, 3, 4)"),
      HasSubstr("a tuple of 4; expected labels, (labels, confidence), (labels, confidence, instances), or None"));
  EXPECT_THAT(result("numpy.zeros((4, 6), numpy.uint8), 0.5"), HasSubstr("expected confidence as a numpy array"));
  EXPECT_THAT(result("numpy.array([[0] * 6] * 3 + [[0, 0, 2, 0, 0, 0]], numpy.uint8)"),
              HasSubstr("the label 2 at row 3, column 2; expected an index into `classes`, 0 to 1, or 255"));
}

TEST_F(PythonErrors, FramesWithoutAnImage) {
  EXPECT_THAT(error_of([&] { with_body("return None")->segment(SensorFrame{}); }), HasSubstr("no colour image"));
}

TEST_F(PythonErrors, ASegmenterGoesOnAfterAnError) {
  const auto segmenter =
      with_body("return numpy.zeros(image.shape[:2], numpy.uint8) if image.shape[0] == 4 else 1 / 0");
  EXPECT_THAT(error_of([&] { segmenter->segment(frame(6, 5)); }), HasSubstr("ZeroDivisionError"));
  EXPECT_FALSE(segmenter->segment(frame()).empty());
}

}  // namespace
}  // namespace holdfast

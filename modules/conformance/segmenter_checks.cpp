// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <opencv2/core.hpp>
#include <set>

#include "check.hpp"
#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "scene.hpp"

namespace holdfast::conformance {

namespace {

const char* const header = "holdfast/interfaces/segmenter.hpp";

std::vector<SensorFrame> frames() {
  const Scene scene(standard_camera());
  std::vector<SensorFrame> result;
  for (const std::uint64_t index : {0, 3, 6}) result.push_back(scene.frame(index));
  return result;
}

/// Checks the contract of instances, which a result may have.
void expect_sound_instances(const Segmentation& result, std::size_t classes) {
  if (result.instances.empty()) {
    EXPECT_TRUE(result.found.empty()) << "a table of instances without their image";
    return;
  }
  ASSERT_EQ(result.instances.type(), CV_16UC1) << "the type of the image of instances; 2 is 16UC1";
  ASSERT_EQ(result.instances.size(), result.labels.size()) << "the size of the image of instances";
  double highest = 0.0;
  cv::minMaxLoc(result.instances, nullptr, &highest);
  EXPECT_LE(highest, static_cast<double>(result.found.size())) << "an instance that the table does not have";
  const cv::Rect2f frame(0.0F, 0.0F, static_cast<float>(result.labels.cols), static_cast<float>(result.labels.rows));
  for (const Instance& instance : result.found) {
    EXPECT_LT(instance.label, classes) << "an instance of a class without a name";
    EXPECT_TRUE(instance.score >= 0.0F && instance.score <= 1.0F) << "the score of an instance is " << instance.score;
    constexpr float slack = 0.01F;
    const cv::Rect2f& box = instance.box;
    EXPECT_TRUE(box.x >= -slack && box.y >= -slack && box.x + box.width <= frame.width + slack &&
                box.y + box.height <= frame.height + slack)
        << "the box of an instance leaves the frame: from column " << box.x << ", row " << box.y << ", " << box.width
        << "x" << box.height << " pixels";
  }
}

/// Checks the contract of a result, which holds for every frame.
void expect_sound(Segmenter& segmenter, const SensorFrame& frame, const Segmentation& result) {
  const std::size_t classes = segmenter.classes().size();
  if (result.labels.empty()) {
    EXPECT_TRUE(result.confidence.empty()) << "confidence without labels";
    EXPECT_TRUE(result.instances.empty() && result.found.empty()) << "instances without labels";
    return;
  }
  ASSERT_NE(classes, 0U) << "labels from a segmenter without classes";
  ASSERT_EQ(result.labels.type(), CV_8UC1) << "the labels' type; 0 is 8UC1";
  ASSERT_EQ(result.labels.size(), frame.colour.size())
      << "the labels are " << size_text(result.labels.cols, result.labels.rows) << ", the frame is "
      << size_text(frame.colour.cols, frame.colour.rows);
  for (int y = 0; y < result.labels.rows; ++y)
    for (int x = 0; x < result.labels.cols; ++x) {
      const std::uint8_t label = result.labels.at<std::uint8_t>(y, x);
      ASSERT_TRUE(label < classes || label == CellMask::unknown)
          << "label " << static_cast<int>(label) << " at column " << x << ", row " << y << " of " << classes
          << " classes";
    }
  expect_sound_instances(result, classes);
  if (result.confidence.empty()) return;
  ASSERT_EQ(result.confidence.type(), CV_8UC1) << "the confidence's type; 0 is 8UC1";
  ASSERT_EQ(result.confidence.size(), frame.colour.size())
      << "the confidence is " << size_text(result.confidence.cols, result.confidence.rows) << ", the frame is "
      << size_text(frame.colour.cols, frame.colour.rows);
}

/// Segments a frame that the segmenter may refuse; what it gives must be sound.
void survive(Segmenter& segmenter, const SensorFrame& frame) {
  refused([&] { expect_sound(segmenter, frame, segmenter.segment(frame)); });
}

void expect_same(const Segmentation& a, const Segmentation& b, const std::string& when) {
  EXPECT_EQ(digest(a.labels), digest(b.labels)) << when << ": other labels";
  EXPECT_EQ(digest(a.confidence), digest(b.confidence)) << when << ": another confidence";
  EXPECT_EQ(digest(a.instances), digest(b.instances)) << when << ": other instances";
  ASSERT_EQ(a.found.size(), b.found.size()) << when << ": another number of instances";
  for (std::size_t i = 0; i < a.found.size(); ++i)
    EXPECT_TRUE(a.found[i].label == b.found[i].label && a.found[i].score == b.found[i].score &&
                a.found[i].box == b.found[i].box)
        << when << ": another instance " << i + 1;
}

std::vector<Segmentation> segment_all(Segmenter& segmenter, const std::vector<SensorFrame>& images) {
  std::vector<Segmentation> results;
  for (const SensorFrame& frame : images) results.push_back(segmenter.segment(frame));
  return results;
}

void segments_frames(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  bool any = false;
  for (const Segmentation& result : segment_all(*segmenter, frames())) any |= !result.empty();
  if (segmenter->classes().empty()) {
    EXPECT_FALSE(any) << "labels from a segmenter that says it has no classes";
  } else {
    EXPECT_TRUE(any) << "no segmentation for any of the frames 320x240 with time stamps 0, 0.3 and 0.6 s, so there is "
                        "nothing to check; give parameters with which there is one";
  }
}

void classes_have_names(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  std::set<std::string> names;
  for (const std::string& name : segmenter->classes()) {
    EXPECT_NE(name, "") << "a class without a name";
    EXPECT_TRUE(names.insert(name).second) << "the class '" << name << "' stands there twice";
  }
  EXPECT_LE(segmenter->classes().size(), 255U) << "labels have 8 bits, and 255 means unknown";
}

void classes_stay(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  const std::vector<std::string> before = segmenter->classes();
  segment_all(*segmenter, frames());
  EXPECT_EQ(segmenter->classes(), before) << "the classes changed while segmenting";
  EXPECT_EQ(maker.make<Segmenter>()->classes(), before) << "another instance with the same settings has other classes";
}

void movable_are_classes(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  const std::vector<std::string>& classes = segmenter->classes();
  for (const std::string& name : segmenter->movable())
    EXPECT_NE(std::find(classes.begin(), classes.end(), name), classes.end())
        << "'" << name << "' is movable, but none of the classes";
}

void results_are_sound(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  for (const SensorFrame& frame : frames()) expect_sound(*segmenter, frame, segmenter->segment(frame));
}

void lives_without_depth_and_truth(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  SensorFrame frame = frames().front();
  frame.depth = cv::Mat();
  survive(*segmenter, frame);
  frame.truth = nullptr;
  survive(*segmenter, frame);
}

void survives_depth_that_is_no_number(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.0F}) {
    SensorFrame frame = frames().front();
    frame.depth = cv::Mat(frame.colour.size(), CV_32FC1, cv::Scalar(static_cast<double>(value)));
    survive(*segmenter, frame);
  }
}

void survives_frames_of_any_size(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  survive(*segmenter, SensorFrame{});  // no colour
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 2), cv::Size(1, 97), cv::Size(641, 33)}) {
    SensorFrame frame;
    frame.colour = cv::Mat(size, CV_8UC3, cv::Scalar(40, 90, 200));
    survive(*segmenter, frame);
  }
  const SensorFrame usual = frames().front();
  expect_sound(*segmenter, usual, segmenter->segment(usual));  // and works afterwards
}

void takes_images_with_gaps(const Maker& maker) {
  const std::vector<SensorFrame> plain = frames();
  const auto one = maker.make<Segmenter>(), two = maker.make<Segmenter>();
  for (const SensorFrame& frame : plain)
    expect_same(one->segment(frame), two->segment(with_gaps(frame)),
                "the same image inside a larger one, with a stride of its own");
}

void writes_to_no_frame(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  for (const SensorFrame& frame : frames()) {
    const std::uint64_t before = digest(frame);
    segmenter->segment(frame);
    EXPECT_EQ(digest(frame), before) << "an image of the frame was written to";
  }
}

void results_are_kept_apart(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  const std::vector<SensorFrame> images = frames();
  const Segmentation first = segmenter->segment(images[0]);
  const Segmentation copy{first.labels.clone(), first.confidence.clone(), first.instances.clone(), first.found};
  for (const SensorFrame& frame : images) segmenter->segment(frame);
  SensorFrame flat = images[0];
  flat.colour = cv::Mat(flat.colour.size(), CV_8UC3, cv::Scalar::all(0));
  refused([&] { segmenter->segment(flat); });
  expect_same(copy, first, "the first frame's result after others were segmented");
}

void same_frames_same_results(const Maker& maker) {
  const std::vector<SensorFrame> images = frames();
  const std::vector<Segmentation> first = segment_all(*maker.make<Segmenter>(), images);
  const std::vector<Segmentation> second = segment_all(*maker.make<Segmenter>(), images);
  for (std::size_t i = 0; i < images.size(); ++i)
    expect_same(first[i], second[i], "frame " + std::to_string(i) + " by a second instance");
}

void may_change_threads(const Maker& maker) {
  const std::vector<SensorFrame> images = frames();
  const std::vector<Segmentation> here = segment_all(*maker.make<Segmenter>(), images);
  const auto segmenter = maker.make<Segmenter>();
  for (std::size_t i = 0; i < images.size(); ++i) {  // each frame in another thread
    Segmentation there;
    run_side_by_side([&] { there = segmenter->segment(images[i]); }, [] {});
    expect_same(here[i], there, "frame " + std::to_string(i) + " in another thread than the one that made it");
  }
}

void instances_do_not_meet(const Maker& maker) {
  const std::vector<SensorFrame> images = frames();
  const std::vector<Segmentation> alone = segment_all(*maker.make<Segmenter>(), images);
  const auto one = maker.make<Segmenter>(), two = maker.make<Segmenter>();
  std::vector<Segmentation> first, second;
  run_side_by_side([&] { first = segment_all(*one, images); }, [&] { second = segment_all(*two, images); });
  for (std::size_t i = 0; i < images.size(); ++i) {
    expect_same(alone[i], first[i], "beside another instance in another thread");
    expect_same(alone[i], second[i], "beside another instance in another thread");
  }
}

void time(const Maker& maker) {
  const auto segmenter = maker.make<Segmenter>();
  const SensorFrame frame = frames().front();
  report_time("segmenter/" + maker.entry().description.name + ", 320x240", 5, [&] { segmenter->segment(frame); });
}

}  // namespace

std::vector<Check> segmenter_checks() {
  const Promise classes{header, "Class names by label, without duplicates; label 0 is the background."};
  const Promise labels{header, "8UC1 of the frame's size: index into Segmenter::classes(); 255 = unknown"};
  const Promise error{header, "Throws InputError for a frame that it cannot use."};
  const Promise threads{header, "Used by one thread at a time, which may differ from the thread that constructed it."};
  const Promise same{header, "The same frames in the same order give the same results."};
  return {
      {"SegmentsFrames", {header, "Assigns a class to every pixel."}, segments_frames},
      {"ClassesHaveNames", classes, classes_have_names},
      {"ClassesStay", {header, "Empty for a segmenter without classes. Constant after construction."}, classes_stay},
      {"MovableAreClasses",
       {header,
        "The subset of classes() whose members can move or be moved; empty if the segmenter does not specify it."},
       movable_are_classes},
      {"ResultsAreSound", labels, results_are_sound},
      {"LivesWithoutDepthAndTruth", error, lives_without_depth_and_truth},
      {"SurvivesDepthThatIsNoNumber", error, survives_depth_that_is_no_number},
      {"SurvivesFramesOfAnySize", error, survives_frames_of_any_size},
      {"TakesImagesWithGaps", same, takes_images_with_gaps},
      {"WritesToNoFrame",
       {header, "The frame is not written to, and later calls do not modify an earlier result."},
       writes_to_no_frame},
      {"ResultsAreKeptApart",
       {header, "The frame is not written to, and later calls do not modify an earlier result."},
       results_are_kept_apart},
      {"SameFramesSameResults", same, same_frames_same_results},
      {"MayChangeThreads", threads, may_change_threads},
      {"InstancesDoNotMeet", threads, instances_do_not_meet},
      {"Time", threads, time},
  };
}

}  // namespace holdfast::conformance

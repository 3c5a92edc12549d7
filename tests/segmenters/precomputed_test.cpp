// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "segmenters/segmenter_fixture.hpp"

extern "C" void holdfast_register_plugin_precomputed(holdfast::Registry& registry);

namespace holdfast {
namespace {

using test::error_of;
using test::frame_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

constexpr int width = 8, height = 6;

/// An 8-bit palette PNG of 2 x 1 pixels with the indices 15 and 255, whose palette gives both the same colour.
std::vector<std::uint8_t> palette_image() {
  std::vector<std::uint8_t> bytes = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
      0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x03, 0x00, 0x00,
      0x00, 0xc3, 0xfc, 0x8f, 0xb8, 0x00, 0x00, 0x03, 0x00, 0x50, 0x4c, 0x54, 0x45};  // signature, IHDR, length and
                                                                                      // name of PLTE
  bytes.insert(bytes.end(), 3 * 256, 9);
  const std::uint8_t rest[] = {
      0x9c, 0xc5, 0x40, 0x57, 0x00, 0x00, 0x00, 0x0b, 0x49, 0x44, 0x41, 0x54, 0x78,
      0x9c, 0x63, 0xe0, 0xff, 0x0f, 0x00, 0x01, 0x20, 0x01, 0x0f, 0x7f, 0x54, 0x88,
      0x23, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};  // checksum, IDAT, IEND
  bytes.insert(bytes.end(), std::begin(rest), std::end(rest));
  return bytes;
}

class PrecomputedTest : public testing::Test {
 protected:
  PrecomputedTest() {
    std::string name = (fs::temp_directory_path() / "holdfast_labels_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~PrecomputedTest() override { fs::remove_all(folder_); }

  void write(const std::string& name, int value, int type = CV_8UC1) const {
    fs::create_directories((folder_ / name).parent_path());
    cv::Mat image(height, width, type, cv::Scalar::all(0));
    image(cv::Rect(2, 1, 3, 2)).setTo(cv::Scalar::all(value));
    ASSERT_TRUE(cv::imwrite((folder_ / name).string(), image));
  }
  std::unique_ptr<Segmenter> make(const TextMap& labels, double tolerance = 0.0, const std::string& list = "",
                                  const std::vector<double>& frames = {}) const {
    CreationContext context;
    context.frame_timestamps = frames;
    return test::make_segmenter(holdfast_register_plugin_precomputed, "precomputed",
                                {{"path", folder_.string()},
                                 {"list", list.empty() ? "" : (folder_ / list).string()},
                                 {"tolerance", tolerance},
                                 {"labels", labels}},
                                context);
  }
  /// Writes one label image for each stamp.
  void write_labels(const std::vector<double>& stamps) const {
    for (const double stamp : stamps) write(std::to_string(stamp) + ".png", 1);
  }
  static std::vector<double> frames(double shift = 0.0, int step = 1, int count = 10) {
    std::vector<double> stamps;
    for (int i = 0; i < count; i += step) stamps.push_back(1305031102.0 + shift + i / 30.0);
    return stamps;
  }
  /// The error or the warning about the label images of a recording of ten frames, 30 a second.
  std::string about_times(double tolerance = 0.0, const std::vector<double>& stamps = {}) const {
    try {
      const auto segmenter = make({{"1", "person"}}, tolerance, "", stamps.empty() ? frames() : stamps);
      return segmenter->warnings().empty() ? "" : segmenter->warnings().front().to_string();
    } catch (const InputError& error) {
      return std::string("error: ") + error.what();
    }
  }
  /// The label where the image has its value, or -1 when there is no image; the rest must be background.
  static int label_at(Segmenter& segmenter, double timestamp) {
    const Segmentation result = segmenter.segment(frame_of(timestamp, width, height));
    if (result.empty()) return -1;
    EXPECT_EQ(result.labels.type(), CV_8UC1);
    EXPECT_EQ(result.labels.at<std::uint8_t>(0, 0), 0);
    EXPECT_EQ(result.labels.at<std::uint8_t>(3, 2), 0);
    EXPECT_TRUE(result.confidence.empty());
    return result.labels.at<std::uint8_t>(2, 4);
  }

  fs::path folder_;
};

TEST_F(PrecomputedTest, ValuesAndRangesBecomeClasses) {
  write("1.000000.png", 3);
  write("2.000000.png", 254);
  write("3.000000.png", 255);
  write("4.000000.png", 300, CV_16UC1);
  const auto segmenter = make({{"1-253", "person"}, {"254", "chair"}, {"255", "unknown"}, {"256 - 400", "person"}});
  EXPECT_THAT(segmenter->classes(), ElementsAre("background", "person", "chair"));
  EXPECT_EQ(label_at(*segmenter, 1.0), 1);
  EXPECT_EQ(label_at(*segmenter, 2.0), 2);
  EXPECT_EQ(label_at(*segmenter, 3.0), 255);
  EXPECT_EQ(label_at(*segmenter, 4.0), 1);
}

TEST_F(PrecomputedTest, ZeroAndBackgroundCanBeNamed) {
  write("1.png", 7);
  const Segmentation result = make({{"0", "wall"}, {"7", "background"}})->segment(frame_of(1.0, width, height));
  EXPECT_EQ(result.labels.at<std::uint8_t>(0, 0), 1);
  EXPECT_EQ(result.labels.at<std::uint8_t>(1, 2), 0);
}

TEST_F(PrecomputedTest, TheImageOfThatStampOrTheNearest) {
  write("1305031102.175304.png", 1);
  write("1305031102.375304.png", 2);
  const TextMap labels = {{"1", "first"}, {"2", "second"}};
  const auto exact = make(labels), near = make(labels, 0.15);
  EXPECT_EQ(label_at(*exact, 1305031102.175304), 1);
  EXPECT_EQ(label_at(*exact, 1305031102.1753044), 1);  // stamps have six decimals
  EXPECT_EQ(label_at(*exact, 1305031102.175314), -1);
  EXPECT_EQ(label_at(*near, 1305031102.27), 1);
  EXPECT_EQ(label_at(*near, 1305031102.28), 2);
  EXPECT_EQ(label_at(*near, 1305031102.52), 2);
  EXPECT_EQ(label_at(*near, 1305031102.53), -1);
  EXPECT_EQ(label_at(*near, 1305031102.03), 1);
  EXPECT_EQ(label_at(*near, 1305031102.02), -1);
}

TEST_F(PrecomputedTest, AListNamesTheFiles) {
  write("mask/a.png", 1);
  write("mask/b.png", 2);
  std::ofstream(folder_ / "mask.txt") << "# timestamp filename\n10.5 mask/b.png\n11.5 mask/a.png\n";
  const auto segmenter = make({{"1", "first"}, {"2", "second"}}, 0.0, "mask.txt");
  EXPECT_EQ(label_at(*segmenter, 10.5), 2);
  EXPECT_EQ(label_at(*segmenter, 11.5), 1);
  std::ofstream(folder_ / "mask.txt") << "10.5 mask/none.png\n";
  const auto missing = make({{"1", "first"}}, 0.0, "mask.txt");
  EXPECT_THAT(error_of([&] { label_at(*missing, 10.5); }), HasSubstr("none.png: is missing"));
}

TEST_F(PrecomputedTest, LabelImagesOfEveryFrameOrMostOfThemNeedNoWord) {
  write_labels(frames());
  EXPECT_EQ(about_times(), "");
  EXPECT_EQ(about_times(0.02), "");
  fs::remove_all(folder_);
  write_labels(frames(0.0, 2));
  EXPECT_EQ(about_times(), "");
  fs::remove_all(folder_);
  write_labels(frames(0.0, 5));
  EXPECT_EQ(about_times(0.1), "");
  fs::remove_all(folder_);
  write_labels(frames(0.0, 1, 40));  // of a longer part of the recording
  EXPECT_EQ(about_times(), "");
  fs::remove_all(folder_);
  write_labels(frames(0.001));
  EXPECT_EQ(about_times(0.005), "");
}

TEST_F(PrecomputedTest, LabelImagesOfNoFrameAreAnError) {
  write_labels({0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  for (int i = 0; i < 10; ++i)
    fs::rename(folder_ / (std::to_string(i) + ".000000.png"), folder_ / (std::to_string(i) + ".png"));
  EXPECT_THAT(about_times(), AllOf(StartsWith("error: " + folder_.string() + ": none of 10 frames have a label image"),
                                   HasSubstr("numbers of frames? Name each image by the time stamp of its frame")));
  std::vector<double> from_zero;
  for (int i = 0; i < 100; ++i) from_zero.push_back(i / 30.0);
  EXPECT_THAT(about_times(0.0, from_zero), AllOf(HasSubstr("only 4 of 100 frames"), HasSubstr("numbers of frames?")));
  fs::remove_all(folder_);
  write_labels(frames(3600.0, 1, 7));
  EXPECT_THAT(about_times(), AllOf(StartsWith("error: "), HasSubstr("are they of this recording?")));
  fs::remove_all(folder_);
  write_labels(frames(0.007, 1, 9));
  EXPECT_THAT(about_times(), AllOf(StartsWith("error: "), HasSubstr("to the nearest label image it is 0.007000 s"),
                                   HasSubstr("`segmenter.precomputed.tolerance`")));
  EXPECT_EQ(about_times(0.01), "");
}

TEST_F(PrecomputedTest, LabelImagesOfFewFramesOrWithAShiftAreSuspected) {
  write_labels(frames(0.0, 5));
  EXPECT_THAT(about_times(),
              AllOf(StartsWith(folder_.string() + ": only 2 of 10 frames have a label image"), HasSubstr("tolerance")));
  fs::remove_all(folder_);
  write_labels(frames(0.1));
  EXPECT_THAT(about_times(0.01), AllOf(StartsWith(folder_.string() + ": 7 of 10 frames have a label image"),
                                       HasSubstr("every label image is 0.100000 s later than the frame of the same "
                                                 "number; correct their time stamps")));
  fs::remove_all(folder_);
  write_labels(frames(-20.0));
  EXPECT_THAT(about_times(), AllOf(StartsWith("error: "), HasSubstr("every label image is 20.000000 s earlier")));
}

TEST_F(PrecomputedTest, FewFramesMayLieBetweenTwoLabelImages) {
  write_labels(frames(0.0, 9));
  EXPECT_THAT(about_times(0.0, frames(1.0 / 30.0, 1, 4)),
              StartsWith(folder_.string() + ": none of 4 frames have a label image"));
}

TEST_F(PrecomputedTest, AnUnmappedValueNamesFileValueAndPixel) {
  write("1.png", 9);
  const auto segmenter = make({{"1-8", "person"}});
  EXPECT_EQ(error_of([&] { label_at(*segmenter, 1.0); }),
            (folder_ / "1.png").string() +
                ": has the value 9 at pixel (2, 1), which `labels` does not name; say what it means, such as "
                "`labels: { 9: person }`, or `9: unknown`");
}

TEST_F(PrecomputedTest, IndicesOfAPaletteAreReadNotItsColours) {
  const std::vector<std::uint8_t> bytes = palette_image();
  std::ofstream(folder_ / "1.png", std::ios::binary) << std::string(bytes.begin(), bytes.end());
  const auto segmenter = make({{"15", "person"}, {"255", "unknown"}});
  const Segmentation result = segmenter->segment(frame_of(1.0, 2, 1));
  EXPECT_EQ(result.labels.at<std::uint8_t>(0, 0), 1);
  EXPECT_EQ(result.labels.at<std::uint8_t>(0, 1), 255);
}

TEST_F(PrecomputedTest, ImagesThatAreNoLabelsAreRefused) {
  write("1.png", 1, CV_8UC3);
  write("3.png", 1);
  cv::imwrite((folder_ / "2.jpg").string(), cv::Mat::ones(height, width, CV_8UC1));
  fs::rename(folder_ / "2.jpg", folder_ / "2.png");
  cv::imwrite((folder_ / "4.png").string(), cv::Mat::ones(height, width, CV_8UC1), {cv::IMWRITE_PNG_BILEVEL, 1});
  const auto segmenter = make({{"1", "person"}});
  EXPECT_THAT(error_of([&] { label_at(*segmenter, 2.0); }), HasSubstr("is a JPEG image of 8x6, 1 channel of 8 bits"));
  EXPECT_THAT(error_of([&] { label_at(*segmenter, 4.0); }), HasSubstr("1 channel of 1 bits; expected a label image"));
  EXPECT_THAT(
      error_of([&] { label_at(*segmenter, 1.0); }),
      AllOf(StartsWith((folder_ / "1.png").string()), HasSubstr("3 channels of 8 bits; expected a label image")));
  EXPECT_THAT(error_of([&] { segmenter->segment(frame_of(3.0, 9, 6)); }),
              HasSubstr("is 8x6 pixels, but the frame is 9x6"));
}

TEST_F(PrecomputedTest, FoldersWithoutLabels) {
  EXPECT_THAT(error_of([&] { make({{"1", "person"}}); }), HasSubstr("holds no label image"));
  write("1.0.png", 1);
  write("1.00.png", 1);
  EXPECT_THAT(error_of([&] { make({{"1", "person"}}); }), HasSubstr("has the same time stamp as"));
  fs::rename(folder_ / "1.0.png", folder_ / "frame_1.png");
  EXPECT_THAT(error_of([&] { make({{"1", "person"}}); }), HasSubstr("frame_1.png: has no time stamp as its name"));
  const fs::path folder = folder_;
  folder_ /= "none";
  EXPECT_THAT(error_of([&] { make({{"1", "person"}}); }), HasSubstr("none: is missing; expected a folder"));
  folder_ = folder;
}

TEST_F(PrecomputedTest, EveryWrongLabelIsToldAtOnce) {
  write("1.png", 1);
  const std::string error = error_of([&] {
    make({{"5", "a"}, {"1-9", "b"}, {"70000", "c"}, {"9-1", "d"}, {"x", "e"}, {"-3", "f"}, {"11", ""}});
  });
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 5);
  EXPECT_THAT(error, HasSubstr("labels: '1-9' and '5' both name the value 5"));
  for (const char* key : {"70000", "9-1", "x", "-3"})
    EXPECT_THAT(error, HasSubstr(std::string("found '") + key + "'; expected a value from 0 to 65535 or a range"));
  EXPECT_THAT(error, HasSubstr("'11' has no class name"));
  EXPECT_THROW(make({}), ConfigurationError);
}

/// An array as numpy.save() writes it.
void write_array(const fs::path& file, const std::string& type, const std::string& shape, const std::string& values,
                 const std::string& order = "False") {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
  header.resize(117, ' ');
  header += '\n';
  std::ofstream(file, std::ios::binary) << std::string("\x93NUMPY\x01\x00", 8) << static_cast<char>(header.size())
                                        << '\0' << header << values;
}

std::string plane(int column, char value, int bytes = 1) {
  std::string values(static_cast<std::size_t>(width * height * bytes), '\0');
  for (int y = 1; y < 3; ++y) values[static_cast<std::size_t>((y * width + column) * bytes)] = value;
  return values;
}

TEST_F(PrecomputedTest, OneImageForEachInstance) {
  write("1.5_0.png", 255);
  write("1.5_person_1.png", 3);
  write("2.5.png", 255);
  const auto segmenter = make({{"255", "person"}, {"3", "chair"}});
  const Segmentation both = segmenter->segment(frame_of(1.5, width, height));
  ASSERT_EQ(both.found.size(), 2U);
  EXPECT_EQ(segmenter->classes()[both.found[0].label], "person");
  EXPECT_EQ(segmenter->classes()[both.found[1].label], "chair");
  EXPECT_EQ(both.found[1].box, cv::Rect2f(2, 1, 3, 2));
  EXPECT_EQ(both.instances.at<std::uint16_t>(2, 3), 2) << "a later one covers those before it";
  EXPECT_EQ(both.instances.at<std::uint16_t>(0, 0), 0);
  EXPECT_EQ(both.labels.at<std::uint8_t>(2, 3), both.found[1].label);
  EXPECT_TRUE(segmenter->segment(frame_of(2.5, width, height)).instances.empty());
  write("2.5_1.png", 255);
  EXPECT_THAT(error_of([&] {
                make({{"255", "person"}});
              }),
              AllOf(HasSubstr("has the same time stamp as"), HasSubstr("or one for each instance")));
}

TEST_F(PrecomputedTest, ArraysOfLabelsAndOfInstances) {
  write_array(folder_ / "1.npy", "|u1", "(6, 8)", plane(2, 9));
  write_array(folder_ / "2.npy", "<i8", "(6, 8)", plane(3, 9, 8));
  write_array(folder_ / "3.npy", "|b1", "(2, 6, 8)", plane(1, 1) + plane(5, 1));
  write_array(folder_ / "4.npy", "|b1", "(0, 6, 8)", "");
  write_array(folder_ / "5.npy", "|b1", "(1, 6, 8)", plane(4, 1));
  const auto segmenter = make({{"1", "person"}, {"9", "cat"}});
  const auto at = [&](double stamp) { return segmenter->segment(frame_of(stamp, width, height)); };
  EXPECT_EQ(at(1).labels.at<std::uint8_t>(2, 2), 2);
  EXPECT_EQ(cv::countNonZero(at(1).labels), 2);
  EXPECT_EQ(at(2).labels.at<std::uint8_t>(1, 3), 2);
  EXPECT_TRUE(at(2).instances.empty());
  const Segmentation two = at(3);
  ASSERT_EQ(two.found.size(), 2U);
  EXPECT_EQ(two.instances.at<std::uint16_t>(1, 1), 1);
  EXPECT_EQ(two.instances.at<std::uint16_t>(2, 5), 2);
  EXPECT_EQ(two.labels.at<std::uint8_t>(2, 5), 1);
  EXPECT_EQ(two.found[1].box, cv::Rect2f(5, 1, 1, 2));
  EXPECT_FALSE(at(4).empty());
  EXPECT_EQ(cv::countNonZero(at(4).labels), 0);
  EXPECT_EQ(at(5).found.size(), 1U);
}

/// A ZIP file as numpy.savez() writes it, but for the sums, of files of this folder by their names in it.
void write_archive(const fs::path& file, const std::vector<std::pair<std::string, fs::path>>& members, int method = 0) {
  const auto little = [](std::uint64_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 255);
    return text;
  };
  std::string archive, directory;
  for (const auto& [name, source] : members) {
    std::ifstream stream(source, std::ios::binary);
    const std::string data{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    const std::string common = little(20, 2) + little(0, 2) + little(static_cast<std::uint64_t>(method), 2) +
                               little(0, 8) + little(data.size(), 4) + little(data.size(), 4) + little(name.size(), 2);
    const std::size_t begin = archive.size();
    archive += "PK\x03\x04" + common + little(4, 2) + name + "more" + data;
    directory +=
        "PK\x01\x02" + little(20, 2) + common + little(0, 2) + little(0, 2) + little(0, 8) + little(begin, 4) + name;
  }
  std::ofstream(file, std::ios::binary) << archive << directory << "PK\x05\x06" << little(0, 4)
                                        << little(members.size(), 2) << little(members.size(), 2)
                                        << little(directory.size(), 4) << little(archive.size(), 4) << little(0, 2);
}

TEST_F(PrecomputedTest, ArchivesOfArrays) {
  const fs::path folder = folder_ / "arrays";
  fs::create_directory(folder);
  write_array(folder / "labels", "|u1", "(6, 8)", plane(2, 1));
  write_array(folder / "masks", "|b1", "(2, 6, 8)", plane(1, 1) + plane(5, 1));
  write_archive(folder_ / "1.npz", {{"arr_0.npy", folder / "labels"}});
  write_archive(folder_ / "2.npz", {{"boxes.npy", folder / "labels"}, {"masks.npy", folder / "masks"}});
  write_archive(folder_ / "3.npz", {{"boxes.npy", folder / "labels"}, {"scores.npy", folder / "masks"}});
  write_archive(folder_ / "4.npz", {{"masks.npy", folder / "masks"}}, 8);
  write_array(folder_ / "5.npz", "|u1", "(6, 8)", plane(2, 1));
  const auto segmenter = make({{"1", "person"}});
  const auto at = [&](double stamp) { return segmenter->segment(frame_of(stamp, width, height)); };
  const auto error = [&](double stamp) { return error_of([&] { at(stamp); }); };
  EXPECT_EQ(cv::countNonZero(at(1).labels.col(2)), 2);
  EXPECT_EQ(at(2).found.size(), 2U);
  EXPECT_THAT(error(3), HasSubstr("has the arrays boxes.npy, scores.npy, none of which is called labels"));
  EXPECT_THAT(error(4), HasSubstr("the compressed array masks.npy; save it with numpy.savez()"));
  EXPECT_THAT(error(5), HasSubstr("5.npz: is no archive of arrays (.npz)"));
}

TEST_F(PrecomputedTest, ArraysOfOtherKindsAreRefused) {
  const auto error = [&](const std::string& type, const std::string& shape, const std::string& values,
                         const std::string& order = "False") {
    write_array(folder_ / "1.npy", type, shape, values, order);
    return error_of([&] { make({{"1", "person"}})->segment(frame_of(1, width, height)); });
  };
  EXPECT_THAT(
      error("<f4", "(6, 8)", plane(1, 1, 4)),
      AllOf(HasSubstr("1.npy: has values of the type '<f4'; expected an array of NumPy"), HasSubstr("numpy.save()")));
  EXPECT_THAT(error("|u1", "(6, 8)", plane(1, 1), "True"), HasSubstr("Fortran's order"));
  EXPECT_THAT(error("|u1", "(48,)", plane(1, 1)), HasSubstr("is an array of 48;"));
  EXPECT_THAT(error("|u1", "(6, 8)", "short"), HasSubstr("has 5 bytes of values for 6 x 8"));
  EXPECT_THAT(error("|i1", "(6, 8)", plane(1, '\xff')), HasSubstr("a value outside 0 to 65535"));
  EXPECT_THAT(error("|u1", "(8, 6)", plane(1, 1)), HasSubstr("is 6x8 pixels, but the frame is 8x6"));
  EXPECT_THAT(error("|u1", "(6, 8)", plane(1, 2)), HasSubstr("1.npy"));
  EXPECT_THAT(error("|u1", "(99999999999, 8)", ""), HasSubstr("too large"));
  EXPECT_THAT(error("|u1", "6", ""), HasSubstr("no array that can be read"));
}

/// A file of COCO with these annotations of one image at 1.5 s; some text of it may be replaced.
class PrecomputedCoco : public PrecomputedTest {
 protected:
  std::string coco(const std::string& annotations, const std::string& from = "", const std::string& to = "") const {
    std::string text =
        R"({"images": [{"id": 7, "file_name": "rgb/1.5.png", "width": 8, "height": 6}], "categories":
 [{"id": 1, "name": "person"}, {"id": 3, "name": "chair"}], "annotations": [)" +
        annotations + "]}";
    if (!from.empty()) text.replace(text.find(from), from.size(), to);
    std::ofstream(folder_ / "masks.json") << text;
    return (folder_ / "masks.json").string();
  }
  static std::unique_ptr<Segmenter> make_of(const std::string& file, ParameterValues values = {}) {
    values["path"] = file;
    return test::make_segmenter(holdfast_register_plugin_precomputed, "precomputed", values);
  }
  /// Of an annotation of a person.
  static std::string person(const std::string& segmentation, const std::string& more = "") {
    return R"({"image_id": 7, "category_id": 1, "segmentation": )" + segmentation + more + "}";
  }
};

TEST_F(PrecomputedCoco, PolygonsAndRunLengths) {
  // A square of 3 x 2 pixels, and one column of 6 by run lengths: compressed, "f0" is 54 = 22 + 32, negative or not.
  const auto segmenter = make_of(coco(person("[[2.5, 1.5, 4.5, 1.5, 4.5, 2.5, 2.5, 2.5]]") + "," +
                                      R"({"image_id": 7, "category_id": 3, "score": 0.25,
                      "segmentation": {"size": [6, 8], "counts": [18, 6, 24]}})"));
  EXPECT_THAT(segmenter->classes(), ElementsAre("background", "person", "chair"));
  const Segmentation result = segmenter->segment(frame_of(1.5, width, height));
  ASSERT_EQ(result.found.size(), 2U);
  EXPECT_EQ(result.found[0].label, 1);
  EXPECT_EQ(result.found[0].box, cv::Rect2f(2, 1, 3, 2));
  EXPECT_EQ(result.found[1].label, 2);
  EXPECT_FLOAT_EQ(result.found[1].score, 0.25F);
  EXPECT_EQ(result.found[1].box, cv::Rect2f(3, 0, 1, 6));
  EXPECT_EQ(cv::countNonZero(result.labels == 1), 6) << "the better one covers";
  EXPECT_EQ(cv::countNonZero(result.instances == 2), 4);
  EXPECT_TRUE(segmenter->segment(frame_of(2.5, width, height)).empty());
}

TEST_F(PrecomputedCoco, CompressedRunLengths) {
  // 18, 6, 24 - 0: groups of five bits from '0' on; the third number is a difference from nothing yet.
  const auto text = [](int value) {
    std::string result;
    for (; value > 15; value >>= 5) result += static_cast<char>('0' + (value & 31) + 32);
    return result + static_cast<char>('0' + value);
  };
  const std::string counts = text(18) + text(6) + text(24);
  const Segmentation result =
      make_of(coco(person(R"({"size": [6, 8], "counts": ")" + counts + "\"}", R"(, "iscrowd": 1)")))
          ->segment(frame_of(1.5, width, height));
  EXPECT_EQ(cv::countNonZero(result.labels.col(3) == 1), 6);
  EXPECT_EQ(cv::countNonZero(result.labels), 6);
  EXPECT_TRUE(result.found.empty()) << "a crowd is no instance";
}

TEST_F(PrecomputedCoco, OtherNamesOfCategories) {
  const auto segmenter = make_of(coco(person("[[0, 0, 8, 0, 8, 6, 0, 6]]")),
                                 {{"labels", TextMap{{"1", "somebody"}, {"3", "background"}}}});
  EXPECT_THAT(segmenter->classes(), ElementsAre("background", "somebody"));
  EXPECT_EQ(cv::countNonZero(segmenter->segment(frame_of(1.5, width, height)).labels), 48);
}

TEST_F(PrecomputedCoco, ErrorsSayWhatWasFoundAndExpected) {
  const auto error = [&](const std::string& segmentation, const std::string& from = "", const std::string& to = "") {
    return error_of([&] { make_of(coco(person(segmentation), from, to)); });
  };
  const std::string square = "[[0, 0, 2, 0, 2, 2, 0, 2]]";
  EXPECT_THAT(error("[[1, 2, 3, 4]]"), HasSubstr("has a polygon of 4 numbers; expected x, y of at least three"));
  EXPECT_THAT(error(R"({"size": [6, 8], "counts": [18, 6]})"), HasSubstr("run lengths of 24 pixels; expected 48, 8x6"));
  EXPECT_THAT(error(R"({"size": [6, 8], "counts": "~"})"), HasSubstr("run lengths of 0 pixels"));
  EXPECT_THAT(error(R"({"size": [8, 6], "counts": [48]})"), HasSubstr("size [8,6]; expected [6,8]"));
  EXPECT_THAT(error(square, "rgb/1.5.png", "first.png"), HasSubstr("'first.png', which is no time stamp"));
  EXPECT_THAT(error(square, "\"category_id\": 1", "\"category_id\": 2"), HasSubstr("the category 2, which is not in"));
  EXPECT_THAT(error(square, "\"image_id\": 7", "\"image_id\": 8"), HasSubstr("the image 8, which is not in"));
  EXPECT_THAT(error(square, "annotations", "notes"), HasSubstr("has no list `annotations`"));
  EXPECT_THAT(error(square, "{", "["), HasSubstr("is no JSON"));
  EXPECT_THAT(error_of([&] { make_of(coco(person(square)))->segment(frame_of(1.5, 16, 12)); }),
              HasSubstr("has an image of 8x6 pixels, but the frame is 16x12"));
  EXPECT_THAT(error_of([&] { make_of(folder_.string()); }), HasSubstr("segmenter.precomputed.labels: is missing"));
}

}  // namespace
}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
// Recordings of ROS 2, as programs that are not of this project wrote them: bags/write_bags.mjs.
#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "holdfast/core/crc32.hpp"
#include "image_message.hpp"
#include "mcap_file.hpp"
#include "sources/recording.hpp"
#include "support/npm_tools.hpp"

namespace holdfast {
namespace {

using rosbag_plugin::McapFile;
using test::input_error;
using test::read_all;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

constexpr int bag_width = 16, bag_height = 12, bag_frames = 4;
constexpr const char* colour_name = "/camera/camera/color/image_raw";
constexpr const char* info_name = "/camera/camera/color/camera_info";

std::filesystem::path bag_file(const std::string& name) { return std::filesystem::path(HOLDFAST_BAGS) / name; }

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string replaced(std::string bytes, const std::string& from, const std::string& to) {
  std::size_t count = 0;
  for (std::size_t at = bytes.find(from); at != std::string::npos; at = bytes.find(from, at + to.size()), ++count)
    bytes.replace(at, from.size(), to);
  EXPECT_GT(count, 0u) << from;
  return bytes;
}

/// An MCAP file without the checksum of its data, so that a test can change them.
std::string without_sum_of_data(const std::string& bytes) {
  const std::string prefix("\x0f\x04\0\0\0\0\0\0\0", 9);
  std::string result = bytes;
  const std::size_t end = result.rfind(prefix);
  EXPECT_NE(end, std::string::npos);
  EXPECT_NE(result.substr(end + 9, 4), std::string(4, '\0')) << "the writer gives one";
  return result.replace(end + 9, 4, 4, '\0');
}

/// Where the last record of that kind begins in an MCAP file.
std::size_t last_record_of(const std::string& bytes, char kind) {
  std::size_t found = 0;
  for (std::size_t at = 8; at + 17 < bytes.size();) {
    if (bytes[at] == kind) found = at;
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes[at + 1], sizeof(length));
    at += 9 + length;
  }
  return found;
}

std::unique_ptr<FrameSource> open_bag_source(const std::filesystem::path& path, ParameterValues values = {}) {
  values["path"] = path.string();
  return test::make_source("rosbag", values, bag_width, bag_height);
}

void expect_the_frames(const std::filesystem::path& path) {
  const auto source = open_bag_source(path, {{"camera_info", std::string(info_name)}});
  EXPECT_EQ(source->describe().frame_count, 4u);
  EXPECT_TRUE(source->describe().has_depth);
  const std::optional<Camera> camera = source->describe().camera;
  ASSERT_TRUE(camera.has_value());
  EXPECT_EQ(camera->width, bag_width);
  EXPECT_EQ(camera->height, bag_height);
  EXPECT_EQ(camera->fx, 52.0);
  EXPECT_EQ(camera->fy, 53.0);
  EXPECT_EQ(camera->cx, 7.5);
  EXPECT_EQ(camera->cy, 5.5);
  EXPECT_EQ(camera->distortion, (Distortion{.k1 = 0.1, .k2 = -0.2, .p1 = 0.003, .p2 = 0.004, .k3 = 0.5}));
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 4u);
  for (int i = 0; i < bag_frames; ++i) {
    const SensorFrame& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(frame.timestamp, std::stod("1700000000." + std::to_string(900 + 33 * i))) << "as a list of images has it";
    EXPECT_NEAR(frame.depth_delay, 0.002, 1e-6);
    for (int y = 0; y < bag_height; ++y)
      for (int x = 0; x < bag_width; ++x) {
        const auto low = [](int value) { return static_cast<std::uint8_t>(value); };
        ASSERT_EQ(frame.colour.at<cv::Vec3b>(y, x), cv::Vec3b(low(7 * x + 40 * i), low(11 * y), low(x ^ y)));
        const int millimetres = x == 0 && y == 0 ? 0 : 500 + 10 * x + 20 * y + 100 * i;
        ASSERT_EQ(frame.depth.at<float>(y, x), static_cast<float>(millimetres) / 1000.0F);
      }
  }
  EXPECT_THAT(source->warnings(), IsEmpty());
}

class Rosbag2Test : public testing::Test {
 protected:
  std::string error(const std::string& name, const std::string& bytes, const ParameterValues& values = {}) const {
    const std::string file = folder_.write(name, bytes);
    return input_error([&] { read_all(*open_bag_source(file, values)); });
  }
  void copy(const std::string& bag, const std::string& file) const {
    folder_.write(std::filesystem::path(bag) / file, bytes_of(bag_file(bag) / file));
  }
  std::string error_of(const std::string& bag) const {
    return input_error([&] { read_all(*open_bag_source(folder_.path() / bag)); });
  }
  test::TemporaryFolder folder_;
};

#ifdef HOLDFAST_ZSTD
constexpr bool has_zstd = true;
#else
constexpr bool has_zstd = false;
#endif
#ifdef HOLDFAST_SQLITE
constexpr bool has_sqlite = true;
#else
constexpr bool has_sqlite = false;
#endif

TEST_F(Rosbag2Test, GivesTheSameFramesFromEveryContainer) {
  struct Row {
    const char* name;
    bool needs_zstd, needs_sqlite;
  };
  const Row rows[] = {{"chunks.mcap", false, false},        {"without_chunks.mcap", false, false},
                      {"lz4.mcap", false, false},           {"ros1.mcap", false, false},
                      {"zstd.mcap", true, false},           {"without_index.mcap", true, false},
                      {"big_endian.mcap", true, false},     {"compressed_images.mcap", true, false},
                      {"jazzy.db3", false, true},           {"split", false, true},
                      {"split/metadata.yaml", false, true}, {"zstd_files", true, true},
                      {"zstd_messages", true, true},        {"zstd_messages/zstd_messages_0.db3", true, true}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    if ((row.needs_zstd && !has_zstd) || (row.needs_sqlite && !has_sqlite))
      EXPECT_THAT(input_error([&] { read_all(*open_bag_source(bag_file(row.name))); }),
                  AnyOf(HasSubstr("(Debian: libzstd-dev)"), HasSubstr("(Debian: libsqlite3-dev)")));
    else
      expect_the_frames(bag_file(row.name));
  }
}

TEST_F(Rosbag2Test, GivesTheSameFramesFromAHundredFiles) {
  if (!has_zstd || !has_sqlite) GTEST_SKIP() << "built without zstd or SQLite";
  const test::NpmTools tools(HOLDFAST_TEST_NPM_FOLDER,
                             {"@mcap/core@2.2.2", "@foxglove/rosmsg@5.0.5", "@foxglove/rosmsg-serialization@2.0.4",
                              "@foxglove/rosmsg2-serialization@3.1.0", "@foxglove/cdr@3.5.0",
                              "@foxglove/wasm-zstd@1.0.1", "lz4js@0.2.0", "sql.js@1.16.0"});
  if (!tools.trouble().empty()) GTEST_SKIP() << tools.trouble();
  const std::filesystem::path many = folder_.path() / "many";
  ASSERT_TRUE(
      tools.run("node '" HOLDFAST_BAGS "/write_bags.mjs' '" + many.string() + "' many", folder_.path() / "output"))
      << bytes_of(folder_.path() / "output");
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(many)) {
    SCOPED_TRACE(entry.path().filename().string());
    expect_the_frames(entry.path());
    ++count;
  }
  EXPECT_EQ(count, 107);
}

TEST_F(Rosbag2Test, NamesARecordingByItsFileOrFolder) {
  EXPECT_EQ(open_bag_source(bag_file("lz4.mcap"))->describe().name, "lz4");
  if (!has_sqlite) GTEST_SKIP() << "built without SQLite";
  EXPECT_EQ(open_bag_source(bag_file("split"))->describe().name, "split");
  EXPECT_EQ(open_bag_source(bag_file("split/metadata.yaml"))->describe().name, "split");
}

TEST_F(Rosbag2Test, ReadsWhatIsCompleteOfATruncatedMcapFile) {
  for (const char* name : {"without_chunks.mcap", "lz4.mcap"}) {
    const std::string whole = bytes_of(bag_file(name));
    std::uint64_t before = 0;
    // All sizes of the end, and some of the rest.
    const auto step = [&](std::size_t size) { return size + 60 > whole.size() ? 1U : 29U; };
    for (std::size_t size = 8; size < whole.size(); size += step(size)) {
      const std::string file = folder_.write("cut.mcap", whole.substr(0, size));
      try {
        const McapFile bag(file, file);
        std::uint64_t messages = 0;
        for (const auto& topic : bag.topics()) messages += topic.messages;
        ASSERT_THAT(bag.warnings(), SizeIs(1)) << name << ' ' << size;
        EXPECT_THAT(bag.warnings()[0].to_string(), StartsWith(file + ": is truncated at byte ")) << size;
        ASSERT_GE(messages, before) << name << ' ' << size;
        before = messages;
      } catch (const InputError& error) {
        ASSERT_EQ(before, 0u) << name << ' ' << size << ' ' << error.what();
        EXPECT_THAT(error.what(), HasSubstr("before its first message"));
      }
    }
    EXPECT_EQ(before, 24u) << "12 of images and calibrations, and as many of another topic";
    EXPECT_THAT(McapFile(bag_file(name), name).warnings(), IsEmpty());
  }
  // As users see it, and after a lost power supply, which leaves zeros.
  const std::string whole = bytes_of(bag_file("without_chunks.mcap"));
  for (const std::string& cut : {whole.substr(0, 5000), whole.substr(0, 5000) + std::string(300, '\0')}) {
    const auto source = open_bag_source(folder_.write("cut.mcap", cut));
    EXPECT_EQ(read_all(*source).size(), 2u);
    ASSERT_THAT(source->warnings(), SizeIs(1));
    EXPECT_THAT(source->warnings()[0].to_string(), HasSubstr("messages before are read; copy it again"));
  }
}

TEST_F(Rosbag2Test, RefusesADamagedMcapFile) {
  const std::string chunks = bytes_of(bag_file("chunks.mcap")), plain = bytes_of(bag_file("without_chunks.mcap"));
  std::string damaged = chunks;
  damaged[damaged.find("bgr8") + 100] ^= 1;
  EXPECT_THAT(error("a.mcap", damaged), AllOf(HasSubstr("a.mcap: chunk at byte "), HasSubstr("has the checksum ")));
  damaged = plain;
  damaged[damaged.find("bgr8") + 100] ^= 1;
  EXPECT_THAT(error("a.mcap", damaged), HasSubstr("a.mcap: the data section: has the checksum "));
  // A chunk that says it is something else is passed over.
  damaged = chunks;
  damaged[last_record_of(chunks, '\x06')] ^= 0x10;
  EXPECT_THAT(error("a.mcap", damaged), HasSubstr("messages where its statistics say 24; it is damaged"));
  damaged = bytes_of(bag_file("lz4.mcap"));
  for (std::size_t i = 0; i < 40; ++i) damaged[damaged.find("lz4") + 40 + i] ^= 0x55;
  EXPECT_THAT(error("a.mcap", damaged), HasSubstr("a.mcap: chunk at byte "));
  // A length that leads beyond the end, though the end is there.
  damaged = without_sum_of_data(plain);
  damaged[damaged.find("bgr8") - 83] ^= 1;
  EXPECT_THAT(error("a.mcap", damaged), HasSubstr("where one must be; it is damaged"));
  damaged = plain;
  damaged.replace(9, 8, 8, '\x01');
  EXPECT_THAT(error("a.mcap", damaged), HasSubstr("has no record at byte 8, where one must be; it is damaged"));
  EXPECT_THAT(error("a.mcap", replaced(chunks.substr(0, 8), "MCAP0", "MCAP1")),
              HasSubstr("MCAP file of another version"));
  EXPECT_THAT(error("a.mcap", chunks.substr(0, 7)), HasSubstr("cut short in its first bytes"));
  // Neither a crash nor silence about the frames, whatever is damaged.
  for (std::size_t i = 8; i + 8 < chunks.size(); i += 97) {
    damaged = chunks;
    damaged[i] ^= 0x10;
    const std::string file = folder_.write("b.mcap", damaged);
    try {
      EXPECT_EQ(read_all(*open_bag_source(file)).size(), 4u) << i << ": a byte that is not used";
    } catch (const InputError&) {
    }
  }
}

TEST_F(Rosbag2Test, RefusesAnUnknownCompressionTypeAndEncoding) {
  EXPECT_THAT(error("a.mcap", replaced(bytes_of(bag_file("lz4.mcap")), "lz4", "lz5")),
              AllOf(HasSubstr("is compressed by 'lz5'"), HasSubstr("expected none, zstd, lz4")));
  const std::string plain = without_sum_of_data(bytes_of(bag_file("without_chunks.mcap")));
  EXPECT_THAT(
      error("a.mcap", replaced(plain, "sensor_msgs/msg/Image", "sensor_msgs/msg/Imago")),
      AllOf(HasSubstr("has no colour images"), HasSubstr("\n  " + std::string(colour_name) + "  sensor_msgs/Imago")));
  const std::string as_xml = replaced(plain, "cdr", "xml");
  EXPECT_THAT(error("a.mcap", as_xml),
              AllOf(HasSubstr("has no colour images"), HasSubstr("sensor_msgs/Image  4 messages, serialised as 'xml'"),
                    HasSubstr("\n  /status  12 messages, serialised as 'json'")));
  EXPECT_THAT(error("a.mcap", as_xml, {{"colour", std::string(colour_name)}}),
              AllOf(HasSubstr("has messages that are serialised as 'xml'; expected cdr (ROS 2) or ros1")));
  // Another representation of CDR.
  EXPECT_THAT(error("a.mcap", replaced(plain, std::string("\0\x01\0\0\0\xf1", 6), std::string("\0\x07\0\0\0\xf1", 6))),
              HasSubstr("is serialised in the representation 0.7 of CDR; expected 0.0 or 0.1"));
}

TEST_F(Rosbag2Test, ReadsTheFilesOfAFolder) {
  if (!has_sqlite) GTEST_SKIP() << "built without SQLite";
  for (const char* file : {"split_0.db3", "split_1.db3", "metadata.yaml"}) copy("split", file);
  const std::filesystem::path bag = folder_.path() / "split";
  const std::string metadata = bytes_of(bag / "metadata.yaml");
  // Listed as old versions did it, and by number without a list.
  folder_.write("split/metadata.yaml", replaced(metadata, "- split", "- old/folder/split"));
  expect_the_frames(bag);
  std::filesystem::remove(bag / "metadata.yaml");
  std::filesystem::rename(bag / "split_0.db3", bag / "split_9.db3");
  std::filesystem::rename(bag / "split_1.db3", bag / "split_10.db3");
  const auto source = open_bag_source(bag);
  EXPECT_EQ(read_all(*source).size(), 4u);
  ASSERT_THAT(source->warnings(), SizeIs(1));
  EXPECT_THAT(source->warnings()[0].to_string(),
              AllOf(StartsWith(bag.string() + ": has no metadata.yaml"), HasSubstr("Its 2 files, in the order")));

  folder_.write("split/other.db3", "");
  EXPECT_THAT(error_of("split"), AllOf(HasSubstr("holds several recordings: other.db3, split_10.db3, split_9.db3"),
                                       HasSubstr("`source.rosbag.path`")));
  folder_.write("split/metadata.yaml", metadata);
  EXPECT_THAT(error_of("split"), AllOf(StartsWith((bag / "metadata.yaml").string()),
                                       HasSubstr("lists the file 'split_0.db3', which is missing")));
  folder_.write("split/metadata.yaml", replaced(metadata, "compression_format: \"\"", "compression_format: \"lz4\""));
  EXPECT_THAT(error_of("split"), HasSubstr("is compressed by 'lz4'; expected zstd or none"));
  folder_.write("split/metadata.yaml", "a: [1, 2");
  EXPECT_THAT(error_of("split"), HasSubstr("metadata.yaml:1:"));
  folder_.write("split/metadata.yaml", "a: 1");
  EXPECT_THAT(error_of("split"), HasSubstr("has no rosbag2_bagfile_information"));
  std::filesystem::create_directories(folder_.path() / "empty");
  EXPECT_THAT(error_of("empty"), HasSubstr("is a folder without metadata.yaml and without files .db3 or .mcap"));
}

TEST_F(Rosbag2Test, RefusesADamagedDatabase) {
  if (!has_sqlite) GTEST_SKIP() << "built without SQLite";
  const std::string whole = bytes_of(bag_file("jazzy.db3"));
  for (std::size_t size = 16; size < whole.size(); size += 1000)
    EXPECT_THAT(error("a.db3", whole.substr(0, size)), HasSubstr("cannot be read as a database")) << size;
  EXPECT_THAT(error("a.db3", whole.substr(0, whole.size() - 1)),
              AllOf(HasSubstr("is truncated or damaged"), HasSubstr("a.db3 .recover`")));
  EXPECT_THAT(error("a.db3", replaced(whole, "messages", "massages")), HasSubstr("expected one of rosbag2"));
  EXPECT_THAT(error("a.db3", ""), HasSubstr("is empty; expected a recording of ROS"));
  for (std::size_t i = 100; i < whole.size(); i += 251) {
    std::string damaged = whole;
    damaged[i] ^= 0x10;
    const std::string file = folder_.write("b.db3", damaged);
    try {
      read_all(*open_bag_source(file));
    } catch (const InputError&) {
    }
  }
}

TEST_F(Rosbag2Test, RefusesATruncatedFileOfZstd) {
  if (!has_zstd || !has_sqlite) GTEST_SKIP() << "built without zstd or SQLite";
  const std::string whole = bytes_of(bag_file("zstd_files/zstd_files_0.db3.zstd"));
  for (std::size_t size = 4; size < whole.size(); size += 200)
    EXPECT_THAT(error("a.db3.zstd", whole.substr(0, size)), HasSubstr("a.db3.zstd: is damaged or truncated")) << size;
  EXPECT_EQ(open_bag_source(folder_.write("a.db3.zstd", whole))->describe().name, "a");
}

/// The bytes of a message in CDR, little-endian.
std::string cdr(std::initializer_list<std::string> parts) {
  std::string bytes("\0\x01\0\0", 4);
  for (const std::string& part : parts) bytes += part;
  return bytes;
}
rosbag_plugin::Message message_of(const std::string& bytes) {
  return {{reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
          rosbag_plugin::compressed_image_type,
          &rosbag_plugin::cdr_encoding(),
          "message"};
}

TEST(CdrTest, AlignsNumbersAndChecksTexts) {
  const std::string stamp("\x05\0\0\0\x07\0\0\0", 8), frame("\x02\0\0\0c\0", 6), gap("\0\0", 2);
  const std::string format("\x05\0\0\0jpeg\0", 9), gap_of_three("\0\0\0", 3), bytes("\x02\0\0\0xy", 6);
  const std::string right = cdr({stamp, frame, gap, format, gap_of_three, bytes});
  EXPECT_EQ(rosbag_plugin::encoding_of(message_of(right)), "jpeg");
  EXPECT_EQ(rosbag_plugin::read_stamp(message_of(right)), 5.000000007);
  for (std::size_t size = 0; size < right.size(); ++size)
    EXPECT_THAT(input_error([&] { rosbag_plugin::encoding_of(message_of(right.substr(0, size))); }),
                AllOf(HasSubstr("is cut short"), HasSubstr("message")))
        << size;
  const auto problem = [](const std::string& wrong) {
    return input_error([&] { rosbag_plugin::encoding_of(message_of(wrong)); });
  };
  EXPECT_THAT(problem(cdr({std::string("\x05\0\0\x80\x07\0\0\0", 8), frame, gap, format, gap_of_three, bytes})),
              HasSubstr("expected one that is not negative"));
  EXPECT_THAT(problem(cdr({stamp, std::string("\x02\0\0\0cc", 6), gap, format, gap_of_three, bytes})),
              HasSubstr("has a text without its end as frame name"));
  EXPECT_THAT(problem("\x01" + right.substr(1)), HasSubstr("representation 1.1 of CDR"));
  // Some writers give an empty text no end.
  EXPECT_EQ(rosbag_plugin::encoding_of(message_of(cdr({stamp, std::string(4, '\0'), format, gap_of_three, bytes}))),
            "jpeg");
}

TEST(Crc32Test, IsThatOfTheStandard) {
  const std::string text = "123456789";
  const auto part = [&](std::size_t begin, std::size_t count) {
    return rosbag_plugin::Bytes(reinterpret_cast<const std::uint8_t*>(text.data()) + begin, count);
  };
  EXPECT_EQ(Crc32().add(part(0, 9)).value(), 0xCBF43926U);
  EXPECT_EQ(Crc32().add(part(0, 1)).add(part(1, 8)).value(), 0xCBF43926U);
}

}  // namespace
}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>

#include "holdfast/core/atomic_file.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/text_file.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class FileTest : public ::testing::Test {
 protected:
  FileTest() {
    std::string name = (fs::temp_directory_path() / "holdfast_file_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~FileTest() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  fs::path link(const std::string& name, const char* target) const {
    fs::create_symlink(target, folder_ / name);
    return folder_ / name;
  }
  fs::path pipe(const std::string& name) const {
    EXPECT_EQ(mkfifo((folder_ / name).c_str(), 0600), 0);
    return folder_ / name;
  }
  static std::string error_of(const std::function<void()>& act) {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  static std::string error_of_reading(const fs::path& file, std::uint64_t most_bytes = 1 << 20) {
    return error_of([&] { file_content(file, most_bytes, "a list"); });
  }
  static std::vector<std::string> lines_of(const fs::path& file) {
    LineReader reader(file, "a list");
    std::vector<std::string> lines;
    for (std::string line; reader.next(line);) {
      lines.push_back(line);
      EXPECT_EQ(reader.number(), static_cast<int>(lines.size()));
    }
    return lines;
  }
  static std::string content(const fs::path& file) { return file_content(file, 1 << 20, "a file"); }
  std::size_t entries() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {})); }

  fs::path folder_;
};

TEST_F(FileTest, ReadsWhatIsThere) {
  EXPECT_EQ(content(write("empty", "")), "");
  EXPECT_EQ(content(write("bytes", std::string("a\0\n\xff", 4))), std::string("a\0\n\xff", 4));
  const std::string large(300'000, 'x');
  EXPECT_EQ(content(write("large", large)), large);
  EXPECT_EQ(content(link("link", "large")), large);
  EXPECT_NE(content("/proc/self/stat"), "") << "the system says that it has no bytes";
  InputFile file(write("numbers", "0123456789"), 10, "ten digits");
  std::vector<std::uint8_t> bytes(99);
  file.seek(7);
  file.read_rest(bytes);
  EXPECT_THAT(bytes, ElementsAre('7', '8', '9'));
}

TEST_F(FileTest, NamesWhatCannotBeRead) {
  EXPECT_EQ(error_of_reading(folder_ / "absent"), (folder_ / "absent").string() + ": no such file; expected a list");
  EXPECT_THAT(error_of_reading(folder_ / std::string(5000, 'a')), HasSubstr("no such file"));
  EXPECT_THAT(error_of_reading(write("file", "") / "below"), HasSubstr("no such file"));
  EXPECT_THAT(error_of_reading(folder_), HasSubstr("found a folder; expected a list"));
  EXPECT_THAT(error_of_reading(link("zero", "/dev/zero")), HasSubstr("zero: found a device, which may never end"));
  EXPECT_THAT(error_of_reading("/dev/zero"), HasSubstr("found a device"));
  EXPECT_THAT(error_of_reading(pipe("pipe")), HasSubstr("pipe: found a named pipe, which may never end"));
  EXPECT_THAT(error_of_reading(link("loop", "loop")), HasSubstr("cannot be opened: "));
}

TEST_F(FileTest, NamesTheBoundOfAFileThatIsTooLarge) {
  EXPECT_EQ(error_of_reading(write("exact", "0123"), 4), "no error");
  EXPECT_THAT(error_of_reading(write("longer", "01234"), 4),
              HasSubstr("longer: found more than 4 bytes, the most that is read of such a file; expected a list"));
  const fs::path huge = write("huge", "");
  fs::resize_file(huge, largest_file::text + 1);  // a file with a hole takes no room
  EXPECT_THAT(error_of([&] { lines_of(huge); }), HasSubstr("found more than 4 GiB"));
  EXPECT_THAT(error_of_reading(huge, largest_file::image), HasSubstr("found more than 1 GiB"));
  // Of these the system does not say how many bytes they have.
  EXPECT_THAT(error_of_reading("/proc/self/stat", 8), HasSubstr("found more than 8 bytes"));
}

TEST_F(FileTest, AReadThatFailsIsNotTheEnd) {
  // A file that is there and regular, and whose first bytes the system refuses to read.
  const fs::path broken = link("broken", "/proc/self/mem");
  EXPECT_THAT(error_of_reading(broken), HasSubstr("broken: cannot be read beyond byte 0: Input/output error"));
  EXPECT_THAT(error_of([&] { lines_of(broken); }), HasSubstr("Input/output error"));
}

TEST_F(FileTest, ReadsWhatTheSystemPasses) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "a\nb", 3), 3);
  close(ends[1]);
  EXPECT_THAT(lines_of("/dev/fd/" + std::to_string(ends[0])), ElementsAre("a", "b"));
  close(ends[0]);
}

TEST_F(FileTest, GivesLines) {
  EXPECT_THAT(lines_of(write("empty", "")), ElementsAre());
  EXPECT_THAT(lines_of(write("one", "a")), ElementsAre("a"));
  EXPECT_THAT(lines_of(write("ended", "a\n")), ElementsAre("a"));
  EXPECT_THAT(lines_of(write("blank", "\n\na\r\n\n")), ElementsAre("", "", "a\r", ""));
  EXPECT_THAT(lines_of(write("marked",
                             "\xef\xbb\xbf"
                             "a\n\xef\xbb\xbf"
                             "b")),
              ElementsAre("a",
                          "\xef\xbb\xbf"
                          "b"));
  EXPECT_THAT(lines_of(write("mark", "\xef\xbb\xbf")), ElementsAre(""));
  EXPECT_THAT(lines_of(write("half", "\xef\xbb")), ElementsAre("\xef\xbb"));
}

TEST_F(FileTest, GivesLinesAcrossTheBordersOfItsBuffer) {
  std::vector<std::string> lines;
  std::string text;
  for (int i = 0; i < 3000; ++i) {
    lines.emplace_back(static_cast<std::size_t>(i * 37 % 211), static_cast<char>('a' + i % 26));
    text += lines.back() + "\n";
  }
  lines.emplace_back(LineReader::longest_line, 'z');
  text += lines.back();
  EXPECT_EQ(lines_of(write("many", text)), lines);
  EXPECT_THAT(error_of([&] { lines_of(write("longer", text + "z")); }),
              HasSubstr("longer:3001: found a line of more than 1048576 bytes; expected a list"));
}

TEST_F(FileTest, ReplacesAFileAsAWhole) {
  const fs::path file = write("file", "old");
  {
    AtomicFile written(file);
    written.write("ne");
    written.write("w");
    EXPECT_EQ(content(file), "old");
    written.commit();
  }
  EXPECT_EQ(content(file), "new");
  { AtomicFile(file).write("not committed"); }
  EXPECT_EQ(content(file), "new");
  write_file_atomically(file, "newer", Durability::later);
  sync_file_system(folder_);
  EXPECT_EQ(content(file), "newer");
  EXPECT_EQ(entries(), 1U) << "no temporary file is left";
}

TEST_F(FileTest, SaysWhyAFileCannotBeWritten) {
  const auto error = [&](const fs::path& file) { return error_of([&] { write_file_atomically(file, "text"); }); };
  EXPECT_THAT(error(folder_ / "absent" / "file"),
              HasSubstr("file: cannot be written: No such file or directory; is the folder there?"));
  fs::create_directory(folder_ / "taken");
  EXPECT_THAT(error(folder_ / "taken"), HasSubstr("taken: cannot be replaced: "));
  EXPECT_THAT(error("/dev/full"), HasSubstr("cannot be written: No space left on device; make room"));
  EXPECT_EQ(entries(), 1U);
}

TEST_F(FileTest, WritesIntoDevicesAndPipesInsteadOfReplacingThem) {
  const fs::path null = link("null", "/dev/null");
  write_file_atomically(null, "text");
  EXPECT_TRUE(fs::is_character_file(null));
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  write_file_atomically("/dev/fd/" + std::to_string(ends[1]), "text");
  char text[8] = {};
  EXPECT_EQ(::read(ends[0], text, sizeof(text)), 4);
  EXPECT_STREQ(text, "text");
  close(ends[0]);
  close(ends[1]);
  EXPECT_EQ(entries(), 1U);
}

}  // namespace
}  // namespace holdfast

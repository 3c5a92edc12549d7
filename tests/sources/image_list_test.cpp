// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/image_list.hpp"

#include <gmock/gmock.h>

#include "sources/recording.hpp"

namespace holdfast {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class ImageListTest : public testing::Test {
 protected:
  std::string error_of(const std::string& content) {
    const std::string file = folder_.write("list.txt", content);
    return input_error([&] { read_image_list(file); });
  }
  std::string place(int line) const {
    return (folder_.path() / "list.txt").string() + ':' + std::to_string(line) + ": ";
  }

  test::TemporaryFolder folder_;
};

TEST_F(ImageListTest, ReadsWhatIsWritten) {
  const auto list =
      read_image_list(folder_.write("list.txt", "# a comment\r\n\r\n1305031102.175304 rgb/a.png\r\n1305031103  b.png"));
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].timestamp, 1305031102.175304);
  EXPECT_EQ(list[0].name, "rgb/a.png");
  EXPECT_EQ(list[0].line, 3);
  EXPECT_EQ(list[1].name, "b.png");
}

TEST_F(ImageListTest, SkipsAByteOrderMark) {
  EXPECT_EQ(read_image_list(folder_.write("list.txt", "\xef\xbb\xbf# a comment\n1.0 a.png\n")).size(), 1u);
  EXPECT_EQ(read_stamp_list(folder_.write("stamps.txt",
                                          "\xef\xbb\xbf"
                                          "1.0\n2.0\n"))
                .size(),
            2u);
}

TEST_F(ImageListTest, UnsortedAndRepeatedStampsNameTheirLine) {
  EXPECT_THAT(error_of("# c\n2.0 a\n1.5 b\n"),
              AllOf(StartsWith(place(3)), HasSubstr("1.500000, earlier than 2.000000 in line 2"), HasSubstr("sort")));
  EXPECT_THAT(error_of("1.0 a\n2.0 b\n\n2.0 c\n"),
              AllOf(StartsWith(place(4)), HasSubstr("2.000000, the same as in line 2"), HasSubstr("take one")));
}

TEST_F(ImageListTest, MalformedLinesNameTheirLine) {
  EXPECT_THAT(error_of("1.0 a\n2.0\n"), AllOf(StartsWith(place(2)), HasSubstr("found 1 word in '2.0'"),
                                              HasSubstr("expected a line 'timestamp filename'")));
  EXPECT_THAT(error_of("1.0 a b\n"), AllOf(StartsWith(place(1)), HasSubstr("found 3 words in '1.0 a b'")));
  EXPECT_THAT(error_of("1.0 a\nrgb.png 2.0\n"), AllOf(StartsWith(place(2)), HasSubstr("found 'rgb.png' where")));
  EXPECT_THAT(error_of("1.0x a\n"), AllOf(StartsWith(place(1)), HasSubstr("found '1.0x' where")));
}

TEST_F(ImageListTest, StampsThatAreNotFiniteNameTheirLine) {
  for (const char* stamp : {"nan", "inf", "-inf"})
    EXPECT_THAT(error_of(std::string("1.0 a\n") + stamp + " b\n"),
                AllOf(StartsWith(place(2)), HasSubstr(std::string("'") + stamp + "', which is not finite")));
  EXPECT_THAT(error_of("1e999 a\n"), StartsWith(place(1)));
}

TEST_F(ImageListTest, StampsOfAnotherUnitNameTheirLine) {
  EXPECT_THAT(error_of("1403636579763555584 a\n"),
              AllOf(StartsWith(place(1)), HasSubstr("look like nanoseconds: divide them by 1e9")));
  EXPECT_THAT(error_of("1403636579763555 a\n"), HasSubstr("look like microseconds: divide them by 1e6"));
  EXPECT_THAT(error_of("1403636579763 a\n"), HasSubstr("look like milliseconds: divide them by 1000"));
  EXPECT_EQ(read_image_list(folder_.write("list.txt", "1403636579.763 a\n")).size(), 1U);
}

TEST_F(ImageListTest, EmptyAndMissingLists) {
  EXPECT_THAT(error_of(""), HasSubstr("list.txt: is an empty list"));
  EXPECT_THAT(error_of("# only\n\n# comments\n"), HasSubstr("list.txt: is an empty list"));
  EXPECT_THAT(input_error([&] { read_image_list(folder_.path() / "no.txt"); }), HasSubstr("no.txt: is missing"));
  EXPECT_THAT(input_error([&] { read_image_list(folder_.path()); }), HasSubstr("found a folder"));
}

TEST_F(ImageListTest, AssociationsHaveFourColumns) {
  const auto pairs = read_association_list(folder_.write("list.txt", "1.0 a 1.1 b\n2.0 c 0.9 d\n"));
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[1].colour.name, "c");
  EXPECT_EQ(pairs[1].depth.timestamp, 0.9);
  const std::string file = folder_.write("list.txt", "1.0 a 1.1 b\n2.0 c 2.1\n");
  EXPECT_THAT(input_error([&] { read_association_list(file); }),
              AllOf(StartsWith(place(2)), HasSubstr("found 3 words")));
}

}  // namespace
}  // namespace holdfast

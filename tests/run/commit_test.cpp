// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

/// The script that every build runs, on a repository of its own.
class CommitTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "holdfast_commit_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    if (std::system("git --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "git is not installed";
  }
  void TearDown() override { fs::remove_all(folder_); }

  void git(const std::string& arguments) const {
    const std::string command = "git -C '" + (folder_ / "sources").string() +
                                "' -c user.name=test -c user.email=test@localhost " + arguments + " > /dev/null 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
  std::string described(const std::string& sources = "sources") const {
    const std::string command = "'" HOLDFAST_CMAKE "' -D SOURCE='" + (folder_ / sources).string() + "' -D HEADER='" +
                                header().string() + "' -P '" HOLDFAST_COMMIT_SCRIPT "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    std::ostringstream text;
    text << std::ifstream(header()).rdbuf();
    return text.str();
  }
  fs::path header() const { return folder_ / "build/commit.hpp"; }
  void write(const std::string& content) const { std::ofstream(folder_ / "sources/file.txt") << content; }

  fs::path folder_;
};

TEST_F(CommitTest, IsThatOfTheSourcesAtEveryBuild) {
  fs::create_directories(folder_ / "sources");
  write("one\n");
  EXPECT_THAT(described(), HasSubstr("#define HOLDFAST_COMMIT \"unknown\"\n"));
  git("init");
  git("add file.txt");
  git("commit -m one");
  const std::string first = described();
  EXPECT_THAT(first, AllOf(Not(HasSubstr("unknown")), Not(HasSubstr("dirty"))));

  const fs::file_time_type long_ago = fs::last_write_time(header()) - std::chrono::hours(1);
  fs::last_write_time(header(), long_ago);
  EXPECT_EQ(described(), first);
  EXPECT_EQ(fs::last_write_time(header()), long_ago) << "nothing is compiled again for the same commit";

  write("two\n");
  EXPECT_THAT(described(), EndsWith("-dirty\"\n"));
  git("commit -a -m two");
  const std::string second = described();
  EXPECT_THAT(second, AllOf(Not(HasSubstr("dirty")), Not(testing::Eq(first))));

  // A worktree has a commit of its own.
  git("worktree add ../worktree HEAD^");
  EXPECT_EQ(described("worktree"), first);
}

}  // namespace
}  // namespace holdfast

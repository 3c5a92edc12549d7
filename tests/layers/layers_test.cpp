// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <set>
#include <stdexcept>

#include "layers/layer_table.hpp"

namespace holdfast::layers {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const fs::path source_tree = HOLDFAST_SOURCE_DIR;

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

TEST(Layers, AreKept) {
  const LayerReport report = check_layers(source_tree, read_layer_table(source_tree / "docs/architecture.md"));
  EXPECT_THAT(report.problems, IsEmpty()) << joined(report.problems);
  // Guards against a reader that finds nothing and therefore nothing wrong.
  EXPECT_GT(report.files, 100);
  EXPECT_GT(report.includes, 200);
}

TEST(Layers, HaveARowForEveryModuleAndNoOther) {
  const std::vector<Layer> layers = read_layer_table(source_tree / "docs/architecture.md");
  std::set<fs::path> folders;
  for (const Layer& layer : layers)
    for (const fs::path& folder : layer.folders) {
      EXPECT_TRUE(fs::exists(source_tree / folder)) << layer.name << " names what is not there: " << folder;
      folders.insert(folder);
    }
  for (const fs::path top : {"include/holdfast", "modules"})
    for (const fs::directory_entry& entry : fs::directory_iterator(source_tree / top))
      EXPECT_TRUE(folders.count(top / entry.path().filename()) > 0)
          << entry.path() << " has no row in docs/architecture.md";
}

/// A little source tree with a table of its own, gone when the test ends.
class LittleTree : public testing::Test {
 protected:
  void SetUp() override {
    tree_ = fs::path(testing::TempDir()) / ("holdfast_layers_" + std::to_string(getpid()) + "_" +
                                            testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(tree_);
    for (const char* folder : {"include", "modules", "plugins"}) fs::create_directories(tree_ / folder);
    write("page.md",
          "# Page\n\n| Layer | Folders | May include | What |\n|---|---|---|---|\n"
          "| `low` | `include/holdfast/low`, `modules/low` | none | x |\n"
          "| `high` | `include/holdfast/high` | `low` | x |\n"
          "| `top` | `modules/top` | all | x |\n"
          "| `helper` | `plugins/common` | `low` | x |\n"
          "| `plugins` | `plugins` | `low`, `helper` | x |\n\nMore text.\n");
  }
  void TearDown() override { fs::remove_all(tree_); }

  void write(const fs::path& file, const std::string& text) const {
    fs::create_directories((tree_ / file).parent_path());
    std::ofstream(tree_ / file) << text;
  }
  LayerReport check() const { return check_layers(tree_, read_layer_table(tree_ / "page.md")); }

  fs::path tree_;
};

TEST_F(LittleTree, AcceptsWhatTheTableAllows) {
  write("include/holdfast/low/a.hpp", "#pragma once\n#include <vector>\n#include \"holdfast/low/b.hpp\"\n");
  write("include/holdfast/high/c.hpp", "#include \"holdfast/low/a.hpp\"\n#include \"beside.hpp\"\n");
  write("modules/top/d.cpp", "#include \"holdfast/high/c.hpp\"\n");
  write("plugins/kind/one/e.cpp", "#include \"holdfast/helper/h.hpp\"\n");
  const LayerReport report = check();
  EXPECT_THAT(report.problems, IsEmpty());
  EXPECT_EQ(report.files, 4);
  EXPECT_EQ(report.includes, 4);
}

TEST_F(LittleTree, FindsABrokenLayerWithFileAndLine) {
  write("modules/low/a.cpp", "#include <vector>\n\n  #  include \"holdfast/high/c.hpp\"\n");
  write("include/holdfast/low/b.hpp", "#include <holdfast/high/c.hpp>\n");
  EXPECT_THAT(check().problems,
              ElementsAre(HasSubstr("include/holdfast/low/b.hpp:1: layer 'low' may not include 'high'"),
                          HasSubstr("modules/low/a.cpp:3: layer 'low' may not include 'high'")));
}

TEST_F(LittleTree, FindsAPluginThatKnowsAnother) {
  write("plugins/kind/one/e.cpp", "#include \"holdfast/two/two.hpp\"\n#include \"../two/two.hpp\"\n");
  write("plugins/common/h.cpp", "#include \"holdfast/high/c.hpp\"\n");
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("plugins/common/h.cpp:1: layer 'helper' may not include 'high'"),
                                            HasSubstr("plugins/kind/one/e.cpp:1: 'two' is no layer"),
                                            HasSubstr("plugins/kind/one/e.cpp:2: an include climbs out")));
}

TEST_F(LittleTree, FindsUnknownLayersAndFilesOfNone) {
  write("include/holdfast/high/c.hpp", "#include \"holdfast/nowhere/x.hpp\"\n#include \"holdfast/x.hpp\"\n");
  write("modules/lost/l.cpp", "int x;\n");
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("include/holdfast/high/c.hpp:1: 'nowhere' is no layer"),
                                            HasSubstr("include/holdfast/high/c.hpp:2: '' is no layer"),
                                            HasSubstr("modules/lost/l.cpp: belongs to no layer")));
}

TEST_F(LittleTree, RejectsTablesThatCannotHold) {
  const std::string header = "| Layer | Folders | May include |\n|---|---|---|\n";
  for (const std::string& rows :
       {std::string("| `a` | `x` | `b` |\n| `b` | `y` | none |\n"),  // b stands below a
        std::string("| `a` | `x` | none |\n| `a` | `y` | none |\n"), std::string("| `a` | `x` | nothing at all |\n"),
        std::string("| `a` |  | none |\n"), std::string("no rows\n")}) {
    write("page.md", header + rows);
    EXPECT_THROW(read_layer_table(tree_ / "page.md"), std::runtime_error) << rows;
  }
}

}  // namespace
}  // namespace holdfast::layers

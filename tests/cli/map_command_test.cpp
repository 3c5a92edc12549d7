// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "holdfast/surface/surface_views.hpp"
#include "map_io/map_files.hpp"
#include "surface/solid_world.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

using Outcome = test::CommandOutcome;

class MapCommand : public test::MapFileTest {
 protected:
  MapCommand() : map_(test::random_map(12, 30, 1)) { write_map(path("map.hfm"), map_); }

  static Outcome run(const std::vector<std::string>& words) { return test::run_command(words); }
  std::string file() const { return path("map.hfm").string(); }

  Map map_;
};

TEST_F(MapCommand, InfoPrintsATable) {
  const Outcome outcome = run({"map", "info", file()});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, IsEmpty());
  EXPECT_THAT(outcome.output, AllOf(StartsWith("file       " + file()), HasSubstr("version 1, made by Holdfast"),
                                    HasSubstr("keyframes  " + std::to_string(map_.keyframes().size())),
                                    HasSubstr("points     " + std::to_string(map_.points().size())),
                                    HasSubstr("loops      2"), HasSubstr("time "), HasSubstr("extent ")));
}

TEST_F(MapCommand, InfoAsJson) {
  const Outcome outcome = run({"map", "info", file(), "--json"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(outcome.output)["points"], map_.points().size());
}

TEST_F(MapCommand, ExportsToFiles) {
  const Outcome outcome = run({"map", "export", file(), "--points", path("points.ply").string(), "--trajectory",
                               path("keyframes.txt").string(), "--json", path("map.json").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, IsEmpty());
  EXPECT_TRUE(content(path("points.ply")) == points_ply(map_));
  EXPECT_EQ(read_trajectory(path("keyframes.txt")).size(), map_.keyframes().size());
  EXPECT_EQ(nlohmann::json::parse(content(path("map.json")))["keyframes"].size(), map_.keyframes().size());
}

TEST_F(MapCommand, ExportsToStandardOutput) {
  const Outcome outcome = run({"map", "export", file(), "--points", "-"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.output == points_ply(map_));
  EXPECT_EQ(run({"map", "export", file(), "--trajectory", "-"}).output, trajectory_text(keyframe_trajectory(map_)));
  const Outcome two = run({"map", "export", file(), "--points", "-", "--json", "-"});
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_THAT(two.errors, HasSubstr("only one export can go to standard output"));
  EXPECT_THAT(two.output, IsEmpty());
}

TEST_F(MapCommand, AsksBeforeItReplacesAFile) {
  for (const char* option : {"--points", "--trajectory", "--json"}) {
    write("there", "precious");
    const std::string target = path("there").string();
    const Outcome refused = run({"map", "export", file(), option, target});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.errors, HasSubstr("there: is there already; name another file, or add --overwrite"));
    EXPECT_EQ(content(path("there")), "precious");
    EXPECT_EQ(run({"map", "export", file(), option, target, "--overwrite"}).exit_code, 0);
    EXPECT_NE(content(path("there")), "precious");
  }
}

TEST_F(MapCommand, SaysWhatIsWrong) {
  const Outcome missing = run({"map", "info", path("nothing.hfm").string()});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.errors, AllOf(StartsWith("error: "), HasSubstr("nothing.hfm"), HasSubstr("no such file")));
  EXPECT_THAT(missing.output, IsEmpty());
  const std::string bytes = content(path("map.hfm"));
  write("cut.hfm", bytes.substr(0, 1000));
  for (const char* name : {"info", "export"}) {
    std::vector<std::string> words = {"map", name, path("cut.hfm").string()};
    if (std::string(name) == "export") words.insert(words.end(), {"--points", path("points.ply").string()});
    const Outcome cut = run(words);
    EXPECT_EQ(cut.exit_code, 1);
    EXPECT_THAT(cut.errors, HasSubstr("cut off"));
  }
  EXPECT_FALSE(std::filesystem::exists(path("points.ply")));
  const Outcome nothing = run({"map", "export", file()});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.errors, HasSubstr("--points, --trajectory, --json, --mesh; see `holdfast map export --help`"));
  const Outcome unwritable = run({"map", "export", file(), "--points", path("nowhere/points.ply").string()});
  EXPECT_EQ(unwritable.exit_code, 1);
  EXPECT_THAT(unwritable.errors, HasSubstr("cannot be written"));
  EXPECT_EQ(run({"map"}).exit_code, 2);
  EXPECT_EQ(run({"map", "show", file()}).exit_code, 2);
}

TEST_F(MapCommand, ExportsAMeshFromTheKeptDepth) {
  const std::string mesh = path("room.glb").string();
  const Outcome without = run({"map", "export", file(), "--mesh", mesh});
  EXPECT_EQ(without.exit_code, 1);
  if (!SurfaceField::is_available()) {
    EXPECT_THAT(without.errors, HasSubstr("built without OpenVDB"));
    return;
  }
  EXPECT_THAT(without.errors, AllOf(HasSubstr("surface_views/views.json: "), HasSubstr("surface.keep_depth=true")));
  test::SolidWorld world;
  SurfaceViews views{world.camera, {}, {}, 0};
  for (const KeyFrameId id : map_.keyframes_by_age()) {
    const KeyFrame& keyframe = map_.keyframe(id);
    views.views.push_back(world.view(keyframe.frame.T_world_camera(), views.views.size()));
    views.views.back().keyframe = id;
  }
  views.settings.minimum_views = 1;
  views.settings.smallest_part = 0.0;
  write_views(path("surface_views"), views, map_);
  const Outcome made = run({"map", "export", file(), "--mesh", mesh});
  EXPECT_EQ(made.exit_code, 0) << made.errors;
  EXPECT_THAT(content(mesh), StartsWith("glTF"));
  std::filesystem::rename(path("surface_views"), path("elsewhere"));
  const std::string coarse = path("coarse.ply").string(), fine = path("fine.ply").string();
  for (const auto& [name, voxel] : {std::pair{coarse, "0.1"}, {fine, "0.04"}})
    EXPECT_EQ(run({"map", "export", file(), "--mesh", name, "--voxel", voxel, "--views", path("elsewhere").string()})
                  .exit_code,
              0);
  EXPECT_GT(read_mesh(fine).triangles.size(), 2 * read_mesh(coarse).triangles.size());
  const std::string few = path("few.ply").string();
  const std::size_t half = read_mesh(fine).triangles.size() / 2;
  EXPECT_EQ(run({"map", "export", file(), "--mesh", few, "--voxel", "0.04", "--triangles", std::to_string(half),
                 "--views", path("elsewhere").string()})
                .exit_code,
            0);
  EXPECT_LE(read_mesh(few).triangles.size(), half);
  EXPECT_THAT(run({"map", "export", file(), "--mesh", path("early.ply").string(), "--until", "-1", "--views",
                   path("elsewhere").string()})
                  .errors,
              HasSubstr("no view is as old as --until"));
  EXPECT_THAT(run({"map", "export", file(), "--mesh", path("classes.ply").string(), "--class-colours", "--views",
                   path("elsewhere").string()})
                  .errors,
              HasSubstr("surface.classes=true"));
  EXPECT_EQ(run({"map", "export", file(), "--voxel", "0.1", "--json", "-"}).exit_code, 2);
  EXPECT_THAT(run({"map", "export", file(), "--mesh", path("room.stl").string()}).errors,
              HasSubstr(".ply, .obj or .glb"));
}

TEST_F(MapCommand, HelpHasExamples) {
  EXPECT_THAT(run({"map", "--help"}).output, HasSubstr("holdfast map info out/map.hfm"));
  EXPECT_THAT(run({"map", "info", "--help"}).output, AllOf(HasSubstr("--json"), HasSubstr("Examples")));
  EXPECT_THAT(run({"map", "export", "--help"}).output, AllOf(HasSubstr("--points"), HasSubstr("Examples")));
}

}  // namespace
}  // namespace holdfast

// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/scene_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "holdfast/config/reference.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::simulation {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class SceneFile : public testing::Test {
 protected:
  // A folder of its own, because tests run at the same time.
  SceneFile()
      : file_(fs::path(testing::TempDir()) / ("holdfast_scene_file_" + std::to_string(getpid())) /
              "holdfast_scene_file_test.yaml") {
    fs::create_directories(file_.parent_path());
  }
  ~SceneFile() override { fs::remove_all(file_.parent_path()); }

  Scene read(const std::string& text, const std::vector<std::string>& overrides = {}) {
    std::ofstream(file_) << text;
    return read_scene(file_, overrides);
  }

  /// What is wrong, each without the file's name.
  std::vector<std::string> problems(const std::string& text) {
    std::vector<std::string> result;
    try {
      read(text);
    } catch (const ConfigurationError& error) {
      for (const Diagnostic& diagnostic : error.diagnostics())
        result.push_back(diagnostic.to_string().substr(file_.string().size() + 1));
    }
    return result;
  }

  fs::path file_;
};

TEST_F(SceneFile, ReadsAllThatAScenePlans) {
  const Scene scene = read(R"(
room: hall
camera: { path: waypoints, along: [[1, 2, 1.4], [3, 2, 1.4]], walking_speed: 0.5, look_at: [2, 4, 1], shake: 0.5,
  turns: [[4, 90, 300], [6, -90, 60]] }
duration: 7
frame_rate: 15
seed: 12
people:
  - name: Anna
    at: [1, 2]
    facing: [2, 2]
    height: 1.62
    start: 1.5
    repeat: false
    do:
      - walk: { to: [[2, 3], [4, 3]], speed: 1.3 }
      - stand: { for: 3, gesture: true, facing: [0, 1] }
      - sit: { on: chair 2, for: 4 }
      - push: { thing: chair 1, to: [[3, 3]] }
      - carry: { thing: box 5, to: [[2, 2]], put_at: [1, 2, 0.5] }
  - { at: [4, 4], do: [stand] }
doors:
  - { thing: door 2, angle: 1 }
lights_out:
  - { from: 2, to: 4.5 }
colour_sensor: { noise: 0 }
depth_sensor: { noise: 0.5, holes: false }
)");
  EXPECT_EQ(scene.name, "holdfast_scene_file_test");
  EXPECT_EQ(scene.room, RoomKind::hall);
  EXPECT_EQ(scene.camera.path, PathKind::waypoints);
  EXPECT_EQ(scene.camera.style.shake, 0.5);
  ASSERT_EQ(scene.camera.style.turns.size(), 2U);
  EXPECT_EQ(scene.camera.style.turns[1].begin, 6.0);
  EXPECT_DOUBLE_EQ(scene.camera.style.turns[1].angle, -EIGEN_PI / 2.0);
  EXPECT_DOUBLE_EQ(scene.camera.style.turns[0].rate, 300.0 / 180.0 * EIGEN_PI);
  EXPECT_EQ(scene.camera.waypoints.places[1], Eigen::Vector3d(3, 2, 1.4));
  EXPECT_EQ(scene.camera.waypoints.speed, 0.5);
  EXPECT_EQ(scene.camera.waypoints.target, Eigen::Vector3d(2, 4, 1));
  EXPECT_FALSE(scene.camera.waypoints.closed);
  EXPECT_EQ(scene.duration, 7.0);
  EXPECT_EQ(scene.frame_rate, 15.0);
  EXPECT_EQ(scene.seed, 12U);
  ASSERT_EQ(scene.people.size(), 2U);
  const PersonPlan& anna = scene.people[0];
  EXPECT_EQ(anna.name, "Anna");
  EXPECT_EQ(anna.at, Eigen::Vector2d(1, 2));
  EXPECT_EQ(anna.facing, Eigen::Vector2d(2, 2));
  EXPECT_EQ(anna.height, 1.62);
  EXPECT_EQ(anna.girth, std::nullopt);
  EXPECT_EQ(anna.start, 1.5);
  EXPECT_FALSE(anna.repeat);
  ASSERT_EQ(anna.actions.size(), 5U);
  const Walk& walk = std::get<Walk>(anna.actions[0]);
  EXPECT_THAT(walk.to, ElementsAre(Eigen::Vector2d(2, 3), Eigen::Vector2d(4, 3)));
  EXPECT_EQ(walk.speed, 1.3);
  const Stand& stand = std::get<Stand>(anna.actions[1]);
  EXPECT_EQ(stand.duration, 3.0);
  EXPECT_TRUE(stand.gesture);
  EXPECT_EQ(stand.facing, Eigen::Vector2d(0, 1));
  EXPECT_EQ(std::get<Sit>(anna.actions[2]).on, "chair 2");
  EXPECT_EQ(std::get<Sit>(anna.actions[2]).duration, 4.0);
  EXPECT_EQ(std::get<Push>(anna.actions[3]).thing, "chair 1");
  EXPECT_EQ(std::get<Carry>(anna.actions[4]).put_at, Eigen::Vector3d(1, 2, 0.5));
  EXPECT_EQ(std::get<Stand>(scene.people[1].actions[0]).duration, Stand{}.duration);
  EXPECT_EQ(scene.doors.at(0).thing, "door 2");
  EXPECT_EQ(scene.lights_out.at(0).to, 4.5);
  EXPECT_EQ(scene.colour_sensor.noise, 0.0);
  EXPECT_EQ(scene.depth_sensor.noise, 0.5);
  EXPECT_FALSE(scene.depth_sensor.holes);
}

TEST_F(SceneFile, NothingIsTheEmptyOffice) {
  for (const Scene& scene : {read_scene({}), read("# only a comment\n")}) {
    EXPECT_EQ(scene.room, RoomKind::office);
    EXPECT_EQ(scene.camera.path, PathKind::xyz);
    EXPECT_TRUE(scene.people.empty());
    EXPECT_EQ(scene.seed, 0U);
  }
}

TEST_F(SceneFile, CanBeOverridden) {
  const std::string text = "people:\n  - { at: [1, 2], do: [{ walk: { to: [[2, 2]] } }] }\n";
  const Scene scene = read(text, {"people.0.do.0.walk.speed=0.5", "camera.path=rpy", "depth_sensor.noise=0"});
  EXPECT_EQ(std::get<Walk>(scene.people[0].actions[0]).speed, 0.5);
  EXPECT_EQ(scene.camera.path, PathKind::rpy);
  EXPECT_EQ(scene.depth_sensor.noise, 0.0);
  EXPECT_EQ(read_scene({}, {"room=corridor"}).room, RoomKind::corridor);
}

TEST_F(SceneFile, SaysEverythingThatIsWrongWithItsPlace) {
  EXPECT_THAT(
      problems(R"(rooom: office
camera: { path: circle }
people:
  - { at: [1], do: [{ wlak: { to: [[2, 3]] } }, { walk: { to: [[2, 3, 4]] } }, { walk: {} }, { sit: { on: c, walk: 1 } }] }
  - { facing: [1, 2], dio: [] }
lights_out:
  - { from: 3, to: 2 }
)"),
      ElementsAre("1:1: a scene has no parameter 'rooom'; did you mean 'room'?",
                  HasSubstr("2:17: found 'circle' for 'path' of the camera: 'circle' is not among them"),
                  HasSubstr("4:11: found 1 number; expected a place of 2"),
                  "4:23: there is no action 'wlak'; did you mean 'walk'?",
                  HasSubstr("4:64: found 3 numbers; expected a place of 2"), HasSubstr("the action 'walk' needs 'to'"),
                  HasSubstr("the action 'sit' has no parameter 'walk'"), HasSubstr("a person needs 'at'"),
                  HasSubstr("a person has no parameter 'dio'; did you mean 'do'?"),
                  HasSubstr("7:5: the light comes back before it goes out")));
  EXPECT_THAT(problems("people: { at: [1, 2] }\n"),
              ElementsAre(HasSubstr("1:9: found a map for 'people'; expected a list")));
  EXPECT_THAT(problems("camera: { path: waypoints }\n"), ElementsAre(HasSubstr("needs 'along")));
  EXPECT_THAT(problems("camera: { path: xyz, closed: true }\n"),
              ElementsAre(HasSubstr("belongs to the path waypoints")));
  EXPECT_THAT(problems("people: [{ at: [1, 2], do: [{ walk: { to: [] } }] }]\n"), ElementsAre(HasSubstr("empty list")));
  EXPECT_THAT(problems("- office\n"), ElementsAre(HasSubstr("expected a map with room or road")));
}

TEST_F(SceneFile, ReadsARoad) {
  const Scene scene = read("road: { kind: motorway, speed: 30, traffic: 0.5, bends: 0 }\ncamera: { shake: 2 }\n");
  ASSERT_TRUE(scene.road);
  EXPECT_EQ(scene.place_name(), "motorway");
  EXPECT_EQ(scene.camera.path, PathKind::drive);
  EXPECT_EQ(scene.camera.style.shake, 2.0);
  EXPECT_EQ(scene.road->mean_speed(), 30.0);
  EXPECT_EQ(scene.road->traffic, 0.5);
  EXPECT_EQ(scene.road->bends, 0.0);
  EXPECT_EQ(read("road: { kind: street }\n").road->mean_speed(), 10.0);
}

TEST_F(SceneFile, RefusesWhatARoadCannotHave) {
  EXPECT_THAT(problems("road: { speed: 20 }\n"), ElementsAre(HasSubstr("a road needs 'kind'")));
  EXPECT_THAT(problems("road: street\n"), ElementsAre(HasSubstr("1:7: ")));
  EXPECT_THAT(problems("road: { kind: lane }\n"), ElementsAre(HasSubstr("expected one of street, motorway")));
  EXPECT_THAT(problems("road: { kind: street, speed: 90, traffic: -1, lenght: 3 }\n"),
              ElementsAre(HasSubstr("from 0 to 40"), HasSubstr("from 0 to 3"), HasSubstr("no parameter 'lenght'")));
  EXPECT_THAT(problems("road: { kind: street }\nroom: hall\npeople: []\ncamera: { path: xyz, closed: true }\n"),
              ElementsAre(HasSubstr("2:7: 'room' has no meaning beside 'road'"), HasSubstr("'people' has no meaning"),
                          HasSubstr("'path' has no meaning beside 'road'"), HasSubstr("'closed'")));
}

TEST_F(SceneFile, SaysThatItIsMissingAndWhichOneWasMeant) {
  read("room: office\n");
  try {
    read_scene(file_.parent_path() / "holdfast_scene_flie_test.yaml");
    ADD_FAILURE() << "a scene that is not there was read";
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("there is no such scene file; did you mean 'holdfast_scene_file_test.yaml'?"));
  }
}

TEST_F(SceneFile, RefusesPlacesFarFromAnyRoom) {
  for (const char* text :
       {"people: [{ at: [1e7, 2] }]\n", "people: [{ at: [1, 2], facing: [2147483647, 2] }]\n",
        "people: [{ at: [1, 2], do: [{ walk: { to: [[1e308, 2]] } }] }]\n",
        "people: [{ at: [1, 2], do: [{ push: { thing: chair 1, to: [[2, -1e7]] } }] }]\n",
        "people: [{ at: [1, 2], do: [{ carry: { thing: box 5, to: [[2, 2]], put_at: [1, 2, 60] } }] }]\n",
        "camera: { path: waypoints, along: [[0, 0, 1], [1e7, 0, 1]] }\n",
        "camera: { path: waypoints, along: [[0, 0, 1], [1, 0, 1]], look_at: [1e7, 0, 1] }\n"})
    EXPECT_THAT(problems(text), ElementsAre(HasSubstr("from -50 to 50"))) << text;
  EXPECT_THAT(problems("doors: [{ thing: door 1, shut: 1e308 }]\n"), ElementsAre(HasSubstr("from 0 to 36000")));
}

TEST(SceneSections, TellAllThatASceneCanSay) {
  const std::vector<SectionDescription> sections = scene_sections();
  const Registry registry;
  const std::string text = reference(registry, sections, "scene", ReferenceFormat::text),
                    markdown = reference(registry, sections, "scene", ReferenceFormat::markdown);
  for (const char* name :
       {"scene", "scene.road", "scene.camera", "scene.people", "scene.people.do.walk", "scene.people.do.stand",
        "scene.people.do.sit", "scene.people.do.push", "scene.people.do.carry", "scene.doors", "scene.lights_out",
        "scene.colour_sensor", "scene.depth_sensor"}) {
    EXPECT_THAT(text, HasSubstr(std::string("scene: ") + name + "\n"));
    EXPECT_THAT(markdown, HasSubstr(std::string("### `") + name + "`\n"));
  }
  EXPECT_THAT(text, testing::AllOf(HasSubstr("office | hall | corridor"), HasSubstr("shutter"), HasSubstr("put_at")));
  EXPECT_THAT(markdown, HasSubstr("| `room` | text | office | office \\| hall \\| corridor \\| open_plan |"));
}

}  // namespace
}  // namespace holdfast::simulation

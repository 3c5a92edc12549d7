// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/scene_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "holdfast/core/error.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::Vector2d;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

PersonPlan person(const Vector2d& at, std::vector<Action> actions, const std::string& name = "") {
  PersonPlan plan;
  plan.name = name;
  plan.at = at;
  plan.repeat = false;
  plan.actions = std::move(actions);
  return plan;
}

const Carry carry_box{.thing = "box 3", .to = {{3.6, 3.05}, {4.2, 3.1}}, .put_at = {4.7, 3.1, 0.0}};
const Push push_chair{.thing = "chair 1", .to = {{2.3, 3.15}, {3.0, 3.15}}};

Scene office(std::vector<PersonPlan> people) {
  Scene scene;
  scene.file = "there.yaml";
  scene.duration = 6.0;
  scene.people = std::move(people);
  return scene;
}

SceneWorld in_office(const Scene& scene) {
  static const Room furnished = furnish_room(RoomKind::office, 1);
  return make_scene_world(scene, furnished);
}

std::string refusal(const Scene& scene) {
  try {
    in_office(scene);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

std::vector<std::string> numbered_names(const SceneWorld& scene) {
  std::vector<std::string> names;
  for (const NumberedObject& numbered : scene.numbered) names.push_back(scene.world.objects[numbered.index].name);
  return names;
}

const Object& object(const SceneWorld& scene, const std::string& name) {
  const auto found = std::find_if(scene.world.objects.begin(), scene.world.objects.end(),
                                  [&](const Object& candidate) { return candidate.name == name; });
  if (found == scene.world.objects.end()) throw std::out_of_range(name);
  return *found;
}

TEST(SceneWorld, NumbersPeopleInTheirOrderThenTheThingsThatTheyAndDoorsMove) {
  Scene scene = office({person({1.3, 3.0}, {push_chair}), person({4.6, 1.5}, {}, "Anna"),
                        person({1.8, 3.0}, {carry_box}), person({2.5, 1.2}, {Walk{{{3.5, 1.2}}, 0.8}})});
  scene.doors.push_back({});
  const SceneWorld world = in_office(scene);
  ASSERT_EQ(world.numbered.size(), 7U);
  for (std::size_t i = 0; i < world.numbered.size(); ++i) EXPECT_EQ(world.numbered[i].number, i + 1);
  std::vector<std::string> names = numbered_names(world);
  EXPECT_THAT(std::vector<std::string>(names.begin(), names.begin() + 4),
              ElementsAre("person 1", "Anna", "person 3", "person 4"));
  EXPECT_THAT(std::vector<std::string>(names.begin() + 4, names.end()),
              testing::UnorderedElementsAre("chair 1", "box 3", "door 1"));
  EXPECT_TRUE(std::is_sorted(world.numbered.begin() + 4, world.numbered.end(),
                             [](const NumberedObject& a, const NumberedObject& b) { return a.index < b.index; }));
  for (std::size_t i = 0; i < world.world.objects.size(); ++i) {
    const Object& candidate = world.world.objects[i];
    const bool numbered = std::any_of(world.numbered.begin(), world.numbered.end(),
                                      [&](const NumberedObject& n) { return n.index == i; });
    EXPECT_EQ(candidate.moves(), numbered) << candidate.name;
    EXPECT_EQ(candidate.class_name == "person", static_cast<bool>(candidate.bones)) << candidate.name;
  }
  // Everybody begins at his place, with his feet on the floor.
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Isometry3d pose = world.world.objects[world.numbered[k].index].pose(0.0);
    EXPECT_LT((pose.translation().head<2>() - scene.people[k].at).norm(), 0.05) << names[k];
    EXPECT_NEAR(pose.translation().z(), 0.0, 1e-9) << names[k];
  }
}

TEST(SceneWorld, HasNothingNumberedWhereNothingMoves) {
  const SceneWorld world = in_office(Scene());
  EXPECT_TRUE(world.numbered.empty());
  EXPECT_GT(world.world.objects.size(), 50U);
  for (const Object& candidate : world.world.objects) EXPECT_FALSE(candidate.moves()) << candidate.name;
}

TEST(SceneWorld, PlansThatBeganBeforeTheFirstFrameAreUnderWay) {
  Scene from_start = office({person({1.8, 3.0}, {carry_box})}), under_way = from_start;
  from_start.duration = under_way.duration + 10.0;
  under_way.people[0].start = -10.0;
  const SceneWorld early = in_office(from_start), late = in_office(under_way);
  for (const char* name : {"person 1", "box 3"})
    for (const double time : {0.0, 1.7, 6.0})
      EXPECT_TRUE(object(late, name).pose(time).isApprox(object(early, name).pose(time + 10.0), 1e-12))
          << name << " at " << time;
  EXPECT_FALSE(object(late, "box 3").pose(0.0).isApprox(object(early, "box 3").pose(0.0), 1e-3));
  const BonePoses now = object(late, "person 1").bones(1.7), then = object(early, "person 1").bones(11.7);
  for (int bone = 0; bone < bone_count; ++bone) EXPECT_TRUE(now[bone].isApprox(then[bone], 1e-12)) << bone;

  // With a start later than 0 the person waits.
  under_way.people[0].start = 4.0;
  const SceneWorld waiting = in_office(under_way);
  EXPECT_LT((object(waiting, "person 1").pose(4.0).translation().head<2>() - Vector2d(1.8, 3.0)).norm(), 0.05);
}

TEST(SceneWorld, RefusesWhatTheRoomDoesNotAllowAndSaysWhichElementOfTheScene) {
  const PersonPlan carrier = person({1.8, 3.0}, {Stand{}, carry_box});
  EXPECT_THAT(refusal(office({carrier, person({4.0, 3.0}, {Walk{{{3.5, 2.0}}, 1.0}, Stand{}, carry_box})})),
              AllOf(StartsWith("there.yaml: people.1.do.2: person 2 wants to carry 'box 3'"),
                    HasSubstr("which person 1 moves")));
  EXPECT_THAT(refusal(office({person({4.0, 3.0}, {Stand{}, Sit{"chair 9", 2.0, false}})})),
              AllOf(HasSubstr("people.0.do.1: person 1 wants to sit on 'chair 9', which is not in the room"),
                    HasSubstr("chair 1"), HasSubstr("chair 2")));
  EXPECT_THAT(refusal(office({person({4.0, 3.0}, {}), person({2.0, 2.0}, {Walk{{{1.0, 2.0}}, 0.0}})})),
              HasSubstr("people.1.do.0: person 2 has 0"));
  EXPECT_THAT(refusal(office({person({4.0, 3.0}, {}, "Anna"), person({3.0, 3.0}, {}, "Bob"),  //
                              person({2.0, 3.0}, {}, "Anna")})),
              AllOf(HasSubstr("people.2.name: "), HasSubstr("people.0"), HasSubstr("'Anna'")));
  EXPECT_THAT(refusal(office({person({4.0, 3.0}, {}, "desk 1")})),
              AllOf(HasSubstr("people.0.name: "), HasSubstr("'desk 1'"), HasSubstr("thing in the room")));

  Scene scene = office({});
  scene.doors = {{}, {.thing = "dor 1"}};
  EXPECT_THAT(refusal(scene), AllOf(HasSubstr("doors.1.thing: there is no door 'dor 1' in the office"),
                                    HasSubstr("did you mean 'door 1'")));
  scene.doors = {{.thing = "chair 1"}};
  EXPECT_THAT(refusal(scene), HasSubstr("doors.0.thing: there is no door 'chair 1'"));
  scene.doors = {{}, {}};
  EXPECT_THAT(refusal(scene), AllOf(HasSubstr("doors.1.thing: 'door 1'"), HasSubstr("doors.0")));
  scene.doors = {{.opening = 0.0}};
  EXPECT_THAT(refusal(scene), HasSubstr("doors.0"));
}

TEST(SceneWorld, TheSeedMakesThePeopleAndNotThePlan) {
  const auto people = [](std::uint64_t seed) {
    Scene scene = office({person({1.8, 3.0}, {carry_box}), person({3.0, 1.5}, {Walk{{{4.0, 1.5}}, 0.8}})});
    scene.seed = seed;
    return in_office(scene);  // always the same furniture
  };
  const SceneWorld one = people(5), same = people(5), other = people(6);
  const auto corners = [](const SceneWorld& world, const std::string& name, double time) {
    std::vector<PosedVertex> posed;
    pose_vertices(object(world, name), time, posed);
    std::vector<Eigen::Vector3f> result;
    for (const PosedVertex& vertex : posed) result.push_back(vertex.position);
    return result;
  };
  ASSERT_EQ(one.world.objects.size(), same.world.objects.size());
  ASSERT_EQ(one.world.textures.size(), same.world.textures.size());
  for (const Object& each : one.world.objects)
    EXPECT_TRUE(corners(one, each.name, 2.5) == corners(same, each.name, 2.5)) << each.name;
  EXPECT_EQ(numbered_names(one), numbered_names(other));
  for (const char* name : {"person 1", "person 2"}) {
    EXPECT_FALSE(corners(one, name, 2.5) == corners(other, name, 2.5)) << name;
    EXPECT_LT((object(one, name).pose(0.0).translation() - object(other, name).pose(0.0).translation()).norm(), 0.1);
  }
  // Two people of one scene are not built alike.
  EXPECT_NE(object(one, "person 1").mesh.vertices.back().position,
            object(one, "person 2").mesh.vertices.back().position);

  Scene told = office({person({1.8, 3.0}, {})});
  told.people[0].height = 1.95, told.people[0].girth = 0.9;
  const auto top = [&](const Scene& scene) {
    const std::vector<Eigen::Vector3f> points = corners(in_office(scene), "person 1", 0.0);
    return std::max_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.z() < b.z(); })
        ->z();
  };
  EXPECT_NEAR(top(told), 1.95F, 0.06F);
}

}  // namespace
}  // namespace holdfast::simulation

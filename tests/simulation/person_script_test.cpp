// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/person_script.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "holdfast/core/error.hpp"
#include "holdfast/simulation/room.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

const Skeleton skeleton({1.75, 1.0});
const Eigen::AlignedBox3d walls(Vector3d(-1, -1, 0), Vector3d(8, 6, 2.6));

ThingPlace thing(const std::string& class_name, const Vector3d& place, double yaw, const Vector3d& low,
                 const Vector3d& high) {
  ThingPlace result;
  result.class_name = class_name;
  result.T_world_thing = Eigen::Translation3d(place) * Eigen::AngleAxisd(yaw, Vector3d::UnitZ());
  result.extents = {low, high};
  return result;
}

ThingPlaces room() {
  ThingPlaces things;
  const Vector3d chair_low(-0.31, -0.28, 0), chair_high(0.31, 0.28, 1.05), box_low(-0.2, -0.15, 0),
      box_high(0.2, 0.15, 0.28);
  things["chair 1"] = thing("chair", {2, 1, 0}, 1.0, chair_low, chair_high);
  things["chair 2"] = thing("chair", {4, 1, 0}, 0.3, chair_low, chair_high);
  things["box 1"] = thing("box", {2, 3, 0}, 0.4, box_low, box_high);
  things["desk 1"] = thing("desk", {5, 4.6, 0}, 0.0, {-0.8, -0.35, 0}, {0.8, 0.35, 0.73});
  things["box 2"] = thing("box", {0.5, 4.6, 0}, 0.0, {-0.5, -0.45, 0}, {0.5, 0.45, 1.0});
  return things;
}

PersonPlan plan(std::vector<Action> actions) {
  PersonPlan result;
  result.name = "person 1";
  result.at = {0.5, 0.5};
  result.repeat = false;
  result.actions = std::move(actions);
  return result;
}

const Carry carry{.thing = "box 1", .to = {{4.0, 2.0}}, .put_at = {5, 4.45, 0.73}};
const Push push{.thing = "chair 2", .to = {{4.5, 2.5}, {3, 3.3}}};

PersonScript script(const PersonPlan& plan, double duration = 40.0, std::uint64_t seed = 3) {
  ThingPlaces things = room();
  return {skeleton, plan, things, walls, duration, Random(seed)};
}

BonePoses in_world(const PersonScript& script, double time) {
  BonePoses poses = skeleton.place(script.posture(time));
  for (Isometry3d& pose : poses) pose = script.T_world_person(time) * pose;
  return poses;
}

double lowest_sole(const BonePoses& poses, Bone foot) {
  const double length = skeleton.length(foot), depth = skeleton.ankle_height();
  return std::min((poses[index(foot)] * Vector3d(0, 0.25 * length, -depth)).z(),
                  (poses[index(foot)] * Vector3d(0, -0.75 * length, -depth)).z());
}

double knee(const Posture& posture, Bone shin) {
  const Eigen::Matrix3d turn = posture.rotations[index(shin)].toRotationMatrix();
  return std::atan2(turn(2, 1), turn(1, 1));
}

std::string refusal(std::vector<Action> actions) {
  try {
    script(plan(std::move(actions)));
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

TEST(PersonScript, EverythingIsSmoothAndOnTheFloor) {
  PersonPlan everything =
      plan({Walk{{{3, 0.3}, {5, 2}, {3, 2}}, 1.1}, Stand{2.0, true, {}}, Sit{"chair 1", 3.0, true}, push, carry});
  everything.repeat = true;
  const PersonScript person = script(everything, 80.0);
  BonePoses before = in_world(person, 0.0), at = in_world(person, 0.001);
  for (int i = 0; i < 80000; ++i) {
    if (i % 50 >= 5) continue;  // five milliseconds in fifty, for the test to be quick
    const double time = 0.001 * i;
    if (i % 50 == 0) before = in_world(person, time), at = in_world(person, time + 0.001);
    const BonePoses after = in_world(person, time + 0.002);
    for (int bone = 0; bone < bone_count; ++bone) {
      const Vector3d first = at[bone].translation() - before[bone].translation(),
                     second = after[bone].translation() - at[bone].translation();
      ASSERT_LT(second.norm(), 0.006) << "bone " << bone << " at " << time;
      ASSERT_LT((second - first).norm(), 3e-4) << "bone " << bone << " at " << time;
      const double turn = Eigen::AngleAxisd(at[bone].linear().transpose() * after[bone].linear()).angle();
      ASSERT_LT(turn, 0.02) << "bone " << bone << " at " << time;
    }
    const double sole = std::min(lowest_sole(after, Bone::left_foot), lowest_sole(after, Bone::right_foot));
    ASSERT_NEAR(sole, 0.0, 0.002) << time;
    ASSERT_LT((person.T_world_person(time).translation().head<2>() - before[0].translation().head<2>()).norm(), 0.2);
    before = at;
    at = after;
  }
  for (const std::string& name : person.moved_things()) {
    const auto motion = person.thing_motion(name);
    for (double time = 0.0; time < 80.0; time += 0.01) {
      const Isometry3d a = motion(time), b = motion(time + 0.001), c = motion(time + 0.002);
      ASSERT_LT((b.translation() - a.translation()).norm(), 0.003) << name << " at " << time;
      ASSERT_LT((c.translation() - 2.0 * b.translation() + a.translation()).norm(), 1e-4) << name << " at " << time;
      ASSERT_LT(Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle(), 0.005) << name << " at " << time;
    }
  }
}

TEST(PersonScript, WalksLikePeopleDo) {
  const PersonScript person = script(plan({Walk{{{6.5, 0.5}}, 1.1}}), 10.0);
  EXPECT_NEAR((person.T_world_person(4.0).translation() - person.T_world_person(2.0).translation()).norm(), 2.2, 1e-6);
  EXPECT_TRUE(person.T_world_person(9.0).translation().isApprox(Vector3d(6.5, 0.5, 0), 1e-9));
  EXPECT_LT((person.T_world_person(3.0).linear() * -Vector3d::UnitY() - Vector3d::UnitX()).norm(), 1e-9);
  double most_knee = 0.0, least_knee = 9.0, least_height = 9.0, most_height = 0.0, forward = 0.0, back = 0.0;
  for (double time = 2.0; time < 4.0; time += 0.01) {
    const Posture posture = person.posture(time);
    for (const Bone shin : {Bone::left_shin, Bone::right_shin}) {
      most_knee = std::max(most_knee, knee(posture, shin));
      least_knee = std::min(least_knee, knee(posture, shin));
    }
    const Vector3d thigh = posture.rotations[index(Bone::left_thigh)] * -Vector3d::UnitZ();
    forward = std::max(forward, std::atan2(-thigh.y(), -thigh.z()));
    back = std::min(back, std::atan2(-thigh.y(), -thigh.z()));
    least_height = std::min(least_height, posture.pelvis.z());
    most_height = std::max(most_height, posture.pelvis.z());
  }
  constexpr double degree = 0.0174533;
  EXPECT_NEAR(most_knee, 62 * degree, 8 * degree);  // Winter 1991: 60 to 65 degrees in the swing
  EXPECT_GT(least_knee, 3 * degree);
  EXPECT_NEAR(forward, 30 * degree, 8 * degree);
  EXPECT_NEAR(back, -12 * degree, 5 * degree);
  EXPECT_GT(most_height - least_height, 0.005);
  EXPECT_LT(most_height - least_height, 0.05);
}

TEST(PersonScript, FeetDoNotSlideAndKneesDoNotBendBack) {
  const PersonScript person =
      script(plan({Walk{{{4, 0.5}, {5, 3}, {1, 3}}, 1.1}, Stand{2.0, false, Vector2d(0, 0)}}), 20.0);
  for (const Side side : {Side::left, Side::right}) {
    const Bone foot = leg(side).end;
    const double length = skeleton.length(foot), depth = skeleton.ankle_height();
    for (double time = 0.0; time < 15.0; time += 0.01) {
      const BonePoses poses = in_world(person, time);
      ASSERT_GT(knee(person.posture(time), leg(side).lower), 0.0) << time;
      const FootPose wanted = person.foot(side, time);
      ASSERT_LT((poses[index(foot)].translation() - wanted.ankle).norm(), 0.003) << "the leg reaches its foot " << time;
      if (!wanted.planted || !person.foot(side, time + 0.01).planted) continue;
      // What rests on the floor stays: the heel, the toes or both.
      const BonePoses next = in_world(person, time + 0.01);
      double least = 1.0;
      for (const double y : {0.25 * length, -0.75 * length})
        least = std::min(
            least,
            ((next[index(foot)] * Vector3d(0, y, -depth)) - (poses[index(foot)] * Vector3d(0, y, -depth))).norm());
      ASSERT_LT(least, 0.0005) << time;
    }
  }
}

TEST(PersonScript, SitsOnTheChairWithFeetOnTheFloor) {
  const PersonScript person = script(plan({Sit{"chair 1", 5.0, false}}));
  double seated = 0.0;
  while (seated < 30.0 && person.posture(seated).pelvis.z() > 0.7) seated += 0.1;
  const double time = seated + 3.0;
  const ThingPlaces things = room();
  const Isometry3d& chair = things.at("chair 1").T_world_thing;
  EXPECT_LT((person.T_world_person(time).translation() - chair.translation()).norm(), 0.01);
  EXPECT_TRUE(person.T_world_person(time).linear().isApprox(chair.linear(), 1e-9)) << "the back to the chair's back";
  const BonePoses poses = in_world(person, time);
  EXPECT_NEAR(poses[0].translation().z(), 0.50 + 0.095, 0.02);
  EXPECT_NEAR(lowest_sole(poses, Bone::left_foot), 0.0, 0.001);
  EXPECT_NEAR(lowest_sole(poses, Bone::right_foot), 0.0, 0.001);
  EXPECT_GT(knee(person.posture(time), Bone::left_shin), 1.2);
  // The palms are on the thighs.
  for (const Side side : {Side::left, Side::right}) {
    const Vector3d palm =
        poses[index(leg(side).upper)].inverse() * palm_of(skeleton, side, poses[index(arm(side).end)]);
    EXPECT_NEAR(palm.z(), -0.29, 0.08);
    EXPECT_NEAR(palm.y(), -0.074, 0.03);
  }
  EXPECT_NEAR(person.posture(30.0).pelvis.z(), 0.53 * 1.75, 0.02) << "stands again";
}

TEST(PersonScript, CarriesTheBoxInBothHands) {
  const PersonScript person = script(plan({carry}));
  const auto motion = person.thing_motion("box 1");
  const ThingPlaces things = room();
  const auto times = person.holding_times("box 1");
  ASSERT_EQ(times.size(), 1U);
  const auto [grip, release] = times[0];
  for (double time = 0.0; time <= grip; time += 0.1)
    ASSERT_TRUE(motion(time).matrix() == things.at("box 1").T_world_thing.matrix()) << time;
  for (double time = release; time < 40.0; time += 0.1) ASSERT_TRUE(motion(time).translation() == carry.put_at) << time;
  EXPECT_TRUE(motion(release).linear().col(2).isApprox(Vector3d::UnitZ(), 1e-9)) << "stands upright";
  double highest = 0.0;
  for (double time = grip; time <= release; time += 0.02) {
    const BonePoses poses = in_world(person, time);
    for (const Side side : {Side::left, Side::right}) {
      const Vector3d palm = motion(time).inverse() * palm_of(skeleton, side, poses[index(arm(side).end)]);
      const double outside = things.at("box 1").extents.exteriorDistance(palm);
      ASSERT_LT(outside, 0.03) << time;
      // On a side, not within.
      const double to_side = std::min(0.2 - std::abs(palm.x()), 0.15 - std::abs(palm.y()));
      ASSERT_LT(to_side, 0.03) << time;
    }
    highest = std::max(highest, motion(time).translation().z());
  }
  EXPECT_NEAR(highest, 0.91, 0.1) << "before the chest";
}

TEST(PersonScript, StandsBetweenTheWallsOfACorridorToLift) {
  // Its sections of wall have boxes around them that fill it from floor to ceiling.
  const Room corridor = furnish_room(RoomKind::corridor, 1);
  for (const std::string box : {"box 1", "box 3"}) {  // at either wall
    ThingPlaces things;
    for (const Object& object : corridor.world.objects) {
      ThingPlace& place = things[object.name];
      place.T_world_thing = object.T_world_object;
      place.class_name = object.class_name;
      for (const Vertex& vertex : object.mesh.vertices) place.extents.extend(vertex.position.cast<double>());
    }
    PersonPlan carrying = plan({Carry{.thing = box, .to = {{9.0, 1.1}}, .put_at = {9.5, 1.2, 0}}});
    carrying.at = {8.5, 1.1};
    const PersonScript person(skeleton, carrying, things, corridor.stage.walls, 20.0, Random(3));
    EXPECT_TRUE(person.thing_motion(box)(40.0).translation() == Vector3d(9.5, 1.2, 0));
    for (double time = 0.0; time < 40.0; time += 0.1) {
      const Vector3d at = person.T_world_person(time).translation();
      ASSERT_GT(std::min(at.y(), 2.6 - at.y()), 0.199) << "within a wall at " << time;
    }
  }
  // Beside a wall that nothing marks there is no place behind it.
  ThingPlaces things;
  things["box 1"] = thing("box", {0.3, 1.0, 0}, 0.0, {-0.2, -0.2, 0}, {0.2, 0.2, 0.3});
  PersonPlan carrying = plan({Carry{.thing = "box 1", .to = {}, .put_at = {0.3, 2.0, 0}}});
  carrying.at = {-1.0, 1.5};
  const Eigen::AlignedBox3d bare(Vector3d::Zero(), Vector3d(4, 4, 2.6));
  const PersonScript person(skeleton, carrying, things, bare, 20.0, Random(3));
  const auto [grip, release] = person.holding_times("box 1").at(0);
  EXPECT_GT(person.T_world_person(grip).translation().x(), 0.199);
  EXPECT_GT(person.T_world_person(release).translation().x(), 0.199);
}

TEST(PersonScript, PutsTheBoxBackWhenThePlanRepeats) {
  PersonPlan again = plan({carry});
  again.repeat = true;
  const PersonScript person = script(again, 60.0);
  const auto times = person.holding_times("box 1");
  ASSERT_GE(times.size(), 2U);
  const auto motion = person.thing_motion("box 1");
  EXPECT_TRUE(motion(times[1].first).translation() == carry.put_at) << "lies where it was put";
  EXPECT_GT(motion(0.5 * (times[1].first + times[1].second)).translation().z(), 0.8);
  EXPECT_TRUE(motion(times[1].second).translation() == carry.put_at);
}

TEST(PersonScript, PushesTheChairFromBehind) {
  const PersonScript person = script(plan({push}));
  const auto motion = person.thing_motion("chair 2");
  const auto [grip, release] = person.holding_times("chair 2").at(0);
  EXPECT_TRUE(motion(0.0).translation() == Vector3d(4, 1, 0));
  EXPECT_TRUE(motion(40.0).translation() == Vector3d(3, 3.3, 0));
  for (double time = grip; time <= release; time += 0.02) {
    const Isometry3d chair = motion(time);
    EXPECT_EQ(chair.translation().z(), 0.0);
    const Vector3d person_in_chair = chair.inverse() * person.T_world_person(time).translation();
    ASSERT_NEAR(person_in_chair.y(), 0.84, 0.12) << time << ": behind the back, which is at +y";
    ASSERT_NEAR(person_in_chair.x(), 0.0, 0.01) << time;
    const BonePoses poses = in_world(person, time);
    for (const Side side : {Side::left, Side::right}) {
      const Vector3d palm = chair.inverse() * palm_of(skeleton, side, poses[index(arm(side).end)]);
      ASSERT_LT((palm - Vector3d(0.15 * sign(side), 0.25, 1.05)).norm(), 0.03) << time;
    }
  }
}

TEST(PersonScript, DoesNotPushAgainWhatIsWhereItBelongs) {
  PersonPlan again = plan({Push{.thing = "chair 2", .to = {{4.5, 2.5}}}, Stand{1.0, false, {}}});
  again.repeat = true;
  EXPECT_EQ(script(again, 60.0).holding_times("chair 2").size(), 1U);
  EXPECT_NE(refusal({Push{.thing = "chair 2", .to = {{4.0, 1.0}}}}).find("where it stands"), std::string::npos);
}

TEST(PersonScript, SameSeedSameBytes) {
  const PersonPlan moving = plan({Walk{{{3, 1}}, 1.2}, Stand{3.0, true, {}}, carry});
  const PersonScript first = script(moving), second = script(moving), other = script(moving, 40.0, 4);
  bool differs = false;
  for (const double time : {7.3, 1.0, 30.0, 5.5, 1.0}) {
    const Posture a = first.posture(time), b = second.posture(time), c = other.posture(time);
    for (int i = 0; i < bone_count; ++i) {
      ASSERT_EQ(std::memcmp(&a.rotations[i], &b.rotations[i], sizeof(a.rotations[i])), 0);
      differs |= !a.rotations[i].isApprox(c.rotations[i], 1e-3);
    }
  }
  EXPECT_TRUE(differs) << "another seed, another style";
}

TEST(PersonScript, RefusesWhatCannotBeDone) {
  EXPECT_NE(refusal({Sit{"chair 9", 3.0, false}}).find("person 1 wants to sit on 'chair 9'"), std::string::npos);
  EXPECT_NE(refusal({Sit{"chair 9", 3.0, false}}).find("chair 1, chair 2"), std::string::npos);
  EXPECT_NE(refusal({Sit{"box 1", 3.0, false}}).find("expected a chair"), std::string::npos);
  EXPECT_NE(refusal({Walk{{}, 1.0}}).find("without places"), std::string::npos);
  EXPECT_NE(refusal({Walk{{{1, 1}}, 0.0}}).find("speed"), std::string::npos);
  EXPECT_NE(refusal({Carry{.thing = "box 2", .to = {}}}).find("at most 80 cm"), std::string::npos);
  EXPECT_NE(refusal({Carry{.thing = "box 1", .to = {}, .put_at = {3, 3, 2.4}}}).find("put down"), std::string::npos);
}

TEST(PersonScript, MovesOnlyLooseThingsOnWhichNothingStands) {
  const auto carried = [](const std::string& name) {
    return Carry{.thing = name, .to = {{4.0, 2.0}}, .put_at = {5, 4.45, 0.73}};
  };
  const auto pushed = [](const std::string& name) { return Push{.thing = name, .to = {{3.0, 3.0}}}; };
  const std::string desk = refusal({pushed("desk 1")});
  EXPECT_NE(desk.find("which is a desk and stays where it is"), std::string::npos) << desk;
  EXPECT_NE(desk.find("box 1, chair 2, box 2, chair 1"), std::string::npos) << "the nearest first: " << desk;
  EXPECT_NE(refusal({carried("desk 1")}).find("stays where it is"), std::string::npos);

  const auto stacked = [](std::vector<Action> actions) {
    ThingPlaces things = room();
    things["box 3"] = thing("box", {2.05, 2.95, 0.28}, 0.9, {-0.15, -0.12, 0}, {0.15, 0.12, 0.2});
    things["mug 1"] = thing("mug", {4.05, 1.05, 0.5}, 0.0, {-0.04, -0.04, 0}, {0.04, 0.04, 0.1});
    try {
      PersonScript(skeleton, plan(std::move(actions)), things, walls, 20.0, Random(1));
    } catch (const ConfigurationError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string lower = stacked({carried("box 1")});
  EXPECT_NE(lower.find("on which 'box 3' stands"), std::string::npos) << lower;
  EXPECT_EQ(lower.find("box 2"), std::string::npos) << "is too wide: " << lower;
  EXPECT_NE(stacked({pushed("chair 2")}).find("on which 'mug 1' stands"), std::string::npos);
  EXPECT_NE(stacked({Sit{"chair 2", 2.0, false}}).find("on which 'mug 1' stands"), std::string::npos);
  EXPECT_NE(stacked({pushed("box 3")}).find("28 cm above the floor"), std::string::npos);
  const Carry away{.thing = "box 3", .to = {{4.0, 2.0}}, .put_at = {5.3, 4.45, 0.73}};
  EXPECT_EQ(stacked({away, carried("box 1")}), "") << "one after the other";
}

TEST(PersonScript, PutsThingsDownWhereSomethingBearsThem) {
  const auto put = [](double x, double y, double z) {
    return Carry{.thing = "box 1", .to = {{4.0, 2.0}}, .put_at = {x, y, z}};
  };
  const std::string in_air = refusal({put(5, 4.45, 0.5)});
  EXPECT_NE(in_air.find("0.50 m, where nothing bears it; expected 0.73 m, the top of 'desk 1'"), std::string::npos)
      << in_air;
  EXPECT_NE(refusal({put(3, 3, 0.1)}).find("expected 0.00 m, the floor"), std::string::npos);
  EXPECT_NE(refusal({put(3, 7, 0.0)}).find("outside the room"), std::string::npos);
  EXPECT_EQ(refusal({put(3, 3, 0.0)}), "");
  EXPECT_EQ(refusal({put(5, 4.45, 0.74)}), "");

  // What bears it cannot be taken away by others, before or afterwards.
  const Carry on_seat = put(4, 1, 0.5);
  for (const bool first : {true, false}) {
    ThingPlaces things = room();
    PersonPlan putting = plan({on_seat}), pushing = plan({push});
    pushing.name = "person 2";
    PersonScript(skeleton, first ? putting : pushing, things, walls, 20.0, Random(1));
    EXPECT_THROW(PersonScript(skeleton, first ? pushing : putting, things, walls, 20.0, Random(1)), ConfigurationError);
  }
}

TEST(PersonScript, OnePersonHasAThingWhoeverComesFirst) {
  const Sit sit{"chair 2", 2.0, false};
  const auto conflict = [](const Action& mine, const Action& yours) {
    ThingPlaces things = room();
    PersonPlan first = plan({mine}), second = plan({yours});
    second.name = "person 2";
    PersonScript(skeleton, first, things, walls, 20.0, Random(1));
    try {
      PersonScript(skeleton, second, things, walls, 20.0, Random(1));
    } catch (const ConfigurationError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(conflict(push, sit).find("person 2 wants to sit on 'chair 2', which person 1 moves"), std::string::npos);
  EXPECT_NE(conflict(sit, push).find("person 2 wants to push 'chair 2', which person 1 uses"), std::string::npos);
  EXPECT_NE(conflict(sit, sit).find("person 2 wants to sit on 'chair 2', which person 1 uses"), std::string::npos);
  EXPECT_NE(conflict(push, push).find("which person 1 moves"), std::string::npos);
  EXPECT_EQ(conflict(Sit{"chair 1", 2.0, false}, sit), "");
  EXPECT_EQ(refusal({sit, push, sit}), "") << "one person may do both";
}

}  // namespace
}  // namespace holdfast::simulation

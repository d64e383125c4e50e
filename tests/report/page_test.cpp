// What a page holds: where bodies and feet are, and text that stays text.
#include "report/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "env/reward.h"
#include "ik/leg_kinematics.h"
#include "physics/robot/multibody.h"
#include "physics/robot_files/data_path.h"
#include "report/mesh_detail.h"
#include "report/page_template.h"
#include "report/scene.h"
#include "report/verdict_document.h"
#include "report/watched_episodes.h"
#include "study/rollout.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot_files/mesh_bytes.h"
#include "tests/report/walked_motion.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

Vector3 vector_at(const std::vector<double>& values, std::size_t at) {
  return {values.at(at), values.at(at + 1), values.at(at + 2)};
}

/// One upright stand of the bundled robot, with whatever else a test asks for.
Trace standing(const RobotDescription& robot, std::size_t rows, double x = 0) {
  Trace trace;
  TraceSample sample;
  sample.state.q = robot.home;
  sample.targets.q = JointVector::Zero(static_cast<Eigen::Index>(robot.actuated_joints().size()));
  sample.torques = JointVector::Zero(robot.joint_count());
  for (std::size_t i = 0; i < rows; ++i) {
    sample.state.time = 0.002 * static_cast<double>(i);
    sample.state.p_WB = {x * static_cast<double>(i), 0, robot.home_height};
    trace.push_back(sample);
  }
  return trace;
}

class PageOfEngine : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(PageOfEngine);

TEST_P(PageOfEngine, BodiesAndFeetAreWhereTheTraceHasThem) {
  const auto robot = scenes::quadruped();
  const WalkConfig config = short_rough_walk();
  const RecordedRun walked = walk_in(GetParam(), config);
  PageNumbers numbers;
  const ordered_json document =
      motion_document({robot, LoadedWalk(config).world.terrain, {walked}, {}}, numbers);
  const ordered_json &run = document.at("runs").at(0), &legs = document.at("scene").at("legs");
  const std::vector<double> times = floats(numbers, run.at("time")), poses = floats(numbers, run.at("poses")),
                            feet = floats(numbers, run.at("feet")),
                            forces = floats(numbers, run.at("forces"));
  const std::vector<std::size_t> rows = frame_rows(walked.times());
  ASSERT_EQ(rows.size(), times.size());
  ASSERT_GT(rows.size(), 50U);
  EXPECT_EQ(rows.back() + 1, walked.samples.size());
  EXPECT_TRUE(run.at("force_directions"));

  std::vector<Pose> bodies;
  for (std::size_t frame = 0; frame < rows.size(); ++frame) {
    const TraceSample& sample = walked.samples[rows[frame]];
    EXPECT_NEAR(times[frame], sample.state.time, 1e-6);  // floats of some seconds
    forward_kinematics(*robot, sample.state, bodies);
    for (const Leg leg : kLegs) {
      const std::size_t i = index(leg);
      // The foot as a viewer finds it: its place in its body, at that body's pose.
      const std::size_t body = legs.at(i).at("body"), at = 7 * (frame * bodies.size() + body);
      const std::vector<double> centre = legs.at(i).at("foot");
      const Quaternion q(poses.at(at + 6), poses.at(at + 3), poses.at(at + 4), poses.at(at + 5));
      const Vector3 shown = vector_at(poses, at) + q * vector_at(centre, 0);
      const Vector3 truth = foot_position(*robot, leg, bodies);
      // Floats have 7 digits: a tenth of a micrometre here. 1e-4 m is what nobody sees in a picture.
      EXPECT_LT((shown - truth).norm(), 1e-6) << name(leg) << " at " << times[frame] << " s";
      EXPECT_LT((vector_at(feet, 12 * frame + 3 * i) - truth).norm(), 1e-6);
      EXPECT_LT((vector_at(forces, 12 * frame + 3 * i) - sample.force[leg]).norm(),
                1e-5 * (1 + sample.load[leg]));
      EXPECT_NEAR(sample.force[leg].norm(), sample.load[leg], 1e-9 * (1 + sample.load[leg]));
    }
  }
}

TEST(Scene, TheGroundIsTheTerrainUnderTheWay) {
  const auto robot = scenes::quadruped();
  const WalkConfig config = short_rough_walk();
  const Terrain terrain = LoadedWalk(config).world.terrain;
  PageNumbers numbers;
  const ordered_json scene = scene_document(*robot, terrain, {{0, 0}, {0.2, 0.1}}, numbers);
  const ordered_json& ground = scene.at("ground");
  const std::vector<double> heights = floats(numbers, ground.at("heights"));
  const int columns = ground.at("columns"), rows = ground.at("rows");
  ASSERT_EQ(heights.size(), static_cast<std::size_t>(columns * rows));
  const double x = ground.at("x"), y = ground.at("y"), cell_x = ground.at("cell_x"),
               cell_y = ground.at("cell_y");
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      // Samples are corners of the field, whose heights are floats: but for the place of the corner they are
      // exact.
      EXPECT_NEAR(heights[static_cast<std::size_t>(r * columns + c)],
                  terrain.height(x + c * cell_x, y + r * cell_y), 1e-9);
    }
  }
  const double reach = scene.at("reach");
  EXPECT_LE(x, -reach);
  EXPECT_GE(x + (columns - 1) * cell_x, 0.2 + reach);
  EXPECT_LE(y, -reach);
  EXPECT_GE(y + (rows - 1) * cell_y, 0.1 + reach);
  EXPECT_LT((columns - 1) * cell_x, 0.2 + 2 * reach + 2 * cell_x + 1e-9) << "no more of it than is near";
}

TEST(Motion, RunsApartAreMeasuredAndTheirPartingIsFound) {
  const auto robot = scenes::quadruped();
  PageNumbers numbers;
  // The second base moves by a five hundredth of a leg length every step of 2 ms: beyond a twentieth at the
  // 26th.
  const double step = robot->home_height / 500;
  const ordered_json document = motion_document(
      {robot, {}, {{"a", "", standing(*robot, 100)}, {"b", "", standing(*robot, 100, step)}}, {}}, numbers);
  const ordered_json& pair = document.at("pairs").at(0);
  EXPECT_FALSE(pair.at("same").get<bool>());
  const double begin = floats(numbers, document.at("runs").at(0).at("time")).front();
  EXPECT_NEAR(pair.at("parting").at("time_s").get<double>() - begin, 0.052, 0.0021);  // a step's rounding
  EXPECT_EQ(pair.at("parting").at("standing_m"), 0);
  for (const ordered_json& panel : document.at("panels")) {
    if (panel.at("title") != "Bases apart") continue;
    const std::vector<double> apart = floats(numbers, panel.at("series").at(0).at("values"));
    EXPECT_NEAR(apart.back(), 99 * step, 1e-7);  // single precision
    EXPECT_TRUE(panel.at("log"));
    return;
  }
  ADD_FAILURE() << "no panel of the bases";
}

TEST(Motion, TracesAtDifferentTimesAreReplayedWithoutDifferences) {
  const auto robot = scenes::quadruped();
  Trace slower = standing(*robot, 50);
  for (TraceSample& sample : slower) sample.state.time *= 1.5;
  PageNumbers numbers;
  const ordered_json document =
      motion_document({robot, {}, {{"a", "", standing(*robot, 50)}, {"b", "", slower}}, {}}, numbers);
  EXPECT_TRUE(document.at("pairs").empty());
  EXPECT_EQ(document.at("notes").size(), 1U);
}

TEST(Motion, FramesAreAHundredASecondAndTheLastRow) {
  std::vector<double> time;
  for (int i = 0; i <= 502; ++i) time.push_back(0.5 + 0.002 * i);
  const std::vector<std::size_t> rows = frame_rows(time);
  ASSERT_EQ(rows.size(), 102U);
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) EXPECT_EQ(rows[i], 5 * i);
  EXPECT_EQ(rows.back(), 502U);
  std::vector<double> longer;
  for (int i = 0; i < 90'000; ++i) longer.push_back(0.02 * i);
  EXPECT_LE(frame_rows(longer).size(), kMaxFrames);
}

TEST(Episodes, EarnInTheirColumnsWhatTheRolloutSays) {
  if (available_engines().empty()) GTEST_SKIP() << "no engine";
  EnvConfig config;
  config.engine = available_engines().front();
  config.episode_seconds = 0.4;
  const Rollout rollout = roll_out(config, std::vector<std::string>{"random"}, {2, 1, 5});
  const Motion motion =
      watch_episodes({{"one", config, find_policy("random")}, {"other", config, find_policy("zero")}}, 5);
  ASSERT_EQ(motion.runs.size(), 2U);
  const RewardTerms& earned = rollout.policies.front().episodes.front().reward_terms;
  int counted = 0;
  for (std::size_t i = 0; i < RewardTerms::size(); ++i) {
    const std::string column = std::string(kRewardColumn) + std::string(reward_terms()[i].name);
    const std::vector<double>* steps = motion.runs[0].column(column);
    EXPECT_EQ(steps != nullptr, config.reward[i] != 0) << column;
    if (steps == nullptr) continue;
    ++counted;
    // The same sum in the same order.
    EXPECT_EQ(std::accumulate(steps->begin(), steps->end(), 0.0), earned[i]) << column;
  }
  EXPECT_GT(counted, 2);
  EXPECT_NE(motion.runs[0].samples.back().state.p_WB, motion.runs[1].samples.back().state.p_WB);
}

TEST(NumbersOfAPage, AreThereOnceHoweverOftenTheyAreAdded) {
  PageNumbers numbers;
  const std::vector<double> mesh{1, 2, 3}, other{1, 2};
  const ordered_json first = numbers.add(mesh);
  EXPECT_NE(numbers.add(other), first);
  EXPECT_EQ(numbers.add(mesh), first);
  EXPECT_EQ(numbers.words().size(), 5U);
}

// A sphere of triangles between circles of latitude.
TriangleMesh sphere(double radius, std::uint32_t rings) {
  TriangleMesh mesh;
  const std::uint32_t around = 2 * rings;
  for (std::uint32_t i = 0; i <= rings; ++i) {
    for (std::uint32_t k = 0; k < around; ++k) {
      const double latitude = M_PI * i / rings, longitude = 2 * M_PI * k / around;
      mesh.vertices.emplace_back(radius * std::sin(latitude) * std::cos(longitude),
                                 radius * std::sin(latitude) * std::sin(longitude),
                                 radius * std::cos(latitude));
    }
  }
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t a = i * around + k, b = i * around + (k + 1) % around;
      mesh.triangles.insert(mesh.triangles.end(), {a, a + around, b, b, a + around, b + around});
    }
  }
  return mesh;
}

double volume(const TriangleMesh& mesh) {
  double six = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
    const auto corner = [&](std::size_t k) { return mesh.vertices[mesh.triangles[t + k]]; };
    six += corner(0).dot(corner(1).cross(corner(2)));
  }
  return six / 6;
}

TEST(CoarserMeshes, KeepTheirShapeWithFewerTriangles) {
  const TriangleMesh fine = sphere(1, 100);
  const double cell = 0.1;
  const TriangleMesh coarse = coarser(fine, cell);
  EXPECT_LT(coarse.triangles.size(), fine.triangles.size() / 8);
  for (const Vector3& p : coarse.vertices) EXPECT_NEAR(p.norm(), 1, cell * std::sqrt(3));
  // Positive as before: what was outside is outside. A surface of 4 pi that moves by a tenth of a cube at
  // most.
  EXPECT_NEAR(volume(coarse), volume(fine), 0.1 * cell * 4 * M_PI);
  std::set<std::array<std::uint32_t, 3>> seen;
  for (std::size_t t = 0; t < coarse.triangles.size(); t += 3) {
    const std::array<std::uint32_t, 3> corners{coarse.triangles[t], coarse.triangles[t + 1],
                                               coarse.triangles[t + 2]};
    EXPECT_TRUE(corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]);
    EXPECT_TRUE(seen.insert(corners).second);
  }
  const TriangleMesh same = coarser(fine, 1e-9);
  EXPECT_NEAR(volume(same), volume(fine), 1e-9);
  EXPECT_TRUE(coarser(fine, 10).triangles.empty() || coarser(fine, 10).vertices.size() <= 8)
      << "eight cubes meet";
}

TEST(ChartsOfAPage, HoldFinitePointsInTheOrderOfX) {
  Chart chart;
  const std::vector<Chart::Point> points{{3, 1}, {1, 2}, {2, NAN}, {HUGE_VAL, 1}};
  chart.series.push_back({"a", 2, Chart::Series::Style::kLine, points});
  chart.series.push_back({"b", 0, Chart::Series::Style::kPath, points});
  PageNumbers numbers;
  const ordered_json json = to_json(Charts{"some", {chart}}, numbers);
  EXPECT_EQ(json.at("title"), "some");
  const ordered_json &line = json.at("charts").at(0).at("series").at(0),
                     &path = json.at("charts").at(0).at("series").at(1);
  EXPECT_EQ(line.at("points"), ordered_json::parse("[[1.0, 2.0], [3.0, 1.0]]"));
  EXPECT_EQ(line.at("colour"), 2);
  EXPECT_EQ(line.at("style"), "line");
  EXPECT_EQ(path.at("points"), ordered_json::parse("[[3.0, 1.0], [1.0, 2.0]]")) << "in its own order";
  EXPECT_EQ(path.at("style"), "path");
  EXPECT_TRUE(json.at("charts").at(0).at("shades").is_null());
}

TEST(ChartsOfAPage, HoldBoxesAndShades) {
  Chart chart;
  chart.boxes.push_back({"safe", 3, false, {{{1, 2}, {3, 4}}}});
  chart.shades = Chart::Shades{"margin, deg", {0, 0}, {1, 2}, {2, 2}, {0.5, {}, 1.5, 2.5}};
  PageNumbers numbers;
  const ordered_json json = to_json(Charts{"some", {chart}}, numbers).at("charts").at(0);
  EXPECT_EQ(json.at("boxes").at(0).at("boxes"), ordered_json::parse("[[1.0, 2.0, 3.0, 4.0]]"));
  EXPECT_FALSE(json.at("boxes").at(0).at("filled"));
  const std::vector<double> values = floats(numbers, json.at("shades").at("values"));
  ASSERT_EQ(values.size(), 4U);
  EXPECT_EQ(values[0], 0.5);
  EXPECT_TRUE(std::isnan(values[1])) << "nothing to be drawn";
  EXPECT_EQ(values[2], 1.5);
  EXPECT_EQ(values[3], 2.5);
}

TEST(Motion, LeavesOutTouchesAndGapsThatNoFootMeant) {
  // Steps of 10 ms. FL: a touch of 10 ms, then a stance with a gap of 10 ms in it. The others stand
  // throughout.
  const auto robot = scenes::quadruped();
  Trace trace;
  TraceSample sample;
  sample.state.q = robot->home;
  sample.targets.q = JointVector::Zero(static_cast<Eigen::Index>(robot->actuated_joints().size()));
  sample.torques = JointVector::Zero(robot->joint_count());
  sample.contact = {{true, true, true, true}};
  for (const char touches : std::string("0010000111101111")) {
    sample.contact[Leg::FL] = touches == '1';
    trace.push_back(sample);
    sample.state.time += 0.01;
  }
  Motion motion{.robot = robot, .terrain = {}, .runs = {{"a", "", trace}}};
  const auto stances_of = [&motion](std::size_t leg) {
    PageNumbers numbers;
    return motion_document(motion, numbers).at("runs").at(0).at("contact").at(leg).size() / 2;
  };
  EXPECT_EQ(stances_of(0), 1U);
  EXPECT_EQ(stances_of(1), 1U);
  motion.shortest_contact = 0;
  EXPECT_EQ(stances_of(0), 3U);
  EXPECT_EQ(stances_of(1), 1U);
}

TEST(Scene, SaysWhereLegFramesAre) {
  const auto robot = scenes::quadruped();
  PageNumbers numbers;
  const ordered_json scene = scene_document(*robot, {}, {}, numbers);
  const LegArray<Vector3> origins = leg_origins(*robot);
  for (const Leg leg : kLegs) {
    const std::vector<double> origin = scene.at("legs").at(index(leg)).at("origin");
    EXPECT_EQ(vector_at(origin, 0), origins[leg]) << name(leg);
  }
}

TEST(Motion, RefusesRunsWithoutASample) {
  PageNumbers numbers;
  const Motion nothing{scenes::quadruped(), {}, {{"a", "", {}}}, {}};
  EXPECT_EQ(config_error([&] { motion_document(nothing, numbers); }).source(), "a");
}

class SceneOfMeshes : public ScratchFolder {};

TEST_F(SceneOfMeshes, AMeshIsThereOnceWithItsTriangles) {
  RobotDescription robot = *scenes::quadruped();
  const std::string file =
      write("tetra.stl", binary_stl({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}));
  VisualShape visual;
  visual.type = VisualType::kMesh;
  visual.mesh = file;
  visual.scale = {0.01, 0.01, 0.01};
  robot.bodies[0].visuals = {visual, visual};
  visual.mesh = write("other.dae", "<COLLADA/>");
  robot.bodies[1].visuals = {visual};
  PageNumbers numbers;
  const ordered_json scene = scene_document(robot, {}, {}, numbers);
  ASSERT_EQ(scene.at("meshes").size(), 1U);
  const ordered_json& mesh = scene.at("meshes").at(0);
  EXPECT_EQ(mesh.at("vertices").at("count"), 3 * 4) << "equal corners are one";
  EXPECT_EQ(mesh.at("triangles").at("count"), 6);
  EXPECT_EQ(scene.at("bodies").at(0).at("shapes").at(1).at("mesh"), 0);
  EXPECT_EQ(scene.at("notes").size(), 1U) << "a mesh that is not read is named";
  EXPECT_EQ(scene.at("bodies").at(1).at("shapes").size(), robot.bodies[1].shapes.size());
}

TEST_F(SceneOfMeshes, CollisionShapesStandInForAMeshThatIsNotReadBesideWhatIs) {
  RobotDescription robot = *scenes::quadruped();
  const auto colliding = std::find_if(robot.bodies.begin(), robot.bodies.end(),
                                      [](const Body& body) { return !body.shapes.empty(); });
  ASSERT_NE(colliding, robot.bodies.end());
  VisualShape box, mesh;
  box.type = VisualType::kBox;
  box.size = {5e-4, 5e-4, 5e-4};
  mesh.type = VisualType::kMesh;
  mesh.mesh = write("trunk.dae", "<COLLADA/>");
  colliding->visuals = {box, mesh};
  PageNumbers numbers;
  const ordered_json scene = scene_document(robot, {}, {}, numbers);
  const auto body = static_cast<std::size_t>(colliding - robot.bodies.begin());
  EXPECT_EQ(scene.at("bodies").at(body).at("shapes").size(), 1 + colliding->shapes.size());
  // So they do for one whose file is not there, twice in one body and said once.
  mesh.mesh = "";
  colliding->visuals = {mesh, box, mesh};
  const ordered_json missing = scene_document(robot, {}, {}, numbers);
  EXPECT_EQ(missing.at("bodies").at(body).at("shapes").size(), 1 + colliding->shapes.size());
  ASSERT_EQ(missing.at("notes").size(), 1U);
  EXPECT_EQ(missing.at("notes").at(0),
            "a mesh of " + colliding->name + " is not there: collision shapes stand in for it");
}

// A box of half sides a, b, c has the moments m (b^2 + c^2) / 3 and so on: it is found again.
TEST(Scene, HasTheBoxOfAnInertiaAndWhatCollides) {
  RobotDescription robot = *scenes::assortment();
  SpatialInertia& inertia = robot.bodies[0].inertia;
  const Vector3 half(0.1, 0.2, 0.3), squares = half.cwiseAbs2();
  const Matrix3 R = Eigen::AngleAxisd(0.4, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  inertia.mass = 2;
  inertia.p_BC = {0.01, 0.02, 0.03};
  const Vector3 moments = 2.0 / 3 * (Vector3::Constant(squares.sum()) - squares);
  inertia.I_C = R * moments.asDiagonal() * R.transpose();
  PageNumbers numbers;
  const ordered_json body = scene_document(robot, {}, {}, numbers).at("bodies")[0];
  std::vector<double> size = body.at("inertia").at("size");
  std::sort(size.begin(), size.end());
  for (const int axis : {0, 1, 2})
    EXPECT_NEAR(size[static_cast<std::size_t>(axis)], half[axis], 1e-9);  // rounding of squares
  EXPECT_EQ(body.at("inertia").at("position"), (std::vector{0.01, 0.02, 0.03}));
  ASSERT_EQ(body.at("collision").size(), robot.bodies[0].shapes.size());
  for (std::size_t i = 0; i < robot.bodies[0].shapes.size(); ++i)
    EXPECT_EQ(body.at("collision")[i].at("type"), name(robot.bodies[0].shapes[i].type));
}

TEST(Scene, LinksOfARobotWithoutAnyShapeAreSticks) {
  RobotDescription robot = *scenes::quadruped();
  for (Body& body : robot.bodies) {
    body.visuals.clear();
    body.shapes.clear();
  }
  VisualShape missing;  // a mesh whose file is not there
  missing.type = VisualType::kMesh;
  robot.bodies[0].visuals = {missing};
  PageNumbers numbers;
  const ordered_json scene = scene_document(robot, {}, {}, numbers);
  // A stick ends where the next body's joint is: its half length on either side of its middle, along its
  // axis.
  for (std::size_t i = 1; i < robot.bodies.size(); ++i) {
    const Vector3 end = robot.bodies[i].X_PB.translation();
    const ordered_json& shapes =
        scene.at("bodies").at(static_cast<std::size_t>(robot.bodies[i].parent)).at("shapes");
    bool found = end.norm() <= 0.04 * robot.standing_height;  // too short to be seen
    for (const ordered_json& stick : shapes) {
      const std::vector<double> middle = stick.at("position"), q = stick.at("quaternion"),
                                size = stick.at("size");
      const Vector3 half = Quaternion(q[3], q[0], q[1], q[2]) * Vector3(0, 0, size[1]);
      found = found || (vector_at(middle, 0) + half - end).norm() < 1e-12;  // rounding
    }
    EXPECT_TRUE(found) << robot.bodies[i].name;
  }
  // Where something collides that is shown instead.
  const ordered_json solid = scene_document(*scenes::assortment(), {}, {}, numbers);
  EXPECT_GT(solid.at("bodies").at(0).at("shapes").size(), 0U);
}

TEST(Scene, ShowsWhatCollidesWhereNothingElseIsToBeSeen) {
  const RobotDescription robot = *scenes::assortment();
  PageNumbers numbers;
  const ordered_json scene = scene_document(robot, {}, {}, numbers);
  std::size_t hulls = 0;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    ASSERT_TRUE(robot.bodies[i].visuals.empty());
    const ordered_json& shown = scene.at("bodies").at(i).at("shapes");
    ASSERT_EQ(shown.size(), robot.bodies[i].shapes.size()) << robot.bodies[i].name;
    for (std::size_t k = 0; k < shown.size(); ++k) {
      const CollisionShape& shape = robot.bodies[i].shapes[k];
      EXPECT_EQ(shown.at(k).at("type"), name(shape.type)) << shape.name;
      const std::vector<double> position = shown.at(k).at("position");
      EXPECT_EQ(vector_at(position, 0), shape.X_BG.translation()) << shape.name;
      ASSERT_EQ(shown.at(k).contains("vertices"), shape.type == ShapeType::kHull) << shape.name;
      if (shape.type != ShapeType::kHull) continue;
      const std::vector<double> vertices = floats(numbers, shown.at(k).at("vertices"));
      ASSERT_EQ(vertices.size(), 3 * shape.vertices.size());
      EXPECT_LT((vector_at(vertices, 0) - shape.vertices.front()).norm(), 1e-7);  // floats
      ++hulls;
    }
  }
  EXPECT_GT(hulls, 0U);
}

TEST(PageNumbersAreBase64, AsInTheStandard) {
  PageNumbers numbers;
  EXPECT_EQ(numbers.base64(), "");
  numbers.add(std::span<const std::uint32_t>(std::vector<std::uint32_t>{0x006e614dU}));  // "Man\0"
  EXPECT_EQ(numbers.base64(), "TWFuAA==");
  numbers.add(std::span<const std::uint32_t>(std::vector<std::uint32_t>{0x4d006e61U}));
  EXPECT_EQ(numbers.base64(), "TWFuAGFuAE0=");
}

TEST(ScriptText, EndsNoElementWhateverItSays) {
  const std::string hostile = "</script><!-- &amp; \xe2\x80\xa8 \xe2\x80\xa9 \xff \"";
  const std::string text = script_text({{"name", hostile}});
  for (const char* bad : {"<", ">", "&", "\xe2\x80\xa8", "\xff"})
    EXPECT_EQ(text.find(bad), std::string::npos) << bad;
  const std::string back = nlohmann::json::parse(text).at("name");
  EXPECT_TRUE(back.starts_with("</script><!-- &amp; \xe2\x80\xa8 \xe2\x80\xa9 ")) << back;
}

TEST(ReportPage, HoldsADocumentWhoseTitleIsHarmless) {
  if (page_template().empty()) GTEST_SKIP() << "built without the page";
  ReportPage page;
  page.title = "<script>alert(1)</script>";
  const std::string html = report_html(page);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_NE(html.find("\\u003cscript\\u003ealert(1)"), std::string::npos);
  EXPECT_EQ(html.find("@CROSSGAIT_"), std::string::npos) << "both places are filled";
  // Nothing that a browser would fetch.
  for (const char* fetched : {"src=\"http", "href=\"http", "url(http", "import("})
    EXPECT_EQ(html.find(fetched), std::string::npos) << fetched;
}

TEST(VerdictDocument, NamesTheFileOfWhatIsNone) {
  for (const char* text : {"{}", R"({"statistics": 3})", R"({"statistics": [{"name": 7}]})",
                           R"({"statistics": [], "behaviour": "b", "a": "x", "b": "y", "verdict": 1})"}) {
    const ConfigError error = config_error([&] { verdict_document(nlohmann::json::parse(text), "v.json"); });
    EXPECT_EQ(error.source(), "v.json") << text;
  }
}

}  // namespace
}  // namespace crossgait

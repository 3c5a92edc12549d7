// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <future>

#include "holdfast/viewer/viewer.hpp"
#include "viewer/page_fit.hpp"
#include "viewer/viewed_world.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The page in a real browser.
class ViewerBrowserTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto program = test::find_browser();
    if (!program) GTEST_SKIP() << "no chromium, chromium-browser or google-chrome in PATH to look at the page with";
    profile_ = fs::path(testing::TempDir()) / ("holdfast_viewer_browser_" + std::to_string(getpid()));
    browser_.emplace(*program, profile_, drawing());
  }
  void TearDown() override {
    browser_.reset();
    std::error_code ignored;
    fs::remove_all(profile_, ignored);
  }

  virtual test::BrowserDrawing drawing() const { return test::BrowserDrawing::plain; }
  bool becomes(const std::string& expression) { return test::becomes(*browser_, expression); }
  std::string text(const std::string& id) {
    return browser_->evaluate("document.getElementById('" + id + "').textContent").get<std::string>();
  }
  void open(const std::string& fragment = "") { browser_->open_page(viewer_->address() + fragment); }
  void hide(const std::vector<std::string>& layers) {
    for (const std::string& layer : layers)
      browser_->evaluate("document.querySelector('#layers [data-layer=" + layer + "] input').click()");
  }
  /// A run that has ended, of 50 poses.
  static ViewedRun ended_run() {
    ViewedRun run;
    for (int i = 0; i < 50; ++i) {
      run.path.push_back({i / 30.0, test::pose_at(i * 0.01)});
      run.errors.push_back(0.001F * static_cast<float>(i));
      run.truth.emplace_back(i / 30.0, Eigen::Vector3d(i * 0.01, 0.01, 0));
    }
    run.figures = {{"ATE RMSE", "<i>3 mm</i>"}};
    return run;
  }

  std::shared_ptr<Viewer> viewer_ = Viewer::start({.title = "</script><b>run</b>"});
  fs::path profile_;
  std::optional<test::Browser> browser_;
};

const std::string counts = "globalThis.holdfastViewer?.counts()";

TEST_F(ViewerBrowserTest, ShowsWhatComesAndWhatALoopMoves) {
  viewer_->set_map(test::row_map(4), 0.0);
  for (std::uint32_t i = 0; i < 4; ++i) viewer_->add_frame(test::row_frame(i));
  open();
  ASSERT_TRUE(becomes(counts + "?.points === 4 && " + counts + ".path === 4 && " + counts + ".keyframes === 4"));
  // The words follow with the next drawing.
  EXPECT_TRUE(becomes("document.getElementById('title').textContent === '</script><b>run</b>'")) << text("title");
  EXPECT_TRUE(becomes("document.getElementById('state').textContent === 'tracking'")) << text("state");
  EXPECT_TRUE(becomes("document.getElementById('stages').textContent.includes('features')")) << text("stages");

  MapSnapshot closed = test::row_map(4);
  closed.keyframes[3].T_world_camera = test::pose_at(3, 2);
  closed.loops.push_back({test::keyframe_id(0), test::keyframe_id(3)});
  viewer_->set_map(closed, 0.0);
  viewer_->add_loop(test::keyframe_id(3), test::keyframe_id(0));
  EXPECT_TRUE(becomes(counts + ".loops === 1 && holdfastViewer.place(3)[1] === 2"));
  EXPECT_EQ(browser_->evaluate("holdfastViewer.place(0)[1]"), 0);

  FrameResult lost = test::row_frame(5);
  lost.status = TrackingStatus::lost;
  lost.failure = TrackingFailure::few_features;
  lost.T_world_camera.reset();
  viewer_->add_frame(lost);
  EXPECT_TRUE(becomes("document.getElementById('state').textContent.startsWith('lost')"));
  EXPECT_EQ(browser_->evaluate("document.getElementById('state').className"), "state bad");
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ViewerBrowserTest, ShowsThePicture) {
  ViewedPicture picture;
  picture.index = 3;
  picture.colour = cv::Mat(480, 640, CV_8UC3, cv::Scalar(0, 200, 0));
  picture.features = {{100, 100, 1.0F, true}};
  open();
  ASSERT_TRUE(becomes(counts + "?.connected"));
  viewer_->add_frame(test::row_frame(3));
  viewer_->set_picture(picture);
  EXPECT_TRUE(becomes("document.getElementById('picture-name').textContent === 'frame 3'"));
  const std::string middle =
      "[...document.getElementById('picture').getContext('2d').getImageData(240, 180, 1, 1).data]";
  EXPECT_GT(browser_->evaluate(middle)[1].get<int>(), 180);
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

/// The page as a browser without a graphics card draws it, and by WebGL.
class ViewerDrawingTest : public ViewerBrowserTest, public ::testing::WithParamInterface<test::BrowserDrawing> {
 protected:
  test::BrowserDrawing drawing() const override { return GetParam(); }
  void open() {
    const bool is_webgl = GetParam() == test::BrowserDrawing::webgl;
    ViewerBrowserTest::open(is_webgl ? "#webgl" : "");
    ASSERT_TRUE(becomes("globalThis.holdfastViewer"));
    EXPECT_EQ(browser_->evaluate("holdfastViewer.drawsBySoftware()"), !is_webgl);
  }
  /// The colour of the pixel where a place of the world is, moved by so many pixels, as an expression.
  static std::string pixel_at(const std::string& place, int right = 0, int down = 0) {
    return "(() => { const [width, height] = holdfastViewer.size(), m = holdfastViewer.view.matrix(width / height);"
           "const [x, y, z] = " +
           place +
           "; const row = (r) => m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r];"
           "return holdfastViewer.pixel(Math.floor((row(0) / row(3) + 1) / 2 * width) + " +
           std::to_string(right) + ", Math.floor((1 - row(1) / row(3)) / 2 * height) + " + std::to_string(down) +
           ").join(); })()";
  }
  static std::string pixel_at_point(int i) { return pixel_at("holdfastViewer.point(" + std::to_string(i) + ")"); }
};

TEST_P(ViewerDrawingTest, PointsWhereTheyAre) {
  viewer_->set_map(test::row_map(4), 0.0);
  open();
  ASSERT_TRUE(becomes(counts + "?.points === 4"));
  hide({"path", "keyframes", "covisibility", "loops", "grid"});
  const std::string ground = "holdfastViewer.pixel(2, 2).join()";
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(becomes(pixel_at_point(i) + " !== " + ground)) << "point " << i;
  hide({"points"});
  EXPECT_TRUE(becomes(pixel_at_point(0) + " === " + ground));
  const nlohmann::json before = browser_->evaluate("holdfastViewer.view.eye()");
  browser_->click("document.querySelector('input[value=top]')");
  EXPECT_NE(browser_->evaluate("holdfastViewer.view.eye()"), before);
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_P(ViewerDrawingTest, LinesWhereTheyAreAndPointsInFrontOfThem) {
  MapSnapshot map = test::row_map(4);
  map.covisibility.clear();
  map.points.resize(2);
  viewer_->set_map(map, 0.0);
  for (std::uint32_t i = 0; i < 4; ++i) {
    FrameResult frame = test::row_frame(i);
    frame.timestamp = i / 30.0;  // no line goes from a frame to the next that was tracked much later
    viewer_->add_frame(frame);
  }
  open();
  ASSERT_TRUE(becomes(counts + "?.path === 4 && " + counts + ".points === 2"));
  hide({"keyframes", "loops", "grid", "points", "seen"});
  const std::string ground = "holdfastViewer.pixel(2, 2).join()";
  EXPECT_TRUE(becomes(pixel_at("[0.5, 0, 0]") + " !== " + ground)) << "the path is there";
  EXPECT_TRUE(becomes(pixel_at("[2.5, 0, 0]") + " !== " + ground));
  for (const int down : {-5, 5})
    EXPECT_EQ(browser_->evaluate(pixel_at("[1.5, 0, 0]", 0, down) + " === " + ground), true) << "and nowhere else";
  hide({"path"});
  EXPECT_TRUE(becomes(pixel_at("[0.5, 0, 0]") + " === " + ground));

  // A point between the eye and the path.
  hide({"path", "points"});
  browser_->evaluate("holdfastViewer.view.isFree = true");
  const std::string eye = "holdfastViewer.view.eye().map((e, i) => 0.1 * e + 0.9 * [1.5, 0, 0][i])";
  const nlohmann::json place = browser_->evaluate(eye);
  const std::string path_colour = browser_->evaluate(pixel_at("[1.5, 0, 0]")).get<std::string>();
  map.points[0].position = Eigen::Vector3d(place[0], place[1], place[2]);
  map.points[0].static_log_odds = -3.0F;
  viewer_->set_map(map, 0.0);
  EXPECT_TRUE(becomes(pixel_at("[1.5, 0, 0]") + " !== '" + path_colour + "'"));
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ViewerBrowserTest, IsDarkOrLightAsChosen) {
  const std::string ground = "getComputedStyle(document.body).backgroundColor";
  open();
  ASSERT_TRUE(becomes(counts + "?.connected"));
  const nlohmann::json before = browser_->evaluate(ground);
  browser_->click("document.querySelector('button.theme')");
  EXPECT_NE(browser_->evaluate(ground), before);
  open();
  EXPECT_NE(browser_->evaluate(ground), before) << "remembered";
  browser_->click("document.querySelector('button.theme')");
  EXPECT_EQ(browser_->evaluate(ground), before);
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ViewerBrowserTest, ComesBackAfterTheConnectionWasLost) {
  viewer_->set_map(test::row_map(4), 0.0);
  open();
  ASSERT_TRUE(becomes(counts + "?.points === 4"));
  browser_->evaluate("holdfastViewer.send('what is this')");  // the program ends the connection
  EXPECT_TRUE(becomes(counts + ".connected === false"));
  viewer_->set_map(test::row_map(6), 0.0);
  EXPECT_TRUE(becomes(counts + ".connected && " + counts + ".points === 6"));
}

TEST_F(ViewerBrowserTest, KeepsWhatItHasWhenTheProgramIsGone) {
  viewer_->set_map(test::row_map(4), 0.0);
  open();
  ASSERT_TRUE(becomes(counts + "?.points === 4"));
  const int port = std::stoi(viewer_->address().substr(viewer_->address().rfind(':') + 1));
  viewer_.reset();
  EXPECT_TRUE(becomes("document.getElementById('state').textContent === 'connection lost'"));
  EXPECT_EQ(browser_->evaluate("document.getElementById('pause').disabled"), true);
  viewer_ = Viewer::start({.port = port});  // has another token, so that this page cannot be its
  usleep(1'500'000);
  EXPECT_FALSE(viewer_->is_watched());
  EXPECT_EQ(browser_->evaluate(counts + ".points"), 4);
}

TEST_F(ViewerBrowserTest, PausesAndShowsTheEnd) {
  open();
  ASSERT_TRUE(becomes(counts + "?.connected"));
  viewer_->add_frame(test::row_frame(0));
  browser_->click("document.getElementById('pause')");
  EXPECT_TRUE(becomes("document.getElementById('pause').textContent === 'Resume'"));
  browser_->click("document.getElementById('pause')");
  EXPECT_TRUE(becomes("document.getElementById('pause').textContent === 'Pause'"));

  viewer_->set_run(ended_run());
  ASSERT_TRUE(becomes(counts + ".state.finished && " + counts + ".truth === 50"));
  EXPECT_TRUE(becomes("document.getElementById('pause').textContent === 'Play'"));
  EXPECT_TRUE(becomes("document.getElementById('figures').textContent.includes('<i>3 mm</i>')"));
  EXPECT_TRUE(becomes("!document.getElementById('slider').hidden && !document.getElementById('error-panel').hidden"));
  browser_->evaluate(
      "(() => { const s = document.getElementById('slider'); s.value = 20; s.dispatchEvent(new Event('input')); })()");
  EXPECT_TRUE(becomes("document.getElementById('error-now').textContent === 'here 20.0 mm'"));
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_P(ViewerDrawingTest, ColoursPointsByStateOrClass) {
  viewer_->set_map(test::row_map(4), 0.0);
  open();
  ASSERT_TRUE(becomes(counts + "?.points === 4"));
  const std::string has_choice = "!document.getElementById('colourings').hidden";
  EXPECT_EQ(browser_->evaluate(has_choice), false) << "there are no classes";
  viewer_->set_classes({"background", "<b>person</b>"});
  viewer_->add_point_classes({{test::point_id(1), 0}, {test::point_id(2), 1}});
  EXPECT_TRUE(becomes("holdfastViewer.classOf(2) === 1 && holdfastViewer.classOf(1) === 0 && " + has_choice));
  EXPECT_EQ(browser_->evaluate("holdfastViewer.classOf(0)"), 255);
  hide({"path", "keyframes", "covisibility", "loops", "grid"});
  EXPECT_TRUE(becomes(pixel_at_point(1) + " === " + pixel_at_point(2))) << "both are static";
  browser_->click("document.querySelector('input[value=class]')");
  EXPECT_TRUE(becomes(pixel_at_point(1) + " !== " + pixel_at_point(2)));
  EXPECT_EQ(browser_->evaluate(pixel_at_point(2)), "30,120,255,255") << "as over the picture";
  EXPECT_TRUE(becomes("document.getElementById('legend').textContent.includes('<b>person</b>')")) << text("legend");
  browser_->click("document.querySelector('input[value=state]')");
  EXPECT_TRUE(becomes("document.getElementById('legend').textContent.includes('doubtful')"));
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

/// A square of two triangles around (x, 0, 2), which is seen from where the camera was.
SurfacePatch square_at(int x, float half, std::uint8_t label = 255) {
  SurfacePatch patch{{x, 0, 0}, {}, {{0, 1, 2}, {0, 2, 3}}};
  for (const auto& [across, down] : {std::pair{-1.0F, -1.0F}, {-1.0F, 1.0F}, {1.0F, 1.0F}, {1.0F, -1.0F}})
    patch.vertices.push_back({{static_cast<float>(x) + half * across, half * down, 2}, {0, 0, -1}, 200, 40, 40, label});
  return patch;
}

TEST_P(ViewerDrawingTest, TheSurfaceAsItGrowsAndCutAtAHeight) {
  viewer_->set_map(test::row_map(4), 0.0);
  open();
  ASSERT_TRUE(becomes(counts + "?.points === 4"));
  hide({"path", "keyframes", "covisibility", "loops", "grid", "points", "seen"});
  const std::string has_slider = "!document.getElementById('cutting').hidden",
                    ground = "holdfastViewer.pixel(2, 2).join()";
  EXPECT_EQ(browser_->evaluate(has_slider), false) << "there is no surface";
  // From before the squares, so that both are seen.
  browser_->evaluate(
      "(() => { const v = holdfastViewer.view; v.isFree = true; v.up = [0, -1, 0]; v.target = [1, 0, 2]; v.yaw = "
      "Math.PI; "
      "v.pitch = 0; v.distance = 4; })()");
  const auto pixel = [&](double x, double y) {
    return browser_->evaluate(pixel_at("[" + std::to_string(x) + ", " + std::to_string(y) + ", 2]")).get<std::string>();
  };
  viewer_->add_patches({square_at(0, 0.3F)}, 0, 0.0);
  ASSERT_TRUE(becomes(counts + ".triangles === 2 && " + has_slider));
  viewer_->add_patches({square_at(2, 0.3F)}, 0, 0.0);
  ASSERT_TRUE(becomes(counts + ".triangles === 4"));
  const std::string nothing = browser_->evaluate(ground).get<std::string>();
  for (const double x : {0.0, 2.0}) {
    EXPECT_NE(pixel(x, 0.2), nothing);
    EXPECT_NE(pixel(x - 0.25, -0.25), nothing);
    EXPECT_EQ(pixel(x + 0.4, 0.0), nothing);
    EXPECT_EQ(pixel(x, -0.4), nothing);
  }
  // Red, and lit: as bright as can be where the eye looks straight at it.
  EXPECT_TRUE(becomes("(() => { const [r, g, b] = " + pixel_at("[0, 0.2, 2]") +
                      ".split(',').map(Number); return r > 150 && r < 200 && g < 45 && Math.abs(g - b) <= 1; })()"));
  viewer_->add_patches({square_at(0, 0.1F)}, 0, 0.0);  // replaces the first one
  EXPECT_TRUE(becomes(pixel_at("[0, 0.2, 2]") + " === '" + nothing + "'"));
  EXPECT_NE(pixel(0.0, 0.05), nothing);

  // y points down: the upper half of the second square is cut away.
  browser_->evaluate(
      "(() => { const c = document.getElementById('cut'); c.value = 0.5; c.dispatchEvent(new Event('input')); })()");
  browser_->evaluate("holdfastViewer.cutAt(-0.1)");
  EXPECT_EQ(pixel(2.0, -0.05), nothing);
  if (GetParam() == test::BrowserDrawing::webgl) {
    EXPECT_NE(pixel(2.0, 0.2), nothing) << "by the processor whole triangles go";
  }
  browser_->evaluate("holdfastViewer.cutAt(Infinity)");
  EXPECT_NE(pixel(2.0, -0.05), nothing);
  // From behind one looks through it.
  browser_->evaluate("holdfastViewer.view.yaw = 0");
  EXPECT_EQ(pixel(2.0, 0.05), nothing);
  hide({"mesh"});
  browser_->evaluate("holdfastViewer.view.yaw = Math.PI");
  EXPECT_EQ(pixel(2.0, 0.05), nothing);
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_P(ViewerDrawingTest, ColoursTheSurfaceByClass) {
  viewer_->set_classes({"background", "chair"});
  viewer_->set_map(test::row_map(4), 0.0);
  viewer_->add_patches({square_at(0, 0.3F, 0), square_at(2, 0.3F, 1)}, 0, 0.0);
  open();
  ASSERT_TRUE(becomes(counts + "?.triangles === 4"));
  hide({"path", "keyframes", "covisibility", "loops", "grid", "points", "seen"});
  browser_->evaluate(
      "(() => { const v = holdfastViewer.view; v.isFree = true; v.up = [0, -1, 0]; v.target = [1, 0, 2]; v.yaw = "
      "Math.PI; "
      "v.pitch = 0; v.distance = 4; })()");
  // The two are lit differently.
  const auto blue = [](const std::string& place) { return "Number(" + pixel_at(place) + ".split(',')[2])"; };
  const std::string difference = "Math.abs(" + blue("[0, 0, 2]") + " - " + blue("[2, 0, 2]") + ")";
  EXPECT_TRUE(becomes(difference + " < 15"));
  browser_->click("document.querySelector('input[value=class]')");
  EXPECT_TRUE(becomes(difference + " > 60"));
  EXPECT_TRUE(becomes("document.getElementById('legend').textContent.includes('chair')")) << text("legend");
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(All, ViewerDrawingTest,
                         ::testing::Values(test::BrowserDrawing::plain, test::BrowserDrawing::webgl),
                         [](const auto& info) {
                           return info.param == test::BrowserDrawing::plain ? "ByTheProcessor" : "ByWebGl";
                         });

TEST_F(ViewerBrowserTest, ShowsTheDenseCloudWhichFollowsItsKeyframes) {
  viewer_->set_map(test::row_map(4), 0.0);
  open();
  ASSERT_TRUE(becomes(counts + "?.points === 4"));
  const std::string has_layer = "!document.querySelector('[data-layer=cloud]').hidden";
  EXPECT_EQ(browser_->evaluate(has_layer), false);
  viewer_->add_surface(
      {test::keyframe_id(3), 3.0, test::pose_at(3), {{0, 0.5F, 2, 255, 128, 7}, {1, 0.5F, 2, 9, 9, 9}}});
  EXPECT_TRUE(becomes(counts + ".cloud === 2 && " + has_layer));
  EXPECT_EQ(browser_->evaluate("holdfastViewer.cloudPoint(0)"), nlohmann::json({3, 0.5, 2, 0, 0xff8007}));
  MapSnapshot closed = test::row_map(4);
  closed.keyframes[3].T_world_camera = test::pose_at(3, 2);
  viewer_->set_map(closed, 0.0);
  EXPECT_TRUE(becomes("holdfastViewer.cloudPoint(0)[1] === 2.5"));
  ViewedRun run = ended_run();
  run.cloud = {{7, 8, 9, 1, 2, 3}};
  viewer_->set_run(run);
  EXPECT_TRUE(becomes(counts + ".cloud === 1 && holdfastViewer.cloudPoint(0)[0] === 7"));
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ViewerBrowserTest, APageDrawnByTheProcessorIsCalmUntilSomebodyTouchesIt) {
  viewer_->add_frame(test::row_frame(0));
  open();
  ASSERT_TRUE(becomes(counts + "?.connected"));
  EXPECT_TRUE(becomes("holdfastViewer.pace().calm && holdfastViewer.pace().rate < 30"));
  // What comes is shown all the same.
  viewer_->add_frame(test::row_frame(1));
  viewer_->set_map(test::row_map(3), 0.0);
  EXPECT_TRUE(becomes(counts + ".points === 3 && document.getElementById('counts').textContent.includes('points3')"));
  // Of a busy machine the page may be calm again before it is asked.
  bool was_lively = false;
  for (int i = 0; i < 20 && !was_lively; ++i) {
    browser_->press_space();
    was_lively = browser_->evaluate("!holdfastViewer.pace().calm && holdfastViewer.pace().rate === 30") == true;
  }
  EXPECT_TRUE(was_lively);
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ViewerBrowserTest, APageBehindAnotherTabAsksForNothing) {
  open();
  ASSERT_TRUE(becomes(counts + "?.connected"));
  const auto be_hidden = [&](const std::string& value) {
    browser_->evaluate("(() => { Object.defineProperty(document, 'hidden', {value: " + value +
                       ", configurable: true}); document.dispatchEvent(new Event('visibilitychange')); })()");
  };
  be_hidden("true");
  EXPECT_TRUE(becomes("holdfastViewer.pace().rate === 0"));
  usleep(300'000);  // until the program knows
  viewer_->set_map(test::row_map(4), 0.0);
  usleep(300'000);
  EXPECT_EQ(browser_->evaluate(counts + ".points"), 0);
  EXPECT_FALSE(viewer_->wants_map());
  EXPECT_FALSE(viewer_->wants_picture());
  be_hidden("false");
  EXPECT_TRUE(becomes(counts + ".points === 4"));
  EXPECT_TRUE(viewer_->wants_picture());
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ViewerBrowserTest, NoTwoMovingObjectsHaveTheSameColour) {
  open();
  ASSERT_TRUE(becomes("globalThis.holdfastViewer"));
  // Of twelve that follow each other, any two differ by a tenth of the range of a channel at least.
  const std::string nearest =
      "(() => { let nearest = 9; for (let first = 0; first < 100; ++first) for (let i = 0; i < 12; ++i) "
      "for (let k = 0; k < i; ++k) { const a = holdfastViewer.objectColour(first + i), b = "
      "holdfastViewer.objectColour(first + k); nearest = Math.min(nearest, Math.max(...[0, 1, 2].map((c) => "
      "Math.abs(a[c] - b[c])))); } return nearest; })()";
  for (const bool is_dark : {false, true}) {
    browser_->show_at(1300, 800, is_dark);
    EXPECT_GE(browser_->evaluate(nearest).get<double>(), 0.1);
  }
}

TEST_F(ViewerBrowserTest, NothingIsTooWideWhateverItIsCalled) {
  const std::string name = "a_recording_with_a_name_that_somebody_has_put_together_from_everything_that_is_known_of_it";
  const auto viewer = Viewer::start({.title = name + "/" + name});
  viewer->set_classes({"background", name, "a class of several words that is longer than anybody would call one, too"});
  viewer->set_map(test::row_map(4), 0.0);
  viewer->add_point_classes({{test::point_id(0), 1}, {test::point_id(1), 2}, {test::point_id(2), 255}});
  for (std::uint32_t i = 0; i < 300; ++i) {
    FrameResult frame = test::row_frame(i);
    frame.index = 4'000'000'000U + i;
    frame.timestamp = 1e6 * i;
    frame.inliers = frame.features = 2'000'000'000;
    frame.tracking_seconds = 12.3456;
    for (const char* stage : {"features of an extractor whose name is longer than the panel is wide, by far",
                              "another_stage_without_any_place_where_a_line_could_be_broken_into_two", "third"})
      frame.times.add(stage, 12.3456);
    MovingObject object;
    object.id = 4'000'000'000U;
    object.class_name = name;
    object.moving = true;
    object.velocity = Eigen::Vector3d(1e6, 0.0, 0.0);
    object.box.extend(Eigen::Vector3f::Constant(-1.0F)).extend(Eigen::Vector3f::Ones());
    object.last_seen = frame.timestamp;
    object.T_world_object = test::pose_at(0.0);
    frame.objects = {object};
    if (i > 290) {
      frame.status = TrackingStatus::lost;
      frame.failure = TrackingFailure::few_features;
      frame.T_world_camera.reset();
    }
    viewer->add_frame(frame);
  }
  ViewedPicture picture;
  picture.index = 4'000'000'000U;
  picture.colour = cv::Mat(480, 640, CV_8UC3, cv::Scalar(0, 200, 0));
  browser_->open_page(viewer->address());
  ASSERT_TRUE(becomes(counts + "?.connected"));
  viewer->set_picture(picture);
  ASSERT_TRUE(becomes(counts + ".path > 200 && !document.getElementById('colourings').hidden"));
  browser_->click("document.querySelector('input[value=class]')");
  test::expect_it_fits(*browser_);
  ViewedRun run = ended_run();
  run.title = name;
  run.errors.assign(50, 12345.6F);
  run.figures = {{"ATE RMSE", "123456789.12 mm"}, {"commit", name}, {name, name}};
  viewer->set_run(run);
  ASSERT_TRUE(becomes(counts + ".state.finished && !document.getElementById('figures-panel').hidden"));
  test::expect_it_fits(*browser_);
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ViewerBrowserTest, SpacePausesAndArrowsStep) {
  open();
  ASSERT_TRUE(becomes(counts + "?.connected"));
  viewer_->add_frame(test::row_frame(0));
  browser_->press_space();
  EXPECT_TRUE(becomes(counts + ".state.paused"));
  std::future<void> frame = std::async(std::launch::async, [this] { viewer_->take_turn(0.0); });
  browser_->press_right();
  frame.get();
  // What was clicked last does not take the keys.
  browser_->click("document.querySelector('input[value=top]')");
  browser_->press_space();
  EXPECT_TRUE(becomes(counts + ".state.paused === false"));

  viewer_->set_run(ended_run());
  ASSERT_TRUE(becomes(counts + ".state.finished && document.getElementById('slider').max === '49'"));
  browser_->press_left();
  EXPECT_TRUE(becomes("document.getElementById('slider').value === '48'"));
  browser_->press_left();
  browser_->press_right();
  browser_->press_right();
  EXPECT_TRUE(becomes("document.getElementById('slider').value === '49'"));
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ViewerBrowserTest, WhoeverComesAfterTheEndSeesTheChartsAsWell) {
  for (std::uint32_t i = 0; i < 4; ++i) viewer_->add_frame(test::row_frame(i));
  viewer_->set_run(ended_run());
  open();
  ASSERT_TRUE(becomes(counts + "?.state.finished"));
  for (const char* chart : {"times", "strip", "errors"})
    EXPECT_TRUE(becomes(
        "(() => { const c = document.getElementById('" + std::string(chart) +
        "'), e = document.createElement('canvas'); e.width = c.width; e.height = c.height; return c.toDataURL() "
        "!== e.toDataURL(); })()"))
        << chart;
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

}  // namespace
}  // namespace holdfast

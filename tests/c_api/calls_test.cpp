// Every call of livecap/livecap.h that cannot be right is refused by its code and one line; and what
// goes in and comes out is what C++ has.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "actor/actor.h"
#include "capture/capture_run.h"
#include "livecap/camera.h"
#include "livecap/livecap.h"
#include "nn/models.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

constexpr int kWidth = 272, kHeight = 480;

// An actor in a file, which is read sooner than a built-in one is made.
class Calls : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    file_ = std::filesystem::temp_directory_path() / ("livecap_calls_" + std::to_string(::getpid()) + ".glb");
    std::ofstream(file_, std::ios::binary) << make_builtin_actor_glb("trousers");
  }
  static void TearDownTestSuite() { std::filesystem::remove(file_); }

 public:
  static inline std::string file_;
};

livecap_options good_options() {
  livecap_options options;
  livecap_options_init(&options);
  options.actor = Calls::file_.c_str();
  EXPECT_EQ(livecap_camera_from_fov(kWidth, kHeight, 60, &options.camera), LIVECAP_OK);
  return options;
}

// The code, and the line without its end, which must name `what`.
void expect_failed(livecap_error got, livecap_error expected, const std::string& what) {
  const std::string line = livecap_last_error();
  EXPECT_EQ(got, expected) << line;
  EXPECT_EQ(line.find("--"), std::string::npos) << line;  // there is no command line
  EXPECT_NE(line.find(what), std::string::npos) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
}

// Those of livecap_open, which leaves no capture.
template <typename Change>
void expect_refused(livecap_error expected, const std::string& what, Change&& change) {
  livecap_options options = good_options();
  change(options);
  livecap_capture* capture = reinterpret_cast<livecap_capture*>(&options);
  expect_failed(livecap_open(&options, &capture), expected, what);
  EXPECT_EQ(capture, nullptr);
}

TEST_F(Calls, NothingIsNoArgument) {
  livecap_options options = good_options();
  livecap_capture* capture = reinterpret_cast<livecap_capture*>(&options);
  expect_failed(livecap_open(nullptr, &capture), LIVECAP_CONFIG_ERROR, "options is NULL");
  EXPECT_EQ(capture, nullptr);
  expect_failed(livecap_open(&options, nullptr), LIVECAP_CONFIG_ERROR, "livecap_open: capture is NULL");
  const livecap_picture picture = {};
  expect_failed(livecap_push(nullptr, &picture), LIVECAP_CONFIG_ERROR, "livecap_push: capture is NULL");
  expect_failed(livecap_close(nullptr), LIVECAP_CONFIG_ERROR, "livecap_close: capture is NULL");
  EXPECT_EQ(livecap_poll(nullptr), nullptr);
  expect_failed(LIVECAP_CONFIG_ERROR, LIVECAP_CONFIG_ERROR, "livecap_poll: capture is NULL");
  EXPECT_EQ(livecap_get_actor(nullptr), nullptr);
  expect_failed(LIVECAP_CONFIG_ERROR, LIVECAP_CONFIG_ERROR, "livecap_get_actor: capture is NULL");
  expect_failed(livecap_camera_from_fov(8, 8, 60, nullptr), LIVECAP_CONFIG_ERROR, "camera is NULL");
  expect_failed(livecap_load_camera("camera.json", nullptr), LIVECAP_CONFIG_ERROR, "camera is NULL");
  expect_failed(livecap_load_camera(nullptr, &options.camera), LIVECAP_CONFIG_ERROR, "path is NULL");
  livecap_free(nullptr);
}

TEST_F(Calls, OptionsThatCannotBeAreRefused) {
  using Options = livecap_options;
  expect_refused(LIVECAP_CONFIG_ERROR, "struct_size is 0", [](Options& o) { o.struct_size = 0; });
  expect_refused(LIVECAP_CONFIG_ERROR, "struct_size", [](Options& o) { o.struct_size -= 8; });
  expect_refused(LIVECAP_CONFIG_ERROR, "struct_size", [](Options& o) { o.struct_size += 8; });
  expect_refused(LIVECAP_CONFIG_ERROR, "actor is missing", [](Options& o) { o.actor = nullptr; });
  expect_refused(LIVECAP_CONFIG_ERROR, "kilt", [](Options& o) { o.actor = "builtin:kilt"; });
  expect_refused(LIVECAP_IO_ERROR, "no_such_actor.glb", [](Options& o) { o.actor = "no_such_actor.glb"; });
  expect_refused(LIVECAP_CONFIG_ERROR, "height_mm 1.78: must be 500 to 3000", [](Options& o) { o.height_mm = 1.78; });
  expect_refused(LIVECAP_CONFIG_ERROR, "height_mm nan",
                 [](Options& o) { o.height_mm = std::numeric_limits<double>::quiet_NaN(); });
  expect_refused(LIVECAP_CONFIG_ERROR, "rigidity -1", [](Options& o) { o.rigidity = -1; });
  expect_refused(LIVECAP_CONFIG_ERROR, "without hands: ", [](Options& o) { o.without = "face,,cloth, hands ,"; });
  expect_refused(LIVECAP_CONFIG_ERROR, "camera: image size", [](Options& o) { o.camera = {}; });
  for (const auto& [width, height] : {std::pair{640, 1}, {16001, 10}, {100000, 100000}}) {
    expect_refused(LIVECAP_CONFIG_ERROR, "px a side", [w = width, h = height](Options& o) {
      EXPECT_EQ(livecap_camera_from_fov(w, h, 60, &o.camera), LIVECAP_OK);
      o.actor = "no_such_actor.glb";  // which is read later
    });
  }
  expect_refused(LIVECAP_CONFIG_ERROR, "distortion", [](Options& o) { o.camera.distortion[4] = 0. / 0.; });
  expect_refused(LIVECAP_CONFIG_ERROR, "floor.normal", [](Options& o) { o.camera.floor_distance_mm = 900; });
  expect_refused(LIVECAP_CONFIG_ERROR, "n_background is 1", [](Options& o) { o.n_background = 1; });
  const livecap_picture small = {nullptr, 0, 0, kWidth - 2, kHeight, LIVECAP_RGB};
  expect_refused(LIVECAP_CONFIG_ERROR, "n_background is -1", [&](Options& o) {
    o.background = &small;
    o.n_background = -1;
  });
  expect_refused(LIVECAP_CONFIG_ERROR, "background picture: it is 270x480", [&](Options& o) {
    o.background = &small;
    o.n_background = 1;
  });
  expect_refused(LIVECAP_CONFIG_ERROR, "no_such_device", [](Options& o) { o.solver_device = "no_such_device"; });
}

TEST_F(Calls, TheLastErrorIsTheThreadsOwn) {
  livecap_close(nullptr);
  const std::string mine = livecap_last_error();
  std::string at_first, later;
  std::thread([&] {
    at_first = livecap_last_error();
    livecap_poll(nullptr);
    later = livecap_last_error();
  }).join();
  EXPECT_EQ(at_first, "");
  EXPECT_NE(later.find("livecap_poll"), std::string::npos);
  EXPECT_EQ(livecap_last_error(), mine);
}

TEST_F(Calls, CamerasAreThoseOfCpp) {
  const ScratchFolder scratch;
  Camera camera = camera_from_fov(640, 360, 75);
  const auto expect_same = [&](const livecap_camera& c) {
    EXPECT_EQ(c.width, camera.width);
    EXPECT_EQ(c.height, camera.height);
    EXPECT_EQ(c.fx, camera.fx);
    EXPECT_EQ(c.fy, camera.fy);
    EXPECT_EQ(c.cx, camera.cx);
    EXPECT_EQ(c.cy, camera.cy);
    EXPECT_TRUE(std::equal(camera.distortion.begin(), camera.distortion.end(), c.distortion));
    EXPECT_EQ(c.floor_distance_mm, camera.floor ? camera.floor->distance_mm : 0);
    if (camera.floor) EXPECT_TRUE(std::equal(c.floor_normal, c.floor_normal + 3, camera.floor->normal.begin()));
  };
  livecap_camera c;
  ASSERT_EQ(livecap_camera_from_fov(640, 360, 75, &c), LIVECAP_OK);
  expect_same(c);
  camera.fy = 1.25 * camera.fx;
  camera.distortion = {0.5, -0.25, 0.125, 0.0625, 0.75};
  camera.floor = FloorPlane{{0, -1, 0}, 875};
  save_camera(camera, scratch / "camera.json");
  ASSERT_EQ(livecap_load_camera((scratch / "camera.json").c_str(), &c), LIVECAP_OK);
  expect_same(c);

  expect_failed(livecap_camera_from_fov(640, 360, 180, &c), LIVECAP_CONFIG_ERROR, "fov_deg 180");
  expect_failed(livecap_load_camera("no_such_camera.json", &c), LIVECAP_IO_ERROR, "no_such_camera.json");
}

// A capture of pictures in which nobody is.
class EmptyScene {
 public:
  explicit EmptyScene(const std::filesystem::path& model, livecap_callback on_result = nullptr, void* user = nullptr)
      : grey_(size_t(3) * kWidth * kHeight, 128), model_(model), device_(test::device_selectors().front()) {
    livecap_options options = good_options();
    options.model = model_.c_str();
    options.cnn_device = options.solver_device = device_.c_str();
    options.on_result = on_result;
    options.user = user;
    EXPECT_EQ(livecap_open(&options, &capture_), LIVECAP_OK) << livecap_last_error();
  }
  ~EmptyScene() { livecap_free(capture_); }

  livecap_capture* capture() const { return capture_; }
  livecap_picture picture(double time_s) const { return {grey_.data(), 0, time_s, kWidth, kHeight, LIVECAP_RGB}; }
  livecap_error push(double time_s) const {
    const livecap_picture good = picture(time_s);
    return livecap_push(capture_, &good);
  }

 private:
  std::vector<uint8_t> grey_;
  std::string model_, device_;
  livecap_capture* capture_ = nullptr;
};

void expect_own_actor(const livecap_actor& c) {
  const Actor actor = load_actor(Calls::file_);
  const auto same = [](const auto* given, size_t n, const auto& expected) {
    return n == expected.size() && std::equal(expected.begin(), expected.end(), given);
  };
  EXPECT_TRUE(same(reinterpret_cast<const char*>(c.glb), c.glb_bytes, read_file(Calls::file_)));
  EXPECT_EQ(c.n_vertices, actor.n_vertices());
  EXPECT_TRUE(same(c.triangles, size_t(3) * c.n_triangles, actor.mesh.triangles));
  EXPECT_TRUE(same(c.drawn_vertex, c.n_drawn, actor.render.template_vertex));
  EXPECT_TRUE(same(c.drawn_uv, size_t(2) * c.n_drawn, actor.render.uvs));
  EXPECT_TRUE(same(c.drawn_triangles, size_t(3) * c.n_triangles, actor.render.triangles));
  ASSERT_EQ(c.n_bones, actor.skeleton.n_bones());
  for (int b = 0; b < c.n_bones; ++b) {
    const Bone& bone = actor.skeleton.bones[b];
    EXPECT_EQ(c.bones[b].name, bone.name);
    EXPECT_EQ(c.bones[b].parent, bone.parent);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(c.bones[b].offset_m[k], bone.offset_mm[k] / 1000, test::kFloatChain);
  }
  ASSERT_EQ(size_t(c.n_angles), actor.skeleton.dofs.size());
  for (int a = 0; a < c.n_angles; ++a) EXPECT_EQ(c.angles[a], actor.skeleton.dofs[a].name);
}

TEST_F(Calls, ACaptureRefusesWhatCannotBeAndGoesOn) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const EmptyScene scene(model);
  ASSERT_NE(scene.capture(), nullptr);
  expect_own_actor(*livecap_get_actor(scene.capture()));

  EXPECT_EQ(scene.push(1), LIVECAP_OK);
  const auto expect_refused_picture = [&](const char* what, auto&& change) {
    livecap_picture picture = scene.picture(2);
    change(picture);
    expect_failed(livecap_push(scene.capture(), &picture), LIVECAP_CONFIG_ERROR, what);
  };
  expect_refused_picture("it is 272x482", [](livecap_picture& p) { p.height += 2; });
  expect_refused_picture("no pixels", [](livecap_picture& p) { p.pixels = nullptr; });
  expect_refused_picture("row_bytes is 815", [](livecap_picture& p) { p.row_bytes = 815; });
  expect_refused_picture("row_bytes is -815", [](livecap_picture& p) { p.row_bytes = -815; });
  expect_refused_picture("PixelFormat 9", [](livecap_picture& p) { p.format = 9; });
  expect_refused_picture("time is 1 s", [](livecap_picture& p) { p.time_s = 1; });
  expect_failed(livecap_push(scene.capture(), nullptr), LIVECAP_CONFIG_ERROR, "picture is NULL");
  EXPECT_EQ(scene.push(2), LIVECAP_OK);

  EXPECT_EQ(livecap_close(scene.capture()), LIVECAP_OK);
  EXPECT_EQ(livecap_close(scene.capture()), LIVECAP_OK);
  expect_failed(scene.push(3), LIVECAP_ENDED, "livecap_close() says");
  // Also of pictures that it would refuse: a program that waits for the end must not take it for its own mistake.
  expect_failed(scene.push(1), LIVECAP_ENDED, "livecap_close() says");
  livecap_picture small = scene.picture(4);
  small.width /= 2;
  expect_failed(livecap_push(scene.capture(), &small), LIVECAP_ENDED, "livecap_close() says");
  const livecap_result* last = livecap_poll(scene.capture());
  ASSERT_NE(last, nullptr);
  EXPECT_EQ(last->index, 1);
  EXPECT_EQ(last->status, LIVECAP_TRACK_NOBODY);
  EXPECT_EQ(livecap_poll(scene.capture()), nullptr);
}

// One thread pushes faster than anybody can capture, another polls: each picture is heard of, and what is polled is
// always newer and was never dropped.
TEST_F(Calls, PollingIsForTheNewest) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  std::vector<int32_t> heard;
  const EmptyScene scene(
      model,
      [](const livecap_result* result, void* user) {
        static_cast<std::vector<int32_t>*>(user)->push_back(result->status);
      },
      &heard);
  constexpr int kPictures = 100;
  std::atomic<bool> closed = false;
  std::thread camera([&] {
    for (int i = 0; i < kPictures; ++i) EXPECT_EQ(scene.push(i), LIVECAP_OK);
    EXPECT_EQ(livecap_close(scene.capture()), LIVECAP_OK);
    closed = true;
  });
  int64_t newest = -1;
  for (bool ending = false; !ending;) {
    ending = closed;
    while (const livecap_result* result = livecap_poll(scene.capture())) {
      EXPECT_GT(result->index, newest);
      EXPECT_NE(result->status, LIVECAP_TRACK_DROPPED);
      newest = result->index;
    }
    std::this_thread::yield();
  }
  camera.join();
  EXPECT_EQ(newest, kPictures - 1);
  EXPECT_EQ(heard.size(), size_t(kPictures));
  EXPECT_GT(std::count(heard.begin(), heard.end(), LIVECAP_TRACK_DROPPED), kPictures / 2);
}

void push_until_it_ends(const EmptyScene& scene) {
  livecap_error error = LIVECAP_OK;
  for (int i = 0; i < 10000 && error == LIVECAP_OK; ++i) {
    error = scene.push(i);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(error, LIVECAP_ENDED);
}

// What goes wrong on the way ends the capture, and closing it says what it was. Callbacks of C cannot throw, but those
// of C++ can.
TEST_F(Calls, AnErrorOnTheWayIsToldByClosing) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  struct Heard {
    const EmptyScene* scene = nullptr;
    livecap_error pushed = LIVECAP_OK, closed = LIVECAP_OK;
  } heard;
  const EmptyScene scene(
      model,
      [](const livecap_result*, void* user) {
        Heard& own = *static_cast<Heard*>(user);
        own.pushed = own.scene->push(1e9);
        own.closed = livecap_close(own.scene->capture());
        throw std::runtime_error("the caller's own");
      },
      &heard);
  heard.scene = &scene;
  push_until_it_ends(scene);
  expect_failed(livecap_close(scene.capture()), LIVECAP_LOGIC_ERROR, "the caller's own");
  EXPECT_EQ(livecap_close(scene.capture()), LIVECAP_OK);
  EXPECT_EQ(heard.pushed, LIVECAP_LOGIC_ERROR) << "it would wait for itself";
  EXPECT_EQ(heard.closed, LIVECAP_LOGIC_ERROR);
}

// Here of a capture that is freed without having been closed.
TEST_F(Calls, TheLogGoesWhereItIsWanted) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  std::string lines;
  livecap_set_log(
      LIVECAP_LOG_ERROR,
      [](int32_t level, const char* line, void* user) {
        *static_cast<std::string*>(user) += std::to_string(level) + " " + line + "\n";
      },
      &lines);
  {
    const EmptyScene scene(model, [](const livecap_result*, void*) { throw std::runtime_error("the caller's own"); });
    push_until_it_ends(scene);
  }
  livecap_set_log(LIVECAP_LOG_WARNING, nullptr, nullptr);
  EXPECT_EQ(lines, "0 a live capture that nobody closed ended by an error: the caller's own\n");
}

}  // namespace
}  // namespace livecap

// Whole renders of a tiny capture made by hand: five frames, the first without a person, the person moving to the
// right.
#include "render/render_capture.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "actor/actor.h"
#include "base/text.h"
#include "eval/capture_folder.h"
#include "export/pc2.h"
#include "image/image_io.h"
#include "image/undistort.h"
#include "image/video.h"
#include "livecap/camera.h"
#include "livecap/error.h"
#include "livecap/log.h"
#include "picture/color_scale.h"
#include "picture/overlay.h"
#include "support/refusal.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap::render {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 5;
constexpr int64_t kFirst = 2;  // the capture begins at this frame of its video
constexpr float kStepM = 0.1f;

class RenderCapture : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / format("livecap_render_%d", static_cast<int>(::getpid()));
    fs::create_directories(capture());
    fs::create_directories(folder_ / "video");
    write_file_atomically(folder_ / "actor.glb", make_builtin_actor_glb("trousers", kBuiltinHeightMm, 1500));
    actor_ = load_actor(folder_ / "actor.glb");
    camera_ = camera_from_fov(90, 160, 45);
    camera_.distortion = {-0.1, 0.02, 0, 0, 0};
    save_camera(camera_, folder_ / "camera.json");
    save_camera(Undistorter(camera_).undistorted_camera(), capture() / "camera.json");
    for (int i = 0; i < kFrames + static_cast<int>(kFirst); ++i)
      write_png(video_picture(i), folder_ / format("video/%03d.png", i));

    Pc2Writer pc2(capture() / "vertices.pc2", actor_.n_vertices());
    std::string frames = "index,pts_ms,status,latency_ms\n", joints = "index,pts_ms,tracked", angles = joints;
    const PosedSkeleton rest = forward_kinematics(actor_.skeleton, rest_pose(actor_.skeleton));
    for (const Bone& bone : actor_.skeleton.bones)
      for (const char* axis : {"_x", "_y", "_z"}) joints += ",joint_" + bone.name + axis;
    for (const Dof& dof : actor_.skeleton.dofs) angles += "," + dof.name;
    joints += "\n";
    angles += "\n";
    for (int k = 0; k < kFrames; ++k) {
      pc2.append(vertices_m(k));
      frames += format("%d,%g,%s,0\n", k + static_cast<int>(kFirst), 40.0 * k, k == 0 ? "nobody" : "ok");
      joints += format("%d,0,1", k + static_cast<int>(kFirst));
      for (const Eigen::Isometry3d& bone : rest.camera_from_bone) {
        const Eigen::Vector3d p = placed_m(bone.translation(), k);
        joints += format(",%.9g,%.9g,%.9g", p.x(), p.y(), p.z());
      }
      angles += format("%d,0,1", k + static_cast<int>(kFirst));
      for (const Dof& dof : actor_.skeleton.dofs) angles += format(",%.12g", dof.rest_rad * 180 / M_PI);
      joints += "\n";
      angles += "\n";
    }
    write_file_atomically(capture() / "frames.csv", frames);
    write_file_atomically(capture() / "joints.csv", joints);
    write_file_atomically(capture() / "angles.csv", angles);
    write_report((folder_ / "actor.glb").string());
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static fs::path capture() { return folder_ / "capture"; }

  static void write_report(const std::string& actor) {
    write_file_atomically(capture() / "report.json", R"({"options":{"actor":")" + actor + R"(","camera":")" +
                                                         (folder_ / "camera.json").string() + R"(","video":")" +
                                                         (folder_ / "video").string() + R"(","height_mm":0}})");
  }

  // Rest frame, mm -> glTF frame, m, in row k: three metres away, facing the camera.
  static Eigen::Vector3d placed_m(const Eigen::Vector3d& rest_mm, int k) {
    return rest_mm / 1000 + Eigen::Vector3d(kStepM * k, -0.9, -3);
  }
  static std::vector<float> vertices_m(int k) {
    std::vector<float> vertices;
    for (int i = 0; i < actor_.n_vertices(); ++i) {
      const Eigen::Vector3d p = placed_m(Eigen::Vector3f::Map(&actor_.mesh.positions[3 * i]).cast<double>(), k);
      for (int axis = 0; axis < 3; ++axis) vertices.push_back(static_cast<float>(p[axis]));
    }
    return vertices;
  }
  // A ramp, and in blue which frame it is.
  static ImageRgb video_picture(int index) {
    ImageRgb image{90, 160, {}};
    for (int y = 0; y < 160; ++y) {
      for (int x = 0; x < 90; ++x)
        for (int value : {x, y, 20 * index}) image.pixels.push_back(static_cast<uint8_t>(value));
    }
    return image;
  }
  static RenderOptions options(const std::string& out) {
    RenderOptions options;
    options.capture = capture().string();
    options.out = (folder_ / out).string();
    return options;
  }
  static ImageRgb rendered(RenderOptions asked, int index) {
    asked.out = (folder_ / "one").string();
    fs::remove_all(asked.out);
    asked.first = index;
    asked.frames = 1;
    render_capture(asked);
    return read_image_rgb(fs::path(asked.out) / format("%06d.png", index));
  }
  template <typename E>
  static void expect_refused(const RenderOptions& asked, const std::vector<std::string>& words) {
    test::expect_refused<E>([&] { render_capture(asked); }, words);
  }

  static inline fs::path folder_;
  static inline Actor actor_;
  static inline Camera camera_;
};

// Mean place of the pixels that differ, and how many.
struct Difference {
  double x = 0, y = 0;
  int n = 0;
};
Difference difference(const ImageRgb& a, const ImageRgb& b) {
  Difference result;
  for (size_t i = 0; i < a.pixels.size(); i += 3) {
    if (std::equal(&a.pixels[i], &a.pixels[i] + 3, &b.pixels[i])) continue;
    result.x += static_cast<double>(i / 3 % a.width);
    result.y += static_cast<double>(i / 3 / a.width);
    ++result.n;
  }
  result.x /= result.n;
  result.y /= result.n;
  return result;
}

TEST_F(RenderCapture, TheCamerasViewIsTheOverlayOverTheUndistortedVideo) {
  RenderOptions asked = options("");
  asked.samples = 1;
  asked.opacity = OverlayOptions().alpha;
  const Undistorter undistorter(camera_);
  const ImageRgb input = undistorter.undistort(video_picture(2 + kFirst));
  const ImageRgb expected =
      render_overlay(actor_, to_camera_mm(vertices_m(2)), undistorter.undistorted_camera(), input);
  EXPECT_EQ(rendered(asked, 2 + kFirst).pixels, expected.pixels);
  // Four samples a pixel: the same but for edges and fine texture.
  asked.samples = 2;
  const ImageRgb fine = rendered(asked, 2 + kFirst);
  double sum = 0;
  for (size_t i = 0; i < fine.pixels.size(); ++i) sum += std::abs(fine.pixels[i] - expected.pixels[i]);
  EXPECT_LT(sum / static_cast<double>(fine.pixels.size()), test::kFinerPicture);
  EXPECT_GT(sum, 0);
}

TEST_F(RenderCapture, AFrameThatWasNotTrackedShowsTheVideoAlone) {
  const ImageRgb input = Undistorter(camera_).undistort(video_picture(kFirst));
  EXPECT_EQ(rendered(options(""), kFirst).pixels, input.pixels);
}

TEST_F(RenderCapture, WhereNobodyWasTrackedTheCamerasViewIsTheVideoAndNoOtherIs) {
  const fs::path frames = capture() / "frames.csv", kept = folder_ / "kept.csv";
  fs::copy_file(frames, kept, fs::copy_options::overwrite_existing);
  std::string nobody = read_file(frames);
  for (size_t at; (at = nobody.find(",ok,")) != std::string::npos;) nobody.replace(at, 4, ",lost,");
  write_file_atomically(frames, nobody);
  RenderOptions asked = options("");
  EXPECT_EQ(rendered(asked, 3 + kFirst).pixels, Undistorter(camera_).undistort(video_picture(3 + kFirst)).pixels);
  asked = options("bad.mp4");
  asked.view = "front";
  expect_refused<IoError>(asked, {"frames.csv", "nobody"});
  fs::rename(kept, frames);
}

TEST_F(RenderCapture, HalfTheSizeHasThePersonAtHalfThePlace) {
  RenderOptions asked = options("");
  asked.background = "#0000ff";
  asked.style = "clay";
  const ImageRgb full = rendered(asked, 1 + kFirst);
  asked.width = 45;
  asked.height = 80;
  const ImageRgb half = rendered(asked, 1 + kFirst);
  ASSERT_EQ(half.width, 45);
  ImageRgb blue = full;
  for (size_t i = 0; i < blue.pixels.size(); ++i) blue.pixels[i] = i % 3 == 2 ? 255 : 0;
  const Difference large = difference(full, blue);
  blue = {45, 80, std::vector<uint8_t>(blue.pixels.begin(), blue.pixels.begin() + 3 * 45 * 80)};
  const Difference small = difference(half, blue);
  EXPECT_NEAR(small.x + 0.5, (large.x + 0.5) / 2, test::kHalfPicturePx);
  EXPECT_NEAR(small.y + 0.5, (large.y + 0.5) / 2, test::kHalfPicturePx);
  EXPECT_NEAR(large.x, camera_.fx * 0.1 / 3 + camera_.cx, test::kHalfPicturePx);  // 0.1 m to the right, 3 m away
}

TEST_F(RenderCapture, AFreeViewStandsStillWhileThePersonMoves) {
  RenderOptions asked = options("");
  asked.background = "#0000ff";
  asked.floor = false;
  asked.style = "clay";
  const auto place = [&](const std::string& view, int index) {
    asked.view = view;
    const ImageRgb image = rendered(asked, index);
    ImageRgb blue = image;
    for (size_t i = 0; i < blue.pixels.size(); ++i) blue.pixels[i] = i % 3 == 2 ? 255 : 0;
    return difference(image, blue);
  };
  asked.distance_m = 3;
  // The subject's left is where they go: to the right from the front, to the left from behind.
  EXPECT_GT(place("front", 4 + kFirst).x, place("front", 1 + kFirst).x + 5);
  EXPECT_LT(place("back", 4 + kFirst).x, place("back", 1 + kFirst).x - 5);
  // From their left they come nearer and stay in the middle.
  EXPECT_GT(place("left", 4 + kFirst).n, place("left", 1 + kFirst).n);
  EXPECT_LT(place("right", 4 + kFirst).n, place("right", 1 + kFirst).n);
  asked.distance_m.reset();
  asked.view = "camera";
  asked.elevation_deg = 0;
  EXPECT_GT(place("camera", 2 + kFirst).n, 500);  // the person is there, as large as the picture has room for
}

TEST_F(RenderCapture, DisplacementIsTheDistanceFromTheSkinnedSurface) {
  RenderOptions asked = options("");
  asked.background = "#0000ff";
  asked.style = "displacement";
  const ImageRgb none = rendered(asked, 2 + kFirst);
  // Vertices moved by 30 mm relative to joints and angles, in row 2 alone.
  std::vector<float> held = vertices_m(2);
  for (size_t i = 1; i < held.size(); i += 3) held[i] += 0.03f;
  fs::copy_file(capture() / "vertices.pc2", folder_ / "kept.pc2", fs::copy_options::overwrite_existing);
  {
    Pc2Writer pc2(capture() / "vertices.pc2", actor_.n_vertices());
    for (int k = 0; k < kFrames; ++k) pc2.append(k == 2 ? held : vertices_m(k));
  }
  asked.scale_mm = 30;
  const ImageRgb moved = rendered(asked, 2 + kFirst);
  fs::copy_file(folder_ / "kept.pc2", capture() / "vertices.pc2", fs::copy_options::overwrite_existing);
  // The middle of the trunk, which faces the camera.
  const int x = static_cast<int>(std::lround(camera_.fx * 0.2 / 3 + camera_.cx)), y = 60;
  for (const auto& [image, value] : {std::pair{&none, 0.0}, {&moved, 1.0}}) {
    const uint8_t* pixel = &image->pixels[3 * (size_t(y) * 90 + x)];
    const Rgb color = heat_color(value);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(pixel[k], color[k] + test::kByteRounding) << value;
      EXPECT_GE(pixel[k], 0.8 * color[k] - test::kByteRounding) << value;  // shaded
    }
  }
}

TEST_F(RenderCapture, NormalsAndMaterialsHaveTheirColours) {
  RenderOptions asked = options("");
  asked.background = "#000000";
  const int x = static_cast<int>(std::lround(camera_.fx * 0.2 / 3 + camera_.cx)), y = 60;  // of the trunk
  asked.style = "normals";
  const ImageRgb normals = rendered(asked, 2 + kFirst);
  const uint8_t* normal = &normals.pixels[3 * (size_t(y) * 90 + x)];
  EXPECT_GT(normal[2], 220);  // towards the viewer
  EXPECT_LT(std::abs(normal[0] - 128) + std::abs(normal[1] - 128), normal[2] - 128);
  double to_right = 0, up = 0;
  for (int i = 0; i < 90 * 160; ++i) {
    if (normals.pixels[3 * i + 2] == 0) continue;
    to_right += (i % 90 - x) * (normals.pixels[3 * i] - 128.0);  // what is at the right faces there
    up += i / 90 < 30 ? normals.pixels[3 * i + 1] - 128.0 : 0;   // the top of the head
  }
  EXPECT_GT(to_right, 0);
  EXPECT_GT(up, 0);

  asked.style = "materials";
  const ImageRgb materials = rendered(asked, 2 + kFirst);
  const uint8_t* material = &materials.pixels[3 * (size_t(y) * 90 + x)];
  const Rgb shirt = label_color(5);
  const auto strongest = std::max_element(shirt.begin(), shirt.end()) - shirt.begin();
  const double shade = material[strongest] / shirt[strongest];
  EXPECT_GT(shade, 0.5);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(material[k], shade * shirt[k], test::kByteRounding);
}

TEST_F(RenderCapture, WithoutBackgroundThereIsOpacityWhereThePersonIs) {
  RenderOptions asked = options("cut");
  asked.background = "none";
  asked.style = "clay";
  asked.first = 2 + kFirst;
  asked.frames = 1;
  render_capture(asked);
  const cv::Mat cut =
      cv::imread((folder_ / "cut" / format("%06d.png", 2 + static_cast<int>(kFirst))).string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(cut.channels(), 4);
  asked.background = "#0000ff";
  const ImageRgb over_blue = rendered(asked, 2 + kFirst);
  int transparent = 0, opaque = 0;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 90; ++x) {
      const cv::Vec4b pixel = cut.at<cv::Vec4b>(y, x);
      const double alpha = pixel[3] / 255.0;
      transparent += pixel[3] == 0;
      opaque += pixel[3] == 255;
      for (int k = 0; k < 3; ++k) {
        const double expected = alpha * pixel[2 - k] + (1 - alpha) * (k == 2 ? 255 : 0);
        EXPECT_NEAR(over_blue.pixels[3 * (y * 90 + x) + k], expected, test::kRecomposedBytes);
      }
    }
  }
  EXPECT_GT(transparent, 90 * 160 / 2);
  EXPECT_GT(opaque, 500);
}

TEST_F(RenderCapture, FilmSheetAndSideBySide) {
  RenderOptions asked = options("film.mp4");
  asked.side_by_side = true;
  const RenderReport report = render_capture(asked);
  EXPECT_EQ(report.pictures, kFrames);
  EXPECT_EQ(report.empty, 1);
  EXPECT_EQ(report.width, 180);
  EXPECT_NEAR(report.fps, 25, test::kDoubleExact);
  VideoReader film(asked.out);
  EXPECT_EQ(film.info().width, 180);
  EXPECT_NEAR(film.info().fps, 25, test::kHandComputed);
  int n = 0;
  for (Frame frame; film.read(frame);) ++n;
  EXPECT_EQ(n, kFrames);

  asked = options("sheet.png");
  asked.sheet_columns = 2;
  asked.sheet_rows = 2;
  asked.every = 1;
  EXPECT_EQ(render_capture(asked).pictures, 4);
  const ImageRgb sheet = read_image_rgb(asked.out);
  EXPECT_EQ(sheet.width, 2 * 90 + 4);
  EXPECT_EQ(sheet.height, 2 * 160 + 4);
  // Rows 1 to 4 are tracked; the second is at the upper right, the last at the lower right.
  for (const auto& [row, top] : {std::pair{2, 0}, {4, 164}}) {
    const ImageRgb panel = rendered(options(""), row + kFirst);
    for (int x = 0; x < 90; ++x) {
      EXPECT_TRUE(std::equal(&panel.pixels[3 * (80 * 90 + x)], &panel.pixels[3 * (80 * 90 + x)] + 3,
                             &sheet.pixels[3 * (size_t(top + 80) * sheet.width + 94 + x)]))
          << row << " " << x;
    }
  }

  asked = options("half.mp4");
  asked.every = 2;
  EXPECT_EQ(render_capture(asked).pictures, 3);
  VideoReader half(asked.out);
  EXPECT_NEAR(half.info().fps, 12.5, test::kHandComputed);  // as long as the video
}

TEST_F(RenderCapture, PaintsAPictureForEveryProcessorWithin2GB) {
  EXPECT_EQ(pictures_at_once(540 * 960, 8), 8u);
  EXPECT_EQ(pictures_at_once(540 * 960, 0), 1u);
  EXPECT_EQ(pictures_at_once(540 * 960, 64), 16u);
  EXPECT_EQ(pictures_at_once(66'000'000, 8), 3u);  // 0.66 GB each
  EXPECT_EQ(pictures_at_once(int64_t{16384} * 16384, 8), 1u);
}

TEST_F(RenderCapture, StoppedEarlyWhatIsThereIsWhole) {
  const RenderOptions asked = options("short.mp4");
  const RenderReport report = render_capture(asked, [](int64_t done, int64_t) { return done < 2; });
  EXPECT_FALSE(report.complete);
  VideoReader film(asked.out);
  int64_t n = 0;
  for (Frame frame; film.read(frame);) ++n;
  EXPECT_EQ(n, report.pictures);
  EXPECT_EQ(n, 2);  // however many are painted at once
  EXPECT_TRUE(render_capture(options("whole.mp4"), [](int64_t done, int64_t) { return done < kFrames; }).complete);
}

// Pictures of an earlier, longer clip would count as this one's; other files are nobody's.
TEST_F(RenderCapture, PicturesOfAnotherRenderStayAndAreToldOf) {
  RenderOptions asked = options("again");
  asked.background = "#0000ff";
  asked.frames = 4;  // of the video; the capture's are 2 to 6
  const fs::path again = folder_ / "again";
  fs::create_directories(again);
  for (const char* name : {"000000.png", "000002.png", "000005.png", "000007.png", "other.png", "0000003.png"})
    write_file_atomically(again / name, "old");
  std::vector<std::string> lines;
  set_log_sink([&](LogLevel, const std::string& line) { lines.push_back(line); });
  EXPECT_EQ(render_capture(asked, {}).pictures, 2);
  set_log_sink({});
  EXPECT_EQ(lines, std::vector<std::string>{again.string() + ": 3 numbered pictures in it are of another render"});
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(again)) names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"000000.png", "0000003.png", "000002.png", "000003.png", "000005.png",
                                             "000007.png", "other.png"}));
}

TEST_F(RenderCapture, AMovedActorIsReadFromTheFolder) {
  fs::copy_file(folder_ / "actor.glb", capture() / "actor.glb", fs::copy_options::overwrite_existing);
  write_report("nowhere/actor.glb");
  const ImageRgb image = rendered(options(""), 2 + kFirst);
  write_report((folder_ / "actor.glb").string());
  fs::remove(capture() / "actor.glb");
  EXPECT_EQ(image.pixels, rendered(options(""), 2 + kFirst).pixels);
}

// The report names its actor and its camera; nobody writes to this pipe, so that opening it would wait for ever.
TEST_F(RenderCapture, APipeIsNotNamedByAReport) {
  const std::string pipe = (folder_ / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::vector<std::string> words = {"pipe: is a pipe or a device"};
  write_report(pipe);
  expect_refused<IoError>(options("x"), words);
  write_report((folder_ / "actor.glb").string());
  const auto put_pipe_at = [&](const std::string& named) {
    std::string report = read_file(capture() / "report.json");
    report.replace(report.find(named), named.size(), pipe);
    write_file_atomically(capture() / "report.json", report);
  };
  put_pipe_at((folder_ / "camera.json").string());
  expect_refused<IoError>(options("x"), words);
  write_report((folder_ / "actor.glb").string());
  put_pipe_at((folder_ / "video").string());
  expect_refused<IoError>(options("x"), words);
  write_report((folder_ / "actor.glb").string());
}

TEST_F(RenderCapture, RefusesWhatIsNoCapture) {
  RenderOptions asked = options("bad.mp4");
  asked.capture = (folder_ / "none").string();
  expect_refused<IoError>(asked, {"none", "folder"});
  asked = options("bad.mp4");
  asked.first = 100;
  expect_refused<IoError>(asked, {"frames.csv", "--first"});
  asked = options("bad.mp4");
  asked.background = "sky";
  expect_refused<ConfigError>(asked, {"--background sky"});
  asked = options("none/bad.mp4");
  expect_refused<IoError>(asked, {"bad.mp4"});
  asked = options("video/000.png");
  asked.video = asked.out;
  expect_refused<ConfigError>(asked, {"000.png", "input"});
  asked = options("video/new.png");  // would be a picture of the video from then on
  expect_refused<ConfigError>(asked, {"new.png", "video", "input"});
  asked = options("video");
  expect_refused<ConfigError>(asked, {"video", "input"});
  asked = options("video");
  asked.video = (folder_ / "other").string();
  asked.background = (folder_ / "video/000.png").string();  // might be overwritten by a frame's picture
  expect_refused<ConfigError>(asked, {"video", "000.png", "input"});

  asked = options("bad.mp4");
  asked.first = kFirst;
  asked.every = 5000;
  expect_refused<ConfigError>(asked, {"--every 5000", "0.005", "--fps"});

  // Names that no file system takes.
  const std::string overlong(300, 'x');
  asked = options("bad.mp4");
  asked.capture = overlong;
  expect_refused<IoError>(asked, {overlong, "folder"});
  asked = options("bad.mp4");
  asked.background = overlong;
  expect_refused<ConfigError>(asked, {"--background " + overlong});
  for (const std::string suffix : {".mp4", ".png", ""}) expect_refused<IoError>(options(overlong + suffix), {overlong});

  // Files of the folder that are missing or cut off.
  const fs::path pc2 = capture() / "vertices.pc2", kept = folder_ / "kept.pc2";
  fs::rename(pc2, kept);
  expect_refused<IoError>(options("bad.mp4"), {"vertices.pc2", "missing"});
  fs::copy_file(kept, pc2);
  fs::resize_file(pc2, fs::file_size(pc2) - 100);
  expect_refused<IoError>(options("bad.mp4"), {"vertices.pc2", "truncated"});
  { Pc2Writer of_another(pc2, 7); }
  expect_refused<IoError>(options("bad.mp4"), {"vertices.pc2", "7 points", "actor.glb"});
  {
    Pc2Writer shorter(pc2, actor_.n_vertices());
    shorter.append(vertices_m(0));
  }
  expect_refused<IoError>(options("bad.mp4"), {"vertices.pc2", "1 samples", "5 rows"});
  fs::rename(kept, pc2);

  for (const std::string name : {"joints.csv", "angles.csv"}) {
    const std::string whole = read_file(capture() / name);
    write_file_atomically(capture() / name, whole.substr(0, whole.rfind('\n', whole.size() - 2) + 1));
    asked = options("bad.mp4");
    asked.style = "displacement";
    expect_refused<IoError>(asked, {name, "4 rows", "5 rows"});
    write_file_atomically(capture() / name, whole);
  }

  // As captures have it that were made before a joint could turn.
  const std::string angles = read_file(capture() / "angles.csv");
  std::string without = angles;
  without.replace(without.find("neck_x"), 6, "nack_x");
  write_file_atomically(capture() / "angles.csv", without);
  asked = options("bad.mp4");
  asked.style = "displacement";
  expect_refused<IoError>(asked, {"angles.csv", "no column \"neck_x\"", "capture it again"});
  write_file_atomically(capture() / "angles.csv", angles);

  asked = options("bad.png");
  asked.sheet_columns = 100;
  asked.sheet_rows = 1;
  asked.width = 200;
  asked.height = 20;
  expect_refused<ConfigError>(asked, {"--sheet", "20396 px"});

  // Too large for its samples: the size that was asked for, and the camera's own.
  asked = options("bad.png");
  asked.samples = 4;
  asked.width = asked.height = 8000;
  expect_refused<ConfigError>(asked, {"--samples 4", "8000x8000", "4096 px", "--size"});
  asked.width = asked.height = 0;
  asked.view = "front";
  asked.camera = (folder_ / "large.json").string();
  save_camera(camera_from_fov(3000, 5000, 45), asked.camera);
  expect_refused<ConfigError>(asked, {"--samples 4", "3000x5000", "4096 px", "--size"});

  asked = options("bad.mp4");
  asked.video = (folder_ / "wide").string();
  fs::create_directories(asked.video);
  write_png(ImageRgb{100, 160, std::vector<uint8_t>(3 * 100 * 160)}, folder_ / "wide/0.png");
  expect_refused<IoError>(asked, {"wide", "100x160", "90x160", "--camera"});

  // A video that is too short is seen when it ends; no film is left.
  asked = options("bad.mp4");
  asked.video = (folder_ / "short").string();
  fs::create_directories(asked.video);
  write_png(video_picture(0), folder_ / "short/0.png");
  expect_refused<IoError>(asked, {"short", "frame 2"});
  for (int i = 1; i < 5; ++i) write_png(video_picture(i), folder_ / format("short/%d.png", i));
  asked.out = (folder_ / "bad").string();
  expect_refused<IoError>(asked, {"short", "frame 5", "bad holds the first 3 pictures"});
  EXPECT_FALSE(fs::exists(folder_ / "bad.mp4"));
  EXPECT_FALSE(fs::exists(folder_ / "bad.mp4.part"));
}

}  // namespace
}  // namespace livecap::render

// Pictures pushed one by one give what a file gives; and a live capture ends whenever it is asked to.
#include "livecap/live.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <future>
#include <limits>
#include <map>
#include <thread>

#include "actor/actor.h"
#include "capture/capture_run.h"
#include "image/image_io.h"
#include "image/video.h"
#include "livecap/error.h"
#include "nn/models.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// A short sequence on disk, its frames and its empty picture in memory.
class Sequence {
 public:
  Sequence(const ScratchFolder& scratch, int n_frames, int empty_frames) : folder(scratch / "sequence") {
    write_sequence(test::small_sequence(n_frames, empty_frames), folder);
    plate = read_image_rgb(folder / "background.png");
    VideoReader reader(folder / "video.mp4");
    for (Frame frame; reader.read(frame);) frames.push_back(frame);
  }

  LiveOptions options(const std::filesystem::path& model) const {
    LiveOptions live;
    live.camera = load_camera(folder / "camera.json");
    live.background = {picture(plate, 0)};
    live.actor = folder / "actor.glb";
    live.model = model;
    live.cnn_device = live.solver_device = test::device_selectors().front();
    return live;
  }

  static Picture picture(const ImageRgb& image, double time_s) {
    return {image.pixels.data(), image.width, image.height, 0, PixelFormat::kRgb, time_s};
  }
  Picture picture(int i) const { return picture(frames[i].image, frames[i].pts_ms / 1000); }

  std::filesystem::path folder;
  ImageRgb plate;
  std::vector<Frame> frames;
};

// The same picture with blue first, a fourth byte a pixel, and rows of some bytes more.
std::vector<uint8_t> as_bgra(const ImageRgb& image, size_t row_bytes) {
  std::vector<uint8_t> bytes(row_bytes * image.height, 77);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const uint8_t* rgb = &image.pixels[3 * (size_t(y) * image.width + x)];
      uint8_t* out = &bytes[y * row_bytes + 4 * x];
      out[0] = rgb[2];
      out[1] = rgb[1];
      out[2] = rgb[0];
    }
  }
  return bytes;
}

// vertices.pc2: a header of 32 bytes, then the vertices of each frame.
std::vector<float> pc2_frame(const std::string& pc2, int n_vertices, int frame) {
  std::vector<float> vertices(size_t(3) * n_vertices);
  const size_t bytes = vertices.size() * sizeof(float);
  EXPECT_LE(32 + (frame + 1) * bytes, pc2.size());
  std::memcpy(vertices.data(), pc2.data() + 32 + frame * bytes, bytes);
  return vertices;
}

// joints.csv: each joint's place in metres by its column.
std::vector<std::map<std::string, double>> csv_rows(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line, cell;
  std::getline(file, line);
  std::vector<std::string> names;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
  std::vector<std::map<std::string, double>> rows;
  while (std::getline(file, line)) {
    std::map<std::string, double> row;
    size_t column = 0;
    for (std::istringstream cells(line); std::getline(cells, cell, ','); ++column)
      row[names[column]] = cell.empty() ? std::numeric_limits<double>::quiet_NaN() : std::stod(cell);
    rows.push_back(row);
  }
  return rows;
}

TEST(Live, PushedPicturesGiveWhatTheirFileGives) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  const Sequence sequence(scratch, 14, 3);
  run_capture(test::capture_of(sequence.folder, scratch / "file", model));

  LiveOptions options = sequence.options(model);
  options.every_picture = true;
  std::vector<LiveResult> results;
  LiveCapture live(options, [&](const LiveResult& result) {
    results.push_back(result);
    return true;
  });
  for (int i = 0; i < 14; ++i) {
    Picture picture = sequence.picture(i);
    picture.row_bytes = 4 * size_t(picture.width) + 12;
    const std::vector<uint8_t> bgra = as_bgra(sequence.frames[i].image, picture.row_bytes);
    picture.pixels = bgra.data();
    picture.format = PixelFormat::kBgra;
    EXPECT_TRUE(live.push(picture));
  }
  live.close();
  live.close();

  const LiveActor& actor = live.actor();
  const std::string pc2 = read_file(scratch / "file/vertices.pc2");
  const auto rows = test::frame_rows(scratch / "file");
  const auto joints = csv_rows(scratch / "file/joints.csv");
  ASSERT_EQ(results.size(), 14u);
  int tracked = 0;
  for (int i = 0; i < 14; ++i) {
    const LiveResult& result = results[i];
    EXPECT_EQ(result.report.index, i);
    EXPECT_EQ(track_status_name(result.report.status), rows[i].status) << i;
    EXPECT_NEAR(result.report.pts_ms, sequence.frames[i].pts_ms, test::kHandComputed);
    if (!is_tracked(result.report.status)) {
      EXPECT_TRUE(result.vertices_m.empty() && result.bones.empty() && result.angles_rad.empty());
      continue;
    }
    ++tracked;
    EXPECT_EQ(result.angles_rad.size(), actor.angles.size());
    EXPECT_TRUE(result.vertices_m == pc2_frame(pc2, actor.n_vertices, i)) << i;
    ASSERT_EQ(result.bones.size(), actor.bones.size());
    // The rotations and the layout's offsets put every joint where the file has it.
    std::vector<Eigen::Isometry3d> bone(actor.bones.size());
    for (size_t b = 0; b < actor.bones.size(); ++b) {
      const auto& [name, parent, offset] = actor.bones[b];
      const auto& [position, q] = result.bones[b];
      bone[b] = parent < 0 ? Eigen::Isometry3d(Eigen::Translation3d(position[0], position[1], position[2]))
                           : bone[parent] * Eigen::Translation3d(offset[0], offset[1], offset[2]);
      bone[b].rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]));
      for (int k = 0; k < 3; ++k) {
        const std::string column = "joint_" + name + "_" + "xyz"[k];
        ASSERT_TRUE(joints[i].count(column)) << column;
        EXPECT_NEAR(bone[b].translation()[k], joints[i].at(column), test::kFloatChain) << column;
        EXPECT_NEAR(position[k], joints[i].at(column), test::kFloatChain) << column;
      }
    }
  }
  EXPECT_GE(tracked, 9);
}

TEST(Live, TheActorIsTheFilesOwn) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  const Sequence sequence(scratch, 3, 2);
  const LiveCapture live(sequence.options(model), [](const LiveResult&) { return true; });
  const LiveActor& actor = live.actor();
  const Actor file = load_actor(sequence.folder / "actor.glb");
  EXPECT_EQ(actor.glb, read_file(sequence.folder / "actor.glb"));
  EXPECT_EQ(actor.n_vertices, file.n_vertices());
  EXPECT_EQ(actor.bones.size(), file.skeleton.bones.size());
  EXPECT_EQ(actor.angles.size(), file.skeleton.dofs.size());
  ASSERT_EQ(actor.drawn_triangles.size(), actor.triangles.size());
  EXPECT_EQ(actor.drawn_uv.size(), 2 * actor.drawn_vertex.size());
  for (size_t i = 0; i < actor.triangles.size(); ++i)
    ASSERT_EQ(actor.triangles[i], actor.drawn_vertex[actor.drawn_triangles[i]]) << i;
}

// Faster than anybody can capture: each picture has one result, in order, and most are dropped.
TEST(Live, WhatComesTooFastIsDroppedAndToldOf) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  const Sequence sequence(scratch, 6, 1);
  std::vector<FrameReport> reports;
  LiveCapture live(sequence.options(model), [&](const LiveResult& result) {
    reports.push_back(result.report);
    return true;
  });
  constexpr int kPictures = 300;
  for (int i = 0; i < kPictures; ++i) {
    Picture picture = sequence.picture(3);
    picture.time_s = i / 1000.0;
    ASSERT_TRUE(live.push(picture));
  }
  live.close();
  ASSERT_EQ(reports.size(), size_t(kPictures));
  int dropped = 0;
  for (int i = 0; i < kPictures; ++i) {
    EXPECT_EQ(reports[i].index, i);
    dropped += reports[i].status == TrackStatus::kDropped;
  }
  EXPECT_GT(dropped, kPictures / 2);
  EXPECT_NE(reports.back().status, TrackStatus::kDropped);
}

TEST(Live, TheCallbackCanEndIt) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  const Sequence sequence(scratch, 4, 1);
  for (const bool by_error : {false, true}) {
    LiveOptions options = sequence.options(model);
    options.every_picture = true;
    int results = 0;
    LiveCapture live(options, [&](const LiveResult&) {
      ++results;
      if (by_error) throw IoError("the caller's disk is full");
      return false;
    });
    int pushed = 0;
    Picture picture = sequence.picture(2);
    while (pushed < 1000 && live.push(picture)) picture.time_s = ++pushed;
    EXPECT_LT(pushed, 100) << "push() says that it has ended";
    EXPECT_FALSE(live.push(picture));
    if (by_error) {
      EXPECT_THROW(live.close(), IoError);
    }
    EXPECT_NO_THROW(live.close());
    EXPECT_EQ(results, 1);
  }
}

// It would wait for itself.
TEST(Live, TheCallbackCannotPushOrClose) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  const Sequence sequence(scratch, 4, 1);
  for (const bool closes : {false, true}) {
    LiveOptions options = sequence.options(model);
    options.every_picture = true;
    LiveCapture* self = nullptr;
    LiveCapture live(options, [&](const LiveResult&) {
      if (closes) self->close();
      return self->push(sequence.picture(3));
    });
    self = &live;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(live.push(sequence.picture(i)));
    EXPECT_THROW(live.close(), LogicError) << closes;
  }
}

TEST(Live, WithoutCloseWhatIsUnderWayIsNotDelivered) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  const Sequence sequence(scratch, 5, 1);
  LiveOptions options = sequence.options(model);
  options.every_picture = true;
  std::promise<void> leaving;
  std::atomic<int> results = 0;
  {
    LiveCapture live(options, [&, left = leaving.get_future().share()](const LiveResult&) {
      ++results;
      left.wait();  // the first one, until nobody wants the others
      return true;
    });
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(live.push(sequence.picture(i)));
    while (results == 0) std::this_thread::yield();
    std::thread([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(300));  // the destructor has begun
      leaving.set_value();
    }).detach();
  }
  EXPECT_EQ(results, 1);
}

TEST(Live, PicturesThatCannotBeAreRefused) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  const Sequence sequence(scratch, 3, 1);
  const LiveCallback ignore = [](const LiveResult&) { return true; };
  EXPECT_THROW(LiveCapture(sequence.options(model), nullptr), ConfigError);
  LiveOptions options = sequence.options(model);
  options.camera.width = 0;
  EXPECT_THROW(LiveCapture(options, ignore), ConfigError);
  options = sequence.options(model);
  options.background[0].width -= 1;
  EXPECT_THROW(LiveCapture(options, ignore), ConfigError);

  LiveCapture live(sequence.options(model), ignore);
  const Picture good = sequence.picture(1);
  EXPECT_TRUE(live.push(good));
  const auto refuses = [&](auto&& change) {
    Picture picture = good;
    picture.time_s += 1;
    change(picture);
    EXPECT_THROW((void)live.push(picture), ConfigError);
  };
  refuses([](Picture& p) { p.height += 2; });
  refuses([](Picture& p) { p.pixels = nullptr; });
  refuses([](Picture& p) { p.row_bytes = 3 * p.width - 1; });
  refuses([](Picture& p) { p.row_bytes = 1 - 3 * p.width; });
  refuses([](Picture& p) { p.format = static_cast<PixelFormat>(9); });
  refuses([&](Picture& p) { p.time_s = good.time_s; });
  refuses([](Picture& p) { p.time_s = std::nan(""); });
  refuses([](Picture& p) { p.time_s = std::numeric_limits<double>::infinity(); });
  Picture next = good;
  next.time_s += 1;
  EXPECT_TRUE(live.push(next));
  live.close();
  EXPECT_FALSE(live.push({.pixels = good.pixels, .width = good.width, .height = good.height, .time_s = 99}));
}

}  // namespace
}  // namespace livecap

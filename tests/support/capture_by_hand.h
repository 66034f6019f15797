// A capture folder and its ground truth made by hand, for what reads both: the built-in actor at rest before a small
// camera, nobody in the first of four frames.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "actor/actor.h"
#include "base/text.h"
#include "eval/evaluate.h"
#include "eval/mask_raster.h"
#include "export/pc2.h"
#include "image/image_io.h"
#include "livecap/camera.h"
#include "synth/synth.h"

namespace livecap::test {

inline constexpr int kHandFrames = 4;  // the first without a person
inline const std::vector<float> kHandJoints = {0, 0, -3, 0.2f, 0.5f, -3.1f, -0.2f, 0.5f, -2.9f, 0.3f, 0.1f, -3.2f};

class CaptureByHand : public testing::Test {
 protected:
  // The built-in actor three metres in front of the camera as truth.
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / format("livecap_by_hand_%d", static_cast<int>(::getpid()));
    std::filesystem::create_directories(folder_ / "truth/masks");
    write_file_atomically(folder_ / "actor.glb", make_builtin_actor_glb("trousers", kBuiltinHeightMm, 1500));
    actor_ = load_actor(folder_ / "actor.glb");
    camera_ = camera_from_fov(90, 160, 45);
    save_camera(camera_, folder_ / "camera.json");
    for (int i = 0; i < actor_.n_vertices(); ++i) {
      const float* rest = &actor_.mesh.positions[3 * i];
      truth_.insert(truth_.end(), {rest[0] / 1000, rest[1] / 1000 - 0.9f, rest[2] / 1000 - 3});
    }
    std::vector<float> camera_mm = truth_;
    for (size_t i = 0; i < camera_mm.size(); ++i) camera_mm[i] *= i % 3 == 0 ? 1000 : -1000;
    ImageGray mask = render_silhouette(camera_mm, actor_.mesh.triangles, camera_);
    ImageGray empty = mask;
    empty.pixels.assign(empty.pixels.size(), 0);

    Pc2Writer pc2(folder_ / "truth/vertices.pc2", actor_.n_vertices());
    std::string joints = R"({"names":["Hips","LeftArm","RightArm","LeftHand"],"frames":[null)";
    for (int frame = 0; frame < kHandFrames; ++frame) {
      pc2.append(frame == 0 ? std::vector<float>(truth_.size(), NAN) : truth_);
      write_png(frame == 0 ? empty : mask, folder_ / "truth/masks" / format("%06d.png", frame));
      if (frame > 0) joints += ",[[0,0,-3],[0.2,0.5,-3.1],[-0.2,0.5,-2.9],[0.3,0.1,-3.2]]";
    }
    write_file_atomically(folder_ / "truth/joints.json", joints + "]}");
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  // A capture whose frame k has the truth's vertices and joints moved by shift_m[k] along x; NaN: no result.
  static EvalReport compare(const std::vector<float>& shift_m, const std::vector<std::string>& status,
                            const std::vector<ExtraView>& views = {}) {
    const std::filesystem::path out = folder_ / "capture";
    std::filesystem::create_directories(out);
    Pc2Writer pc2(out / "vertices.pc2", actor_.n_vertices());
    std::string frames = "index,pts_ms,status,latency_ms\n";
    std::string angles = "index,pts_ms,tracked,left_elbow_y,left_knee_x\n";
    std::string joints = "index,pts_ms,tracked";
    for (const char* name : {"joint_root", "joint_left_shoulder", "joint_right_shoulder", "keypoint_left_wrist"}) {
      for (const char* axis : {"_x", "_y", "_z"}) joints += std::string(",") + name + axis;
    }
    joints += "\n";
    for (int k = 0; k < kHandFrames; ++k) {
      std::vector<float> vertices = truth_;
      for (size_t i = 0; i < vertices.size(); i += 3) vertices[i] += shift_m[k];
      if (std::isnan(shift_m[k])) vertices.assign(vertices.size(), NAN);
      pc2.append(vertices);
      frames += format("%d,%g,%s,%d\n", k, 40.0 * k, status[k].c_str(), 100 + k);
      angles += format("%d,%g,1,%d,%d\n", k, 40.0 * k, k < 3 ? -60 : -149, 30);
      joints += format("%d,0,1", k);
      for (size_t i = 0; i < kHandJoints.size(); ++i) {
        joints += std::isnan(shift_m[k]) ? "," : format(",%.9g", kHandJoints[i] + (i % 3 == 0 ? shift_m[k] : 0));
      }
      joints += "\n";
    }
    write_file_atomically(out / "frames.csv", frames);
    write_file_atomically(out / "joints.csv", joints);
    write_file_atomically(out / "angles.csv", angles);
    write_file_atomically(out / "report.json", R"({"options":{"actor":")" + (folder_ / "actor.glb").string() +
                                                   R"(","camera":")" + (folder_ / "camera.json").string() +
                                                   R"(","height_mm":0}})");
    EvalOptions options{out, folder_ / "truth", "", "", views};
    return evaluate(options);
  }

  // The same frames captured with another mesh of the same actor, 100 mm to the side, instead of its vertices.
  static EvalOptions with_other_mesh() {
    const std::filesystem::path out = folder_ / "capture";
    write_file_atomically(folder_ / "other.glb", make_builtin_actor_glb("trousers", kBuiltinHeightMm, 1400));
    const Actor other = load_actor(folder_ / "other.glb");
    Pc2Writer pc2(out / "vertices.pc2", other.n_vertices());
    for (int k = 0; k < kHandFrames; ++k) {
      std::vector<float> vertices;
      for (int i = 0; i < other.n_vertices(); ++i) {
        const float* rest = &other.mesh.positions[3 * i];
        vertices.insert(vertices.end(), {rest[0] / 1000 + 0.1f, rest[1] / 1000 - 0.9f, rest[2] / 1000 - 3});
      }
      pc2.append(vertices);
    }
    return {out, folder_ / "truth", (folder_ / "other.glb").string(), "", {}};
  }

  static inline std::filesystem::path folder_;
  static inline Actor actor_;
  static inline Camera camera_;
  static inline std::vector<float> truth_;  // glTF frame, m
};

}  // namespace livecap::test

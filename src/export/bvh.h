// Motion as BVH: the skeleton at zero angles (T-pose), metric root translation, one ZXY rotation per bone and frame,
// in the glTF frame (Y up). Readers: Blender, MotionBuilder, every mocap tool.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "actor/actor.h"

namespace livecap {

// Angles in degrees of rotation = Rz(z) Rx(x) Ry(y), as {z, x, y}: of the two solutions and their full turns the one
// nearest to `previous_deg`, so that curves do not jump.
Eigen::Vector3d zxy_from_rotation(const Eigen::Matrix3d& rotation,
                                  const Eigen::Vector3d& previous_deg = Eigen::Vector3d::Zero());

// Valid after every frame.
class BvhWriter {
 public:
  // unit_m: length of one BVH unit in metres (0.01: centimetres). Throws ConfigError when fps or unit_m is not
  // positive, IoError when the file cannot be written. End sites are the wrists, toes and the top of the head.
  BvhWriter(const std::filesystem::path& path, const Actor& actor, double fps, double unit_m = 0.01);

  // camera_from_root pose in millimetres, as everywhere in the library.
  void append(const Pose& pose);
  // A frame without a result of its own repeats the last one (the T-pose at the origin before the first).
  void append_held();

  int n_frames() const { return n_frames_; }

 private:
  void write_row(const std::string& row);

  std::filesystem::path path_;
  std::fstream file_;
  Skeleton skeleton_;
  double unit_m_;
  std::vector<int> order_;                     // bones in hierarchy (depth first) order
  std::vector<Eigen::Vector3d> previous_deg_;  // per bone
  std::string last_row_;
  std::streampos count_position_;
  int n_frames_ = 0;
};

// All frames at once.
void write_bvh(const std::filesystem::path& path, const Actor& actor, std::span<const Pose> poses, double fps,
               double unit_m = 0.01);

}  // namespace livecap

// Movements as smooth joint-angle curves within human limits, feet on the floor.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "synth/body_shape.h"
#include "synth/rig.h"

namespace livecap::synth {

// Anatomical angles of one limb pair, rad. Zero is standing with hanging arms.
struct ArmAngles {
  double abduction = 0;  // sideways away from the body; pi/2 is the T-pose
  double flexion = 0;    // forwards
  double twist = 0;      // about the upper arm, positive turns a bent forearm upwards when the arm is raised sideways
  double elbow = 0;
  double raise = 0;  // of the shoulder girdle
};
struct LegAngles {
  double flexion = 0;    // thigh forwards
  double abduction = 0;  // thigh sideways
  double turn = 0;       // knee outwards
  double knee = 0;
  double ankle = 0;  // toes up
};

struct Posture {
  double x_mm = 0, z_mm = 0, jump_mm = 0;           // of the hips; jump = height of the lower foot above the floor
  double yaw = 0, lean_forward = 0, lean_left = 0;  // of the hips
  double bend = 0, twist = 0, side = 0;             // of the spine: forwards, to the left, towards the left
  double nod = 0, look_left = 0, tilt_left = 0;     // of the head
  std::array<ArmAngles, 2> arms;                    // left, right
  std::array<LegAngles, 2> legs;
};

// The postures of the named motions played one after the other, each starting and ending at rest. At least one.
// crouch_rad: how far forwards thighs point at rest, knees bent by twice that, feet flat; added to what legs do.
// Throws ConfigError for an unknown name.
std::vector<Posture> make_motion(const std::vector<std::string>& names, double fps, double crouch_rad = 0);

// Bones of a posture with the lower foot on the floor (y = 0), room frame. joints, scale: see ActorModel.
BonePose pose_of(const Posture& posture, const std::array<Vec3, kBoneCount>& joints, double scale);

}  // namespace livecap::synth

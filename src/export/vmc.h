// The skeleton over a network, frame by frame, in the Virtual Motion Capture protocol (https://protocol.vmc.info): OSC
// messages that avatar programs, Unity, Unreal and Blender listen to through their VMC receivers. Rotations are those
// of a normalised humanoid (T-pose), so that any avatar can wear them. The surface does not travel.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "livecap/camera.h"
#include "livecap/live.h"

namespace livecap {

// Unity's HumanBodyBones name of a bone of LiveCap-32 ("left_elbow": "LeftLowerArm"); empty: it has none.
std::string_view vmc_bone_name(std::string_view bone);

class VmcEncoder {
 public:
  // floor: where the camera stands over it, if known: up is away from it, and it is y = 0. Otherwise the camera is
  // taken to be level, and the lowest point of the first tracked person stands on y = 0.
  VmcEncoder(const LiveActor& actor, const std::optional<FloorPlane>& floor);

  // One OSC bundle, a UDP packet: whether somebody is tracked, the time, and then, metres, Unity's axes (left-handed, y
  // up), every bone's place and rotation in its parent's frame. Spine and UpperChest, which have no bone here, do not
  // turn; neck and shoulders hang on the latter. Where the first tracked person stood is the middle.
  std::vector<uint8_t> packet(const LiveResult& result);

 private:
  struct Bone {
    std::string name;  // VMC's
    int index;         // -1: turns with its parent
    std::array<float, 3> offset_m;
  };
  std::vector<Bone> bones_;
  std::array<float, 4> level_ = {0, 0, 0, 1};  // x, y, z, w: from glTF axes to such with y away from the floor
  std::optional<float> floor_y_m_;
  std::optional<std::array<float, 3>> middle_m_;
};

}  // namespace livecap

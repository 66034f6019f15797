// The built-in people as one implicit solid: limbs, head, clothes as signed distances melted together.
//
// All numbers are for a person of 1700 mm: mm, +X the subject's left, Y up from the sole, +Z front, A-pose with the
// arms 30 degrees below horizontal. The body is mirror symmetric.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "synth/distance_shapes.h"

namespace livecap::synth {

enum Bone : int {
  kHips,
  kSpine,
  kSpine1,
  kSpine2,
  kNeck,
  kHead,
  kLeftShoulder,
  kLeftArm,
  kLeftForeArm,
  kLeftHand,
  kLeftUpLeg,
  kLeftLeg,
  kLeftFoot,
  kLeftToeBase,
  kRightShoulder,
  kRightArm,
  kRightForeArm,
  kRightHand,
  kRightUpLeg,
  kRightLeg,
  kRightFoot,
  kRightToeBase,
  kBoneCount
};

struct BoneInfo {
  const char* name;  // Mixamo, without prefix
  int parent;        // -1 for the root; parents come first
};

extern const std::array<BoneInfo, kBoneCount> kBones;

inline constexpr double kArmRestDeg = 30;  // below horizontal

// What a point of the surface belongs to.
enum Part : int {
  kHairPart,
  kFacePart,
  kNeckPart,
  kTopPart,
  kArmPart,
  kHandPart,
  kBottomPart,
  kLegPart,
  kShoePart,
  kPartCount
};

enum class Outfit { kSkirt, kTrousers };

// Horizontal half axes of a trunk or garment at one height.
struct Ring {
  double y, half_width, half_depth, center_z;
};

class BodyShape {
 public:
  explicit BodyShape(Outfit outfit);

  Outfit outfit() const { return outfit_; }
  const std::array<Vec3, kBoneCount>& joints() const { return joints_; }

  // Distance to the whole surface, negative inside; never grows faster than about the true distance.
  double distance(const Vec3& p) const;
  Vec3 gradient(const Vec3& p) const;  // unit, outwards

  Part part(const Vec3& p) const;
  // LIP id of a part at p (sides by the sign of x).
  int label(Part part, const Vec3& p) const;

  // Lowest and highest points of the garment on the hips.
  double bottom_hem_y() const;
  double bottom_waist_y() const;
  double sleeve_length() const;  // from the shoulder joint

 private:
  std::array<double, kPartCount> part_distances(const Vec3& p) const;
  void head_distances(const Vec3& p, std::array<double, kPartCount>& d) const;
  void arm_distances(const Vec3& p, std::array<double, kPartCount>& d) const;
  void leg_distances(const Vec3& p, std::array<double, kPartCount>& d) const;

  Outfit outfit_;
  std::array<Vec3, kBoneCount> joints_;
  std::vector<Ring> trunk_;    // of the top
  std::vector<Ring> garment_;  // skirt, or the seat of the trousers
};

// "skirt" or "trousers". Throws ConfigError.
Outfit outfit_from_name(const std::string& name);

}  // namespace livecap::synth

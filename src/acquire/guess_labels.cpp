// guess_labels of material_labels.h.
#include <algorithm>
#include <array>
#include <cmath>

#include "acquire/leg_line.h"
#include "acquire/material_labels.h"
#include "acquire/spread_labels.h"
#include "actor/labels.h"
#include "base/median.h"
#include "base/srgb.h"
#include "meshing/surface_parts.h"

namespace livecap::acquire {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// CIE L*a*b* of an sRGB colour, D65, divided by 100.
Vector3d lab(const Vector3d& srgb) {
  Vector3d linear;
  for (int k = 0; k < 3; ++k) linear[k] = linear_from_srgb(srgb[k]);
  Matrix3d to_xyz;
  to_xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  Vector3d f = to_xyz * linear;
  const Vector3d white(0.9505, 1.0, 1.089);
  for (int k = 0; k < 3; ++k) {
    const double t = f[k] / white[k];
    f[k] = t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116;
  }
  return {1.16 * f[1] - 0.16, 5 * (f[0] - f[1]), 2 * (f[1] - f[2])};
}

class Guess {
 public:
  explicit Guess(const GuessInput& input) : in_(input), n_(input.surface.vertices.size()) {
    for (const Vector3d& c : input.colors) lab_.push_back(lab(c));
    neighbors_ = meshing::neighbors_of(input.surface);
    height_ = 0;
    for (const Vector3d& p : input.surface.vertices) height_ = std::max(height_, p.y());
  }

  std::vector<uint8_t> run() {
    find_skin();
    if (std::count(skin_.begin(), skin_.end(), 1) == 0) bare_by_body_part();
    const double waist = waist_level();
    const bool skirt = thighs_are_covered();
    std::vector<uint8_t> labels(n_);
    for (size_t i = 0; i < n_; ++i) labels[i] = label(i, waist, skirt);
    labels = smoothed(labels);
    if (!in_.seen.empty()) spread_labels(in_.surface, in_.seen, labels);
    return labels;
  }

 private:
  int bone(size_t i) const { return in_.weights[i][0].bone; }
  const Vector3d& point(size_t i) const { return in_.surface.vertices[i]; }

  // Skin is what has the colour of the face, more or less bright; 1 where it is.
  void find_skin() {
    skin_.assign(n_, 0);
    if (in_.nose_vertex < 0) return;
    const Vector3d nose = point(in_.nose_vertex);
    std::array<std::vector<double>, 3> face;
    for (size_t i = 0; i < n_; ++i)
      if ((point(i) - nose).norm() < 0.035 * height_)
        for (int k = 0; k < 3; ++k) face[k].push_back(lab_[i][k]);
    if (face[0].size() < 5) return;
    Vector3d middle;
    for (int k = 0; k < 3; ++k) middle[k] = median(face[k]);
    // Shadow moves lightness far and chroma in proportion to it.
    for (size_t i = 0; i < n_; ++i) {
      const double bright = std::clamp(lab_[i][0] / std::max(middle[0], 0.05), 0.3, 1.5);
      const double chroma = std::hypot(lab_[i][1] - bright * middle[1], lab_[i][2] - bright * middle[2]);
      skin_[i] = chroma < 0.075 && lab_[i][0] > 0.55 * middle[0] && lab_[i][0] < 1.45 * middle[0];
    }
    // A body without colour is all face.
    if (std::count(skin_.begin(), skin_.end(), 1) > 0.85 * n_) skin_.assign(n_, 0);
    // Patterns have a thread of any colour: the neighbours decide.
    for (int round = 0; round < 3; ++round) {
      std::vector<char> next = skin_;
      for (size_t i = 0; i < n_; ++i) {
        int votes = skin_[i] ? 1 : -1;
        for (int other : neighbors_[i]) votes += skin_[other] ? 1 : -1;
        next[i] = votes > 0;
      }
      skin_.swap(next);
    }
  }

  // Nothing known of colours: the face and the hands are bare.
  void bare_by_body_part() {
    const Vector3d& head = in_.joints[kHeadBone];
    for (size_t i = 0; i < n_; ++i) {
      const int b = bone(i);
      const bool hand = b == kLeftHandBone || b == kLeftKnuckleBone || b == kRightHandBone || b == kRightKnuckleBone;
      const bool face = b == kHeadBone && point(i).z() > head.z() + 0.01 * height_ && point(i).y() < 0.95 * height_;
      skin_[i] = hand || face;
    }
  }

  // The height between hips and chest where the colours of the trunk above and below differ most.
  double waist_level() const {
    const double hips = (in_.joints[kLeftUpLegBone].y() + in_.joints[kRightUpLegBone].y()) / 2;
    const double neck = in_.joints[kNeckBone].y();
    const double low = hips - 0.06 * height_, high = hips + 0.55 * (neck - hips), window = 0.07 * height_;
    double best = hips + 0.25 * (neck - hips), best_difference = 0;
    for (double level = low; level <= high; level += 0.006 * height_) {
      constexpr int kBins = 5;
      std::array<std::array<double, kBins * kBins * kBins>, 2> histogram{};
      std::array<double, 2> count{};
      for (size_t i = 0; i < n_; ++i) {
        const double above = point(i).y() - level;
        if (std::abs(above) > window || arm(bone(i)) || skin_[i]) continue;
        const int l = bin(lab_[i][0], 0, 1), a = bin(lab_[i][1], -0.5, 0.5), b = bin(lab_[i][2], -0.5, 0.5);
        histogram[above > 0][(l * kBins + a) * kBins + b] += 1;
        count[above > 0] += 1;
      }
      if (count[0] < 20 || count[1] < 20) continue;
      double difference = 0;
      for (size_t k = 0; k < histogram[0].size(); ++k)
        difference += std::abs(histogram[0][k] / count[0] - histogram[1][k] / count[1]) / 2;
      if (difference > best_difference) best_difference = difference, best = level;
    }
    return best;
  }

  static int bin(double x, double low, double high) {
    return std::clamp(static_cast<int>(5 * (x - low) / (high - low)), 0, 4);
  }

  // A skirt fills the space between the thighs.
  bool thighs_are_covered() const {
    int covered = 0;
    for (double share : {0.35, 0.5, 0.65}) {
      const Vector3d left =
          in_.joints[kLeftUpLegBone] + share * (in_.joints[kLeftLegBone] - in_.joints[kLeftUpLegBone]);
      const Vector3d right =
          in_.joints[kRightUpLegBone] + share * (in_.joints[kRightLegBone] - in_.joints[kRightUpLegBone]);
      covered += in_.volume.at((left + right) / 2) < 0;
    }
    return covered >= 2;
  }

  static bool arm(int bone) {
    return (bone >= kLeftArmBone && bone <= kLeftKnuckleBone) || (bone >= kRightArmBone && bone <= kRightKnuckleBone);
  }

  bool in_cloth_of_both(double y) const {
    return around_both_legs(leg_line(in_.joints, kLeftUpLegBone), leg_line(in_.joints, kRightUpLegBone), in_.volume, y,
                            0);
  }

  // A thigh below a skirt, or in it, not its cloth: that hangs off the leg.
  bool is_flesh(size_t i, int leg_bone) const {
    const int thigh = leg_bone < kRightUpLegBone ? kLeftUpLegBone : kRightUpLegBone;
    return leg_line(in_.joints, thigh).gap_to(point(i)) < 0.01 * height_;
  }

  uint8_t label(size_t i, double waist, bool skirt) const {
    const int b = bone(i);
    if (b == kHeadBone || b == kNeckBone) {
      if (skin_[i]) return lip::kFace;
      // Collar or hair: hair is above the chin.
      return point(i).y() > in_.joints[kHeadBone].y() ? lip::kHair : b == kHeadBone ? lip::kFace : lip::kUpperClothes;
    }
    if (arm(b)) return skin_[i] ? (b < kRightClavicleBone ? lip::kLeftArm : lip::kRightArm) : lip::kUpperClothes;
    if (b >= kLeftUpLegBone) {
      const int joint = (b - kLeftUpLegBone) % 4;  // 0 thigh, 1 shank, 2 foot, 3 toes
      const bool left_leg = b < kRightUpLegBone;
      if (joint >= 2 && point(i).y() < in_.joints[left_leg ? kLeftFootBone : kRightFootBone].y() + 0.005 * height_)
        return left_leg ? lip::kLeftShoe : lip::kRightShoe;
      if (skin_[i] && joint >= 1) return left_leg ? lip::kLeftLeg : lip::kRightLeg;
      // A heel may follow the shank; what is no skin far below a skirt is a shoe.
      const Vector3d &knee = in_.joints[left_leg ? kLeftLegBone : kRightLegBone],
                     &ankle = in_.joints[left_leg ? kLeftFootBone : kRightFootBone];
      const double level = skirt ? 0.4 * knee.y() + 0.6 * ankle.y() : ankle.y() - 0.012 * height_;
      if (joint >= 1 && !skin_[i] && point(i).y() < level) return left_leg ? lip::kLeftShoe : lip::kRightShoe;
      if (joint >= 2 && !skin_[i]) return skirt ? (left_leg ? lip::kLeftShoe : lip::kRightShoe) : lip::kPants;
      const bool flesh = is_flesh(i, b);
      if (skin_[i] && (!skirt || flesh)) return left_leg ? lip::kLeftLeg : lip::kRightLeg;
      if (skirt && flesh && !in_cloth_of_both(point(i).y())) return lip::kPants;  // tights
    }
    if (point(i).y() < waist) return skirt ? lip::kSkirt : lip::kPants;
    // Bare shoulders and neckline belong to the face's class, as the neck does.
    if (skin_[i] && point(i).y() > in_.joints[kNeckBone].y() - 0.05 * height_) return lip::kFace;
    return lip::kUpperClothes;
  }

  std::vector<uint8_t> smoothed(std::vector<uint8_t> labels) const {
    for (int round = 0; round < 2; ++round) {
      std::vector<uint8_t> next = labels;
      for (size_t i = 0; i < n_; ++i) {
        std::array<int, 20> votes{};
        votes[labels[i]] += 2;
        for (int other : neighbors_[i]) ++votes[labels[other]];
        next[i] = static_cast<uint8_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
      }
      labels.swap(next);
    }
    return labels;
  }

  const GuessInput& in_;
  size_t n_;
  std::vector<Vector3d> lab_;
  std::vector<std::vector<int>> neighbors_;
  std::vector<char> skin_;
  double height_;
};

}  // namespace

std::vector<uint8_t> guess_labels(const GuessInput& input) {
  return Guess(input).run();
}

}  // namespace livecap::acquire

#include "export/bvh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/number_text.h"
#include "base/text.h"
#include "export/export_frame.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr int kCountWidth = 10;

// What ends a leaf bone.
int end_keypoint(const Actor& actor, int bone) {
  for (int k : {kHeadTop, kLeftWrist, kRightWrist, kLeftToe, kRightToe}) {
    if (actor.keypoints[k].bone == bone) return k;
  }
  return -1;
}

// Each behind a space.
std::string numbers_text(const Eigen::Vector3d& values) {
  std::string text;
  for (double value : values) text.append(" ").append(fixed_text(value, 8));
  return text;
}

class HierarchyText {
 public:
  HierarchyText(const Actor& actor, double units_per_mm, std::vector<int>& order)
      : actor_(actor), scale_(units_per_mm), order_(order) {
    rest_ = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
    joint(0, 0);
  }
  std::string text = "HIERARCHY\n";

 private:
  void line(int depth, const std::string& s) { text += std::string(2 * depth, ' ') + s + "\n"; }
  std::string offset(const Eigen::Vector3d& mm) const { return "OFFSET" + numbers_text(scale_ * mm); }

  void joint(int b, int depth) {
    const Bone& bone = actor_.skeleton.bones[b];
    order_.push_back(b);
    line(depth, (b == 0 ? "ROOT " : "JOINT ") + bone.name);
    line(depth, "{");
    line(depth + 1, offset(b == 0 ? Eigen::Vector3d::Zero().eval() : bone.offset_mm));
    line(depth + 1, b == 0 ? "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"
                           : "CHANNELS 3 Zrotation Xrotation Yrotation");
    bool leaf = true;
    for (int child = b + 1; child < actor_.skeleton.n_bones(); ++child) {
      if (actor_.skeleton.bones[child].parent != b) continue;
      joint(child, depth + 1);
      leaf = false;
    }
    if (leaf) {
      const int k = end_keypoint(actor_, b);
      const Eigen::Vector3d tip = k < 0 ? Eigen::Vector3d(0, 100, 0)
                                        : rest_.camera_from_bone[b].inverse() * actor_.keypoints[k].rest_position_mm;
      line(depth + 1, "End Site");
      line(depth + 1, "{");
      line(depth + 2, offset(tip));
      line(depth + 1, "}");
    }
    line(depth, "}");
  }

  const Actor& actor_;
  double scale_;
  std::vector<int>& order_;
  PosedSkeleton rest_;
};

}  // namespace

Eigen::Vector3d zxy_from_rotation(const Eigen::Matrix3d& r, const Eigen::Vector3d& previous_deg) {
  constexpr double kDegPerRad = 180 / std::numbers::pi;
  const double cos_x = std::hypot(r(0, 1), r(1, 1));
  Eigen::Vector3d zxy;
  zxy[1] = std::atan2(r(2, 1), cos_x) * kDegPerRad;
  if (cos_x > 1e-9) {
    zxy[0] = std::atan2(-r(0, 1), r(1, 1)) * kDegPerRad;
    zxy[2] = std::atan2(-r(2, 0), r(2, 2)) * kDegPerRad;
  } else {  // x = +-90: z and y turn about one axis; keep the previous y
    zxy[2] = previous_deg[2];
    const double sum = std::atan2(r(1, 0), r(0, 0)) * kDegPerRad;
    zxy[0] = r(2, 1) > 0 ? sum - zxy[2] : sum + zxy[2];
  }
  const Eigen::Vector3d other(zxy[0] + 180, 180 - zxy[1], zxy[2] + 180);
  auto near_previous = [&](Eigen::Vector3d angles) {
    for (int k = 0; k < 3; ++k) angles[k] += 360 * std::round((previous_deg[k] - angles[k]) / 360);
    return angles;
  };
  const Eigen::Vector3d a = near_previous(zxy), b = near_previous(other);
  return (a - previous_deg).squaredNorm() <= (b - previous_deg).squaredNorm() ? a : b;
}

BvhWriter::BvhWriter(const std::filesystem::path& path, const Actor& actor, double fps, double unit_m)
    : path_(path), skeleton_(actor.skeleton), unit_m_(unit_m) {
  if (!(fps > 0) || !(unit_m > 0)) throw ConfigError(format("BVH: fps %g and unit %g m must be positive", fps, unit_m));
  previous_deg_.assign(skeleton_.n_bones(), Eigen::Vector3d::Zero());
  std::string text = HierarchyText(actor, kMetresPerMm / unit_m, order_).text;
  text += "MOTION\nFrames: ";
  count_position_ = static_cast<std::streamoff>(text.size());
  text += format("%*d\nFrame Time: ", kCountWidth, 0) + fixed_text(1 / fps, 9) + "\n";
  file_.open(path, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
  file_ << text << std::flush;
  if (!file_) throw IoError(path.string() + ": cannot be written");
}

void BvhWriter::append(const Pose& pose) {
  const PosedSkeleton posed = forward_kinematics(skeleton_, pose);
  const Eigen::Vector3d t = gltf_from_camera(posed.camera_from_bone[0].translation()) / unit_m_;
  std::string row = numbers_text(t).substr(1);
  for (int b : order_) {
    const Eigen::Matrix3d world = posed.camera_from_bone[b].linear();
    const Eigen::Matrix3d local =
        b == 0 ? Eigen::Matrix3d(gltf_axes_from_camera() * world)
               : Eigen::Matrix3d(posed.camera_from_bone[skeleton_.bones[b].parent].linear().transpose() * world);
    previous_deg_[b] = zxy_from_rotation(local, previous_deg_[b]);
    row += numbers_text(previous_deg_[b]);
  }
  write_row(row + "\n");
}

void BvhWriter::append_held() {
  if (last_row_.empty()) {
    last_row_ = "0 0 0";
    for (size_t i = 0; i < order_.size(); ++i) last_row_ += " 0 0 0";
    last_row_ += "\n";
  }
  write_row(std::string(last_row_));
}

void BvhWriter::write_row(const std::string& row) {
  file_.seekp(0, std::ios::end);
  file_ << row << std::flush;
  ++n_frames_;
  file_.seekp(count_position_);
  file_ << format("%*d", kCountWidth, n_frames_) << std::flush;
  if (!file_) throw IoError(path_.string() + format(": frame %d cannot be written, is the disk full?", n_frames_));
  last_row_ = row;
}

void write_bvh(const std::filesystem::path& path, const Actor& actor, std::span<const Pose> poses, double fps,
               double unit_m) {
  BvhWriter writer(path, actor, fps, unit_m);
  for (const Pose& pose : poses) writer.append(pose);
}

}  // namespace livecap

#include "report/turnaround_strip.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "actor/posed_vertices.h"
#include "picture/color_scale.h"
#include "picture/overlay.h"
#include "picture/side_by_side.h"

namespace livecap {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kStripWidth = 300, kStripHeight = 380;

Vector3f bone_color(int bone) {
  const Rgb color = hue_color(0.381966 * bone, bone % 2 ? 1.0 : 0.75);
  return Vector3f::Map(color.data()) / 255;
}

struct Stage {
  Camera camera = camera_from_fov(kStripWidth, kStripHeight, 36);
  Eigen::Isometry3d camera_from_rest;
};

// Looks at the middle of the actor from `turn` around the vertical, 0 = from the front.
Stage make_stage(const Actor& actor, double turn) {
  float low = 1e9f, high = -1e9f;
  for (size_t i = 1; i < actor.mesh.positions.size(); i += 3) {
    low = std::min(low, actor.mesh.positions[i]);
    high = std::max(high, actor.mesh.positions[i]);
  }
  const double height = high - low, distance = 1.75 * height;
  Stage stage;
  Eigen::Matrix3d flip = Vector3d(1, -1, -1).asDiagonal();
  stage.camera_from_rest = Eigen::Isometry3d::Identity();
  stage.camera_from_rest.linear() = flip * Eigen::AngleAxisd(-turn, Vector3d::UnitY()).toRotationMatrix();
  stage.camera_from_rest.translation() =
      Vector3d(0, 0, distance) - stage.camera_from_rest.linear() * Vector3d(0, (low + high) / 2, 0);
  return stage;
}

ImageRgb draw(const Actor& actor, const std::vector<float>& positions, const Stage& stage, bool texture) {
  std::vector<float> moved(positions.size());
  for (size_t i = 0; i < positions.size(); i += 3) {
    const Vector3d p = stage.camera_from_rest * Vector3d(positions[i], positions[i + 1], positions[i + 2]);
    for (int k = 0; k < 3; ++k) moved[i + k] = static_cast<float>(p[k]);
  }
  ImageRgb empty{kStripWidth, kStripHeight, std::vector<uint8_t>(size_t(3) * kStripWidth * kStripHeight, 245)};
  OverlayOptions options;
  options.alpha = 1;
  options.texture = texture;
  return render_overlay(actor, moved, stage.camera, empty, options);
}

void draw_bones(const Actor& actor, const Stage& stage, ImageRgb& image) {
  cv::Mat canvas(image.height, image.width, CV_8UC3, image.pixels.data());
  const PosedSkeleton rest = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
  const auto pixel = [&](const Vector3d& p) {
    const Vector3d q = stage.camera_from_rest * p;
    return cv::Point2d(stage.camera.fx * q.x() / q.z() + stage.camera.cx,
                       stage.camera.fy * q.y() / q.z() + stage.camera.cy);
  };
  const auto line = [&](const Vector3d& a, const Vector3d& b) {
    cv::line(canvas, pixel(a), pixel(b), {255, 40, 40}, 1, cv::LINE_AA);
    cv::circle(canvas, pixel(b), 3, {30, 60, 255}, cv::FILLED, cv::LINE_AA);
  };
  for (int bone = 1; bone < actor.skeleton.n_bones(); ++bone)
    line(rest.camera_from_bone[actor.skeleton.bones[bone].parent].translation(),
         rest.camera_from_bone[bone].translation());
  for (const auto& [keypoint, bone] : {std::pair{kLeftWrist, "left_elbow"},
                                       {kRightWrist, "right_elbow"},
                                       {kLeftToe, "left_ankle"},
                                       {kRightToe, "right_ankle"}})
    if (const int from = actor.skeleton.bone_index(bone); from >= 0)
      line(rest.camera_from_bone[from].translation(), actor.keypoints[keypoint].rest_position_mm);
  for (int k : {kLeftEye, kRightEye, kNose, kChin})
    cv::circle(canvas, pixel(actor.keypoints[k].rest_position_mm), 2, {20, 160, 20}, cv::FILLED, cv::LINE_AA);
}

}  // namespace

ImageRgb turnaround_strip(const Actor& actor, StripColor color, int n_views, bool with_bones) {
  Actor shown = actor;
  if (color == StripColor::kLabels || color == StripColor::kWeights) {
    shown.texture = {};
    shown.colors.assign(actor.mesh.positions.size(), 0);
    for (int i = 0; i < actor.n_vertices(); ++i) {
      Vector3f c = Vector3f::Zero();
      if (color == StripColor::kLabels) {
        c = Vector3f::Map(label_color(actor.labels[i]).data()) / 255;
      } else {
        for (int k = 0; k < kMaxInfluences; ++k)
          c += actor.skin.weights[4 * i + k] * bone_color(actor.skin.bones[4 * i + k]);
      }
      for (int k = 0; k < 3; ++k) shown.colors[3 * i + k] = c[k];
    }
  }
  std::vector<ImageRgb> images;
  for (int i = 0; i < n_views; ++i) {
    const Stage stage = make_stage(actor, 2 * M_PI * i / n_views);
    images.push_back(draw(shown, actor.mesh.positions, stage, color != StripColor::kShape));
    if (with_bones) draw_bones(actor, stage, images.back());
  }
  return side_by_side(images);
}

ImageRgb painted_strip(const Actor& actor, const std::vector<float>& colors) {
  constexpr int kViews = 6;
  Actor shown = actor;
  shown.texture = {};
  shown.colors = colors;
  std::vector<ImageRgb> images;
  Stage stage;
  for (int i = 0; i < kViews; ++i) {
    stage = make_stage(actor, 2 * M_PI * i / kViews);
    images.push_back(draw(shown, actor.mesh.positions, stage, true));
  }
  // From below, where hanging cloth is open: the person turned by a quarter, head away.
  stage = make_stage(actor, 0);
  const double distance = stage.camera_from_rest.translation().z();
  stage.camera_from_rest.linear() << 1, 0, 0, 0, 0, 1, 0, 1, 0;
  stage.camera_from_rest.linear().row(0) *= -1;
  stage.camera_from_rest.translation() = Vector3d(0, 0, distance);
  images.push_back(draw(shown, actor.mesh.positions, stage, true));
  return side_by_side(images);
}

ImageRgb pose_strip(const Actor& actor, const std::vector<Eigen::VectorXd>& poses) {
  std::vector<ImageRgb> images;
  for (const Eigen::VectorXd& angles : poses) {
    Pose pose = rest_pose(actor.skeleton);
    pose.angles_rad = angles;
    const std::vector<float> positions =
        posed_vertices(actor, bone_dual_quats(forward_kinematics(actor.skeleton, pose)));
    images.push_back(draw(actor, positions, make_stage(actor, 0.4), true));
  }
  return side_by_side(images);
}

}  // namespace livecap

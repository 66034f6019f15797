#include "render/bone_lines.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "eval/sequence_files.h"
#include "picture/overlay.h"
#include "pose/targets.h"

namespace livecap::render {
namespace {

constexpr double kThicknessShare = 1 / 260.0;  // of the picture's height
constexpr int kFractionBits = 4;               // of a pixel, in what OpenCV is given

cv::Scalar side_color(const std::string& name) {
  if (name.rfind("left_", 0) == 0) return {255, 120, 30};
  if (name.rfind("right_", 0) == 0) return {40, 120, 255};
  return {70, 200, 90};
}

}  // namespace

std::vector<std::pair<int, int>> bone_lines(const Skeleton& skeleton, const std::vector<std::string>& names) {
  std::vector<std::pair<int, int>> lines;
  const auto add = [&](const std::string& from, const std::string& to) {
    const int a = index_of(names, from), b = index_of(names, to);
    if (a >= 0 && b >= 0) lines.emplace_back(a, b);
  };
  for (const Bone& bone : skeleton.bones) {
    int parent = bone.parent;  // nearest one with a joint
    while (parent >= 0 && index_of(names, skeleton.bones[parent].name) < 0) parent = skeleton.bones[parent].parent;
    if (parent >= 0) add(skeleton.bones[parent].name, bone.name);
  }
  add("neck", "head_top");
  for (const std::string side : {"left_", "right_"}) {
    add(side + "elbow", side + "wrist");
    add(side + "wrist", side + "hand");
    add(side + "ankle", side + "toe");
  }
  return lines;
}

void draw_bones(const std::vector<std::pair<int, int>>& lines, const std::vector<std::string>& names,
                std::span<const Eigen::Vector3d> joints_mm, const Viewpoint& view, ImageRgb& canvas) {
  cv::Mat picture(canvas.height, canvas.width, CV_8UC3, canvas.pixels.data());
  const auto place = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector2d px = (1 << kFractionBits) * project_px(view.camera, p);
    return cv::Point(static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y())));
  };
  const int thickness = std::max(1, static_cast<int>(std::lround(kThicknessShare * canvas.height)));
  for (const bool outline : {true, false}) {
    for (const auto& [from, to] : lines) {
      const Eigen::Vector3d a = view.view_from_camera * joints_mm[from], b = view.view_from_camera * joints_mm[to];
      if (!(a.z() > kMinDepthMm && b.z() > kMinDepthMm)) continue;
      const cv::Scalar color = outline ? cv::Scalar(20, 20, 20) : side_color(names[to]);
      const int width = outline ? thickness + 2 : thickness;
      cv::line(picture, place(a), place(b), color, width, cv::LINE_AA, kFractionBits);
      cv::circle(picture, place(b), width << kFractionBits, color, cv::FILLED, cv::LINE_AA, kFractionBits);
    }
  }
}

}  // namespace livecap::render

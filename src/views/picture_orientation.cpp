#include "views/picture_orientation.h"

namespace livecap {

ViewPose turned(const ViewPose& view, int quarter_turns) {
  ViewPose result = view;
  for (int i = 0; i < quarter_turns; ++i) {
    // Pixel (u, v) goes to (height - 1 - v, u), so the camera's axes turn: x' = -y, y' = x.
    const Camera from = result.camera;
    Camera& to = result.camera;
    to.width = from.height, to.height = from.width;
    to.fx = from.fy, to.fy = from.fx;
    to.cx = from.height - 1 - from.cy, to.cy = from.cx;
    // (p2, p1) is a direction in the picture and turns with it.
    to.distortion[3] = -from.distortion[2];  // p2' = -p1
    to.distortion[2] = from.distortion[3];   // p1' = p2
    Eigen::Matrix3d turn;
    turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    result.camera_from_world = Eigen::Isometry3d(turn) * result.camera_from_world;
  }
  return result;
}

}  // namespace livecap

// Full perspective projection pi and its derivative. Camera frame: x right, y down, z forward, mm; pixels have their
// centres at integers. Images are undistorted before anything is projected.
#ifndef LC_SHARED_CAMERA_H
#define LC_SHARED_CAMERA_H
#include "shared/vec.h"

typedef struct {
  REAL fx, fy, cx, cy;  // px
} Pinhole;

// Points nearer than this are not projected.
#define LC_MIN_DEPTH_MM LC_LIT(100.0)

// Projection of one point; J[i][j] = d(uv_i)/d(p_j), px per mm.
typedef struct {
  Vec2 uv;
  REAL J[2][3];
} Projection;

LC_FN Projection project_point(Vec3 p, Pinhole cam) {
  Projection out;
  REAL inv_z = LC_LIT(1.0) / p.z;
  REAL xn = p.x * inv_z;
  REAL yn = p.y * inv_z;
  out.uv.x = cam.fx * xn + cam.cx;
  out.uv.y = cam.fy * yn + cam.cy;
  out.J[0][0] = cam.fx * inv_z;
  out.J[0][1] = LC_LIT(0.0);
  out.J[0][2] = -cam.fx * xn * inv_z;
  out.J[1][0] = LC_LIT(0.0);
  out.J[1][1] = cam.fy * inv_z;
  out.J[1][2] = -cam.fy * yn * inv_z;
  return out;
}

#endif

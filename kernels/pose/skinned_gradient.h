// The derivative of a skinned vertex by every joint at the price of one. For a covector g at the vertex V = DQS(q, v):
// g . dV/d(angle) is linear in the turning of the bones, so each bone is summed up by a wrench (torque, force) about
// the origin: g . dV = axis . torque + (origin x axis) . force. A joint adds up the wrenches of the bones it moves. The
// same holds for a point fixed to one bone: torque = p x g, force = g.
#ifndef LC_POSE_SKINNED_GRADIENT_H
#define LC_POSE_SKINNED_GRADIENT_H
#include "shared/dual_quat.h"

typedef struct {
  Vec3 torque;
  Vec3 force;
} Wrench;

LC_FN Wrench point_wrench(Vec3 p, Vec3 g) {
  Wrench w;
  w.torque = cross3(p, g);
  w.force = g;
  return w;
}

// c with c . dq = g . dual_quat_transform_derivative(q, dq, v) for every dq. f = dual_quat_transform(q, v).
LC_FN DualQuat dual_quat_transform_gradient(DualQuat q, Vec3 v, Vec3 f, Vec3 g) {
  Vec3 r = vec3(q.rx, q.ry, q.rz);
  Vec3 d = vec3(q.dx, q.dy, q.dz);
  REAL s = LC_LIT(2.0) / (q.rw * q.rw + dot3(r, r));
  REAL gf = dot3(g, f);
  REAL gv = dot3(g, v);
  // From the rotation's numerator, the translation's numerator, and the squared length both are divided by.
  REAL real_w = q.rw * gv + dot3(g, cross3(r, v)) + dot3(g, d) - q.rw * gf;
  Vec3 real = add3(scale3(r, -gv - gf), add3(scale3(g, dot3(r, v)), scale3(v, dot3(r, g))));
  real = add3(real, scale3(cross3(v, g), q.rw));
  real = add3(real, sub3(cross3(d, g), scale3(g, q.dw)));
  Vec3 dual = add3(scale3(g, q.rw), cross3(g, r));
  DualQuat c;
  c.rw = s * real_w;
  c.rx = s * real.x;
  c.ry = s * real.y;
  c.rz = s * real.z;
  c.dw = -s * dot3(g, r);
  c.dx = s * dual.x;
  c.dy = s * dual.y;
  c.dz = s * dual.z;
  return c;
}

// Wrench with axis . torque + (origin x axis) . force = c . dual_quat_turn_derivative(axis, origin, q).
LC_FN Wrench dual_quat_turn_wrench(DualQuat c, DualQuat q) {
  Vec3 cr = vec3(c.rx, c.ry, c.rz);
  Vec3 cd = vec3(c.dx, c.dy, c.dz);
  Vec3 r = vec3(q.rx, q.ry, q.rz);
  Vec3 d = vec3(q.dx, q.dy, q.dz);
  Wrench w;
  w.torque = add3(sub3(scale3(cr, q.rw), scale3(r, c.rw)), cross3(r, cr));
  w.torque = add3(w.torque, add3(sub3(scale3(cd, q.dw), scale3(d, c.dw)), cross3(d, cd)));
  w.force = add3(sub3(scale3(cd, q.rw), scale3(r, c.dw)), cross3(r, cd));
  w.torque = scale3(w.torque, LC_LIT(0.5));
  w.force = scale3(w.force, LC_LIT(0.5));
  return w;
}

#endif

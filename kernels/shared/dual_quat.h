// Dual quaternion skinning (Kavan et al. 2007) and its exact derivative, blend and normalisation included.
// A unit dual quaternion (real w,x,y,z; dual w,x,y,z) is a rigid motion camera_from_rest.
#ifndef LC_SHARED_DUAL_QUAT_H
#define LC_SHARED_DUAL_QUAT_H
#include "shared/vec.h"

typedef struct {
  REAL rw, rx, ry, rz;  // real part: rotation
  REAL dw, dx, dy, dz;  // dual part: half translation times rotation
} DualQuat;

LC_FN DualQuat dual_quat_zero(void) {
  DualQuat q;
  q.rw = q.rx = q.ry = q.rz = LC_LIT(0.0);
  q.dw = q.dx = q.dy = q.dz = LC_LIT(0.0);
  return q;
}

// a + weight * b.
LC_FN DualQuat dual_quat_add_scaled(DualQuat a, DualQuat b, REAL weight) {
  a.rw += weight * b.rw;
  a.rx += weight * b.rx;
  a.ry += weight * b.ry;
  a.rz += weight * b.rz;
  a.dw += weight * b.dw;
  a.dx += weight * b.dx;
  a.dy += weight * b.dy;
  a.dz += weight * b.dz;
  return a;
}

// Dot product of the real parts: negative when q and -q should be exchanged before blending.
LC_FN REAL dual_quat_real_dot(DualQuat a, DualQuat b) {
  return a.rw * b.rw + a.rx * b.rx + a.ry * b.ry + a.rz * b.rz;
}

// Rotates v by the (not necessarily normalised) real part of q.
LC_FN Vec3 dual_quat_rotate(DualQuat q, Vec3 v) {
  Vec3 r = vec3(q.rx, q.ry, q.rz);
  REAL n = q.rw * q.rw + dot3(r, r);
  Vec3 g = add3(scale3(v, q.rw * q.rw - dot3(r, r)),
                add3(scale3(r, LC_LIT(2.0) * dot3(r, v)), scale3(cross3(r, v), LC_LIT(2.0) * q.rw)));
  return scale3(g, LC_LIT(1.0) / n);
}

// The inverse rotation.
LC_FN Vec3 dual_quat_unrotate(DualQuat q, Vec3 v) {
  q.rx = -q.rx;
  q.ry = -q.ry;
  q.rz = -q.rz;
  return dual_quat_rotate(q, v);
}

// Moves point v by q / |q|.
LC_FN Vec3 dual_quat_transform(DualQuat q, Vec3 v) {
  Vec3 r = vec3(q.rx, q.ry, q.rz);
  Vec3 d = vec3(q.dx, q.dy, q.dz);
  REAL n = q.rw * q.rw + dot3(r, r);
  Vec3 t = add3(sub3(scale3(d, q.rw), scale3(r, q.dw)), cross3(r, d));
  return add3(dual_quat_rotate(q, v), scale3(t, LC_LIT(2.0) / n));
}

// Derivative of dual_quat_transform(q, v) along dq, for unnormalised q. f = g / n with n = |q_r|^2 and g quadratic:
// df = (dg - f dn) / n.
LC_FN Vec3 dual_quat_transform_derivative(DualQuat q, DualQuat dq, Vec3 v) {
  Vec3 r = vec3(q.rx, q.ry, q.rz);
  Vec3 dr = vec3(dq.rx, dq.ry, dq.rz);
  Vec3 d = vec3(q.dx, q.dy, q.dz);
  Vec3 dd = vec3(dq.dx, dq.dy, dq.dz);
  REAL n = q.rw * q.rw + dot3(r, r);
  REAL dn = LC_LIT(2.0) * (q.rw * dq.rw + dot3(r, dr));
  // g_rot = (w^2 - r.r) v + 2 r (r.v) + 2 w (r x v)
  Vec3 dg = scale3(v, LC_LIT(2.0) * (q.rw * dq.rw - dot3(r, dr)));
  dg = add3(dg, scale3(dr, LC_LIT(2.0) * dot3(r, v)));
  dg = add3(dg, scale3(r, LC_LIT(2.0) * dot3(dr, v)));
  dg = add3(dg, scale3(cross3(r, v), LC_LIT(2.0) * dq.rw));
  dg = add3(dg, scale3(cross3(dr, v), LC_LIT(2.0) * q.rw));
  // g_trans = 2 (w d - dw r + r x d)
  Vec3 dt = add3(add3(scale3(dd, q.rw), scale3(d, dq.rw)), add3(cross3(dr, d), cross3(r, dd)));
  dt = sub3(dt, add3(scale3(dr, q.dw), scale3(r, dq.dw)));
  dg = add3(dg, scale3(dt, LC_LIT(2.0)));
  Vec3 f = dual_quat_transform(q, v);
  return scale3(sub3(dg, scale3(f, dn)), LC_LIT(1.0) / n);
}

// d(q)/d(angle) of a rigid motion turned about the unit `axis` through `origin` (both camera frame):
// 1/2 (axis + eps origin x axis) q. Linear in q, so it also holds for weighted sums of bones that turn together.
LC_FN DualQuat dual_quat_turn_derivative(Vec3 axis, Vec3 origin, DualQuat q) {
  Vec3 m = cross3(origin, axis);
  Vec3 r = vec3(q.rx, q.ry, q.rz);
  Vec3 d = vec3(q.dx, q.dy, q.dz);
  Vec3 real = add3(scale3(axis, q.rw), cross3(axis, r));
  Vec3 dual = add3(add3(scale3(axis, q.dw), cross3(axis, d)), add3(scale3(m, q.rw), cross3(m, r)));
  DualQuat out;
  out.rw = LC_LIT(-0.5) * dot3(axis, r);
  out.rx = LC_LIT(0.5) * real.x;
  out.ry = LC_LIT(0.5) * real.y;
  out.rz = LC_LIT(0.5) * real.z;
  out.dw = LC_LIT(-0.5) * (dot3(axis, d) + dot3(m, r));
  out.dx = LC_LIT(0.5) * dual.x;
  out.dy = LC_LIT(0.5) * dual.y;
  out.dz = LC_LIT(0.5) * dual.z;
  return out;
}

#endif

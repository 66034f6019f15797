// How far a surface is turned to the camera.
#ifndef LC_MATCH_FACING_H
#define LC_MATCH_FACING_H

// Cosine of normal and view at p; mm, camera frame.
static inline float facing_at(float3 p, float3 normal) {
  return -(p.x * normal.x + p.y * normal.y + p.z * normal.z) / sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
}

// px^2 of the picture that area_mm2 of a surface covers at depth z, mm.
static inline float seen_area_px(float area_mm2, float facing, float focal_px, float z) {
  return area_mm2 * facing * focal_px * focal_px / (z * z);
}

#endif

// What host and device share of the cloth's simulation.
#ifndef LC_CLOTH_LAYOUT_H
#define LC_CLOTH_LAYOUT_H

// Work-items of a work-group; on a GPU less where it is one of many, at most so many where it is alone.
#ifndef LC_CLOTH_GPU_GROUP
#define LC_CLOTH_GPU_GROUP 64
#endif
#define LC_CLOTH_GROUP(is_cpu) ((is_cpu) ? 1 : LC_CLOTH_GPU_GROUP)
#define LC_CLOTH_GROUP_ALONE 512
// Of these as many share a particle on a GPU.
#define LC_CLOTH_PARTS 4
#define LC_CLOTH_LIMBS 6
#define LC_CLOTH_LIMB_SIZE 14
#define LC_CLOTH_TINY 1e-6f  // mm

// Of one small step.
typedef struct {
  float seconds, inverse_seconds;
  float per_second;                 // 1 / seconds of a whole frame
  float spring;                     // 1/s: the pull to the skinned place, times seconds
  float spring_reach;               // mm: from farther away it pulls as from there
  float damped;                     // share of the velocity relative to the skinned place that is lost
  float air;                        // share of the velocity that air leaves
  float falls_x, falls_y, falls_z;  // mm/s: gravity, times seconds
} ClothStep;

// How far cloth goes to its skinned place, which counts by `trusted`, and to the axis, in this frame and the two
// before; a point of the axis, mm; up.
typedef struct {
  float trusted;
  float clings, narrows, clings_1, narrows_1, clings_2, narrows_2;
  float axis_x, axis_y, axis_z;
  float up_x, up_y, up_z;
} DrapeStep;

// With a: to the skinned place, b: to the axis, off: to the match, mm, sums by the matches' weights, px^2: aa, ab, bb,
// a off, b off, off off, the weights; the last is 0.
#define LC_DRAPE_TOLD 8

#endif

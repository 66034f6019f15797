// Sizes and places that the host and the kernels of the pose stage agree on. Read by both compilers.
//
// Unknowns: [rotation vector 3 | t 3 | joint angles n_dofs | t' 3]. J has one row per residual and n_columns columns:
// the unknowns, the residual itself in column n_unknowns, zeros up to a multiple of 16, on GPUs 8.
// Rows: 8 per keypoint (2D 2, 3D 3, temporal 3), two per joint angle (first anatomic of all, then rest), one per point
// of the soles (floor), one per contour vertex, two per match, one per shaded vertex. Positions marked "root-relative"
// are camera-frame vectors from the root's origin t: floats keep more of them.
#ifndef LC_POSE_LAYOUT_H
#define LC_POSE_LAYOUT_H
#include "match/layout.h"

#define LC_POSE_KEYPOINTS 23
#define LC_POSE_ROWS_PER_KEYPOINT 8
#define LC_POSE_POINT_ROWS (LC_POSE_KEYPOINTS * LC_POSE_ROWS_PER_KEYPOINT)
#define LC_POSE_ROW_2D 0
#define LC_POSE_ROW_3D 2
#define LC_POSE_ROW_TEMPORAL 5

// A row before it is spread over the columns, in 32 words: four wrenches (torque xyz, force xyz), their bones (one byte
// each, int), the first column of the extra coefficients (int), the three extra coefficients.
// Those of skinned vertices lie in slices of 16 vertices, word by word; a vertex with two rows has two slices.
#define LC_POSE_RECORD 32
#define LC_POSE_SLICE 16
#define LC_POSE_RECORD_BONES 24
// One that is not there. Bones have lower numbers.
#define LC_POSE_NO_BONE 255
#define LC_POSE_RECORD_EXTRA_COLUMN 25
#define LC_POSE_RECORD_EXTRA 26

// One match: u, v (px), root a, b, c of the distance's weight.
#define LC_POSE_MATCH 5

// One vertex of skin: light 9, brightness, root of the weight.
#define LC_POSE_SHADED 11

// Columns that fill_rows.cl makes at a time, and rows of a work-item on CPUs.
#define LC_POSE_FILL_COLUMNS(is_cpu) ((is_cpu) ? 16 : 8)
#define LC_POSE_FILL_ROWS 16

// Of gauss_newton.cl: rows of a work-group and its work-items.
#define LC_POSE_GROUP_ROWS 32
#define LC_POSE_GROUP 256

// Where a step and the records of its rows lie: gauss_newton.cl keeps them in local memory.
#ifndef LC_POSE_SPACE
#define LC_POSE_SPACE global
#endif

// One keypoint of the frame, in 12 floats: target u, v (px); target x, y, z (mm); square roots of the 2D, 3D and
// temporal weights, 0 = no such row; position in the previous frame (mm); unused.
#define LC_POSE_TARGET 12
#define LC_POSE_TARGET_ROOT_3D 6

typedef struct {
  int n_dofs;
  int n_unknowns;  // n_dofs + 9
  int n_columns;   // n_unknowns + 1, rounded up to a multiple of LC_POSE_FILL_COLUMNS
  int n_bones;
  int n_soles;  // points of the soles
} PoseLayout;

// What the rows of one Gauss-Newton step are filled from, in floats, by the host or by gauss_newton.cl: for every
// column the axis (3 planes) and the moment origin x axis (3 planes); keypoints xyz, root-relative; t'; t; joint
// angles; bone dual quaternions, root-relative; points of the soles xyz, root-relative.
#define LC_POSE_STEP_KEYPOINTS(layout) (6 * (layout).n_columns)
#define LC_POSE_STEP_T_PRIME(layout) (LC_POSE_STEP_KEYPOINTS(layout) + 3 * LC_POSE_KEYPOINTS)
#define LC_POSE_STEP_ROOT(layout) (LC_POSE_STEP_T_PRIME(layout) + 3)
#define LC_POSE_STEP_ANGLES(layout) (LC_POSE_STEP_ROOT(layout) + 3)
#define LC_POSE_STEP_DUAL_QUATS(layout) (LC_POSE_STEP_ANGLES(layout) + (layout).n_dofs)
#define LC_POSE_STEP_SOLES(layout) (LC_POSE_STEP_DUAL_QUATS(layout) + 8 * (layout).n_bones)
#define LC_POSE_STEP_SIZE(layout) (LC_POSE_STEP_SOLES(layout) + 3 * (layout).n_soles)

// What the rows of a frame are made of, one upload: where this says, in words, each thing. Vertices are template vertex
// indices, int. From `counts` on it is chosen by the host or by choose.cl.
typedef struct {
  int start;             // [LC_POSE_STATE_SIZE], doubles: the state
  int choice;            // [LC_POSE_CHOICE_NUMBERS], doubles: what choose.cl chooses by
  int lights;            // [2*LC_POSE_LIGHT] likewise
  int targets;           // [LC_POSE_TARGET*LC_POSE_KEYPOINTS]
  int ground;            // [LC_POSE_GROUND_STANDS + n_soles]
  int soles_before;      // [3*n_soles] camera frame, mm: where they were in the frame before
  int counts;            // [LC_POSE_COUNTS]
  int contour_vertices;  // [n]
  int match_vertices;    // [n]
  int match_targets;     // [LC_POSE_MATCH*n]
  int shaded_vertices;   // [n]
  int shaded_targets;    // [LC_POSE_SHADED*n]
} PoseInputs;

// Vertices of each kind (int); root of the weight of a contour vertex; where choose.cl chose, what the matches fall
// short of perfect ones in weight, and what perfect ones would weigh.
#define LC_POSE_COUNT_CONTOUR 0
#define LC_POSE_COUNT_MATCHES 1
#define LC_POSE_COUNT_SHADED 2
#define LC_POSE_COUNT_CONTOUR_ROOT 3
#define LC_POSE_COUNT_MISSED 4
#define LC_POSE_COUNT_SEEN 5
#define LC_POSE_COUNTS 6

// For choose.cl: its work-items, and the most groups that share a kind.
#define LC_POSE_CHOICE_GROUP 128
#define LC_POSE_CHOICE_MOST_SLICES LC_POSE_CHOICE_GROUP
// What the groups tell each other, 8 bytes each, for each group of a kind: two sums of two numbers of each kind, one of
// each limb.
#define LC_POSE_CHOICE_TOLD (12 + LC_SKIN_LIMBS)
// Numbers: weights of the terms of the three kinds, the lights' deviations, the px^2 of a match of weight 1.
#define LC_POSE_CHOICE_DEVIATIONS 3
#define LC_POSE_CHOICE_MATCH_AREA 5
#define LC_POSE_CHOICE_NUMBERS 6
// Its local memory, in bytes.
#define LC_POSE_CHOICE_LOCAL (16 * LC_POSE_CHOICE_GROUP + 8 * LC_SKIN_LIMBS)
// A light: whether it is known (int), and itself (9) in deviations.
#define LC_POSE_LIGHT 10

typedef struct {
  int n[3];            // vertices to choose from, of each kind: contour, matches, skin
  int most[3];         // to choose
  float limb_area_px;  // a limb that shows so many px^2 or more has weight 1
} PoseChoice;

// The ground: normal xyz, offset (mm), root of the weight (0: none is known), Huber threshold (mm; 0 = quadratic
// everywhere); then for each point of the soles how sure it is to rest there.
#define LC_POSE_GROUND_STANDS 6

// For gauss_newton.cl. The state, in doubles: quaternion x, y, z, w of the root's rotation; t; joint angles; t'.
#define LC_POSE_STATE_ROOT 4
#define LC_POSE_STATE_ANGLES 7
#define LC_POSE_STATE_T_PRIME(layout) (LC_POSE_STATE_ANGLES + (layout).n_dofs)
#define LC_POSE_STATE_SIZE(layout) ((layout).n_dofs + 10)

// The kinematic chain, in doubles. A bone: its origin in the parent's frame (0 for the root); quaternion x, y, z, w and
// translation of bone_from_rest. Then the joints' axes in their bones' frames; keypoints and points of the soles in
// theirs.
#define LC_POSE_CHAIN_BONE 10
#define LC_POSE_CHAIN_AXES(layout) (LC_POSE_CHAIN_BONE * (layout).n_bones)
#define LC_POSE_CHAIN_POINTS(layout) (LC_POSE_CHAIN_AXES(layout) + 3 * (layout).n_dofs)
#define LC_POSE_CHAIN_SIZE(layout) (LC_POSE_CHAIN_POINTS(layout) + 3 * (LC_POSE_KEYPOINTS + (layout).n_soles))
// How it hangs together: each bone's parent (-1 of the root), each joint's bone, each keypoint's (-1: it has no anchor)
// and sole point's; then the first joint of each bone and the next one of each joint's bone, n_dofs where there is
// none.
#define LC_POSE_LINKS_DOFS(layout) ((layout).n_bones)
#define LC_POSE_LINKS_POINTS(layout) (LC_POSE_LINKS_DOFS(layout) + (layout).n_dofs)
#define LC_POSE_LINKS_FIRST(layout) (LC_POSE_LINKS_POINTS(layout) + LC_POSE_KEYPOINTS + (layout).n_soles)
#define LC_POSE_LINKS_NEXT(layout) (LC_POSE_LINKS_FIRST(layout) + (layout).n_bones)
#define LC_POSE_LINKS_SIZE(layout) (LC_POSE_LINKS_NEXT(layout) + (layout).n_dofs)

// Local memory of gauss_newton.cl. In doubles: damped system (before the steps: a round's start), state, posed chain.
#define LC_POSE_MOVED ((LC_POSE_KEYPOINTS + 3) / 4 * 4)
#define LC_POSE_CHAIN_LOCAL(layout)                                                                                   \
  (LC_POSE_CHAIN_SIZE(layout) + 11 * (layout).n_bones + 8 * (layout).n_dofs + 6 * LC_POSE_KEYPOINTS + LC_POSE_MOVED + \
   (LC_POSE_LINKS_SIZE(layout) + 1) / 2)
// Rows of the damped system: an even number of unknowns and the right-hand side, rounded up. The kernel has it as
// LC_POSE_SYSTEM_SIDE.
#define LC_POSE_SIDE(layout) (((layout).n_unknowns + 1) / 2 * 2 / 16 * 16 + 16)
#ifndef LC_POSE_SYSTEM_SIDE
#define LC_POSE_SYSTEM_SIDE 48
#endif
#define LC_POSE_SOLVE_LOCAL(layout) (12 * LC_POSE_SIDE(layout))
#define LC_POSE_LOCAL(layout) (LC_POSE_STATE_SIZE(layout) + LC_POSE_CHAIN_LOCAL(layout) + LC_POSE_SOLVE_LOCAL(layout))
// In floats: which column moves which bone, the step, records and residuals of a group's rows, targets, ground.
#define LC_POSE_NEAR_SIZE(layout)                                                                               \
  (LC_POSE_STEP_SIZE(layout) + LC_POSE_GROUP_ROWS * (LC_POSE_RECORD + 1) + LC_POSE_TARGET * LC_POSE_KEYPOINTS + \
   LC_POSE_GROUND_STANDS + (layout).n_soles + (layout).n_bones * (layout).n_columns)

// What a solve keeps for one that starts where it ended, in doubles: keypoints, camera frame; the step, floats.
#define LC_POSE_KEPT(layout) (3 * LC_POSE_KEYPOINTS + (LC_POSE_STEP_SIZE(layout) + 1) / 2)

// Entries of [J | F]^T [J | F] in gram.cl's tiles.
#define LC_POSE_GRAM_SIZE(layout) ((layout).n_columns * ((layout).n_columns + 8) / 2)
// Floats of the local memory where gauss_newton.cl has a group's rows of J, then the sum of all parts.
#define LC_POSE_ROWS_SIZE(layout)                                                                                \
  (LC_POSE_GROUP_ROWS * (layout).n_columns > LC_POSE_GRAM_SIZE(layout) ? LC_POSE_GROUP_ROWS * (layout).n_columns \
                                                                       : LC_POSE_GRAM_SIZE(layout))

typedef struct {
  int most;           // steps; -1: none, the normal equations of the state or step that was uploaded
  int tag;            // of the first step's sums, see tagged.h; of those after it the next ones
  int write_rows;     // whether J is written as well
  float settled_px;   // no further step after one that moves no keypoint so far
  float damping_own;  // see PoseOptions
  float damping_largest;
  float max_step_rad;
  float rank_threshold;  // pivots below this share of the largest count as zero
  int round;             // of those that are launched one after the other
  int continues;  // whether it starts where the one before ended: the rest as src/pose/pose_solver.cpp prepares it
  float least_moved_px;  // nothing is done when the one before moved no keypoint so far; it moved -1 where it failed
  float doubt_mm;        // of 3D detections where it continues, see src/pose/targets.h; 0: none
  int rests;             // whether soles_before are known
  float least_stands;    // how sure a sole is to rest, at least
  int tells;             // whether residuals are asked for where the steps end
} PoseStepsArg;

// Rounds at most.
#define LC_POSE_MOST_ROUNDS 8

#define LC_POSE_SOLVED 0
#define LC_POSE_RANK_DEFICIENT 1
#define LC_POSE_NOT_FINITE 2
// What it says, in words: the state where the steps ended (doubles); how many were begun; LC_POSE_SOLVED or why the
// last one failed; whether a wait was given up (never reset); the round; how far a keypoint moved at most, px; the
// targets' roots of 3D weights; the inputs' counts; F^T F before each; the residuals of all rows.
#define LC_POSE_MOST_STEPS 32
#define LC_POSE_RESULT_TAKEN(layout) (2 * LC_POSE_STATE_SIZE(layout))
#define LC_POSE_RESULT_STATUS(layout) (LC_POSE_RESULT_TAKEN(layout) + 1)
#define LC_POSE_RESULT_GAVE_UP(layout) (LC_POSE_RESULT_TAKEN(layout) + 2)
#define LC_POSE_RESULT_ROUND(layout) (LC_POSE_RESULT_TAKEN(layout) + 3)
#define LC_POSE_RESULT_MOVED(layout) (LC_POSE_RESULT_TAKEN(layout) + 4)
#define LC_POSE_RESULT_ROOTS_3D(layout) (LC_POSE_RESULT_TAKEN(layout) + 5)
#define LC_POSE_RESULT_COUNTS(layout) (LC_POSE_RESULT_ROOTS_3D(layout) + LC_POSE_KEYPOINTS)
#define LC_POSE_RESULT_ENERGY(layout) (LC_POSE_RESULT_COUNTS(layout) + LC_POSE_COUNTS)
#define LC_POSE_RESULT_RESIDUALS(layout) (LC_POSE_RESULT_ENERGY(layout) + LC_POSE_MOST_STEPS)

// The contour term's constants.
typedef struct {
  int n;      // contour vertices; on GPUs the inputs' counts say it
  int width;  // of the distance image, px
  int height;
  float sqrt_weight;  // of one vertex; likewise
  float huber_px;     // 0 = quadratic everywhere
} PoseContour;

#endif

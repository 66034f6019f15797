// Sizes and places that the host and the kernels of the pose stage agree on. Read by both compilers.
//
// Unknowns: [rotation vector 3 | t 3 | joint angles n_dofs | t' 3]. J has one row per residual and n_columns columns:
// the unknowns, the residual itself in column n_unknowns, zeros up to a multiple of 16.
// Rows: 8 per keypoint (2D 2, 3D 3, temporal 3), one per joint angle (anatomic), one per point of the soles (floor),
// one per contour vertex, two per match, one per shaded vertex. Positions marked "root-relative" are camera-frame
// vectors from the root's origin t: floats keep more of them.
#ifndef LC_POSE_LAYOUT_H
#define LC_POSE_LAYOUT_H

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

// Of normal_equations.cl: rows of a work-group and its work-items.
#define LC_POSE_GROUP_ROWS 32
#define LC_POSE_GROUP 256

// One keypoint of the frame, in 12 floats: target u, v (px); target x, y, z (mm); square roots of the 2D, 3D and
// temporal weights, 0 = no such row; position in the previous frame (mm); unused.
#define LC_POSE_TARGET 12

typedef struct {
  int n_dofs;
  int n_unknowns;  // n_dofs + 9
  int n_columns;   // n_unknowns + 1, rounded up to a multiple of 16
  int n_bones;
  int n_soles;  // points of the soles
} PoseLayout;

// What one Gauss-Newton step uploads, in floats: for every column the axis (3 planes) and the moment origin x axis
// (3 planes); keypoints xyz, root-relative; t'; t; joint angles; bone dual quaternions, root-relative; points of the
// soles xyz, root-relative.
#define LC_POSE_STEP_KEYPOINTS(layout) (6 * (layout).n_columns)
#define LC_POSE_STEP_T_PRIME(layout) (LC_POSE_STEP_KEYPOINTS(layout) + 3 * LC_POSE_KEYPOINTS)
#define LC_POSE_STEP_ROOT(layout) (LC_POSE_STEP_T_PRIME(layout) + 3)
#define LC_POSE_STEP_ANGLES(layout) (LC_POSE_STEP_ROOT(layout) + 3)
#define LC_POSE_STEP_DUAL_QUATS(layout) (LC_POSE_STEP_ANGLES(layout) + (layout).n_dofs)
#define LC_POSE_STEP_SOLES(layout) (LC_POSE_STEP_DUAL_QUATS(layout) + 8 * (layout).n_bones)
#define LC_POSE_STEP_SIZE(layout) (LC_POSE_STEP_SOLES(layout) + 3 * (layout).n_soles)

// What the rows of a frame are made of, one upload: where in it each thing lies, in words. Vertices are template vertex
// indices, int.
typedef struct {
  int targets;           // [LC_POSE_TARGET*LC_POSE_KEYPOINTS]
  int ground;            // [LC_POSE_GROUND_STANDS + n_soles]
  int contour_vertices;  // [n]
  int match_vertices;    // [n]
  int match_targets;     // [LC_POSE_MATCH*n]
  int shaded_vertices;   // [n]
  int shaded_targets;    // [LC_POSE_SHADED*n]
} PoseInputs;

// The ground: normal xyz, offset (mm), root of the weight (0: none is known), Huber threshold (mm; 0 = quadratic
// everywhere); then for each point of the soles how sure it is to rest there.
#define LC_POSE_GROUND_STANDS 6

// The contour term's constants.
typedef struct {
  int n;      // contour vertices
  int width;  // of the distance image, px
  int height;
  int has_displacement;
  float sqrt_weight;  // of one vertex
  float huber_px;     // 0 = quadratic everywhere
} PoseContour;

#endif

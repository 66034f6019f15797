// Sizes and structs that the host and the kernels of the match room agree on. Read by both compilers.
#ifndef LC_MATCH_LAYOUT_H
#define LC_MATCH_LAYOUT_H

// Work images are boxes of the picture. Pixel (0, 0) lies at (x, y) of the picture; a box may reach beyond it. At level
// l a pixel stands for 2^l x 2^l of the picture, and width (a multiple of 16, so of whole tiles but for see_actor's)
// and height are those of the level.
typedef struct {
  int x, y;
  int width, height;
} MatchBox;

// Half a window of the local mean and contrast, px: 25 x 25 pixels.
#define LC_MATCH_RADIUS 12
// Columns at the left and right of a box in which nobody is: a window must not leave its row. Both halve per level.
#define LC_MATCH_MARGIN 16
// Between rows of column sums, for the windows that are looked at in vain.
#define LC_MATCH_PAD 32
// Rows in which a work-item of a CPU carries a column's sums on, and rows and columns of a work-group of a GPU.
#define LC_MATCH_BAND 64
#define LC_MATCH_TILE 16
// Local memory of a tile so wide that is normalised, in floats: with what its windows reach, light, weight and sums of
// rows.
#define LC_MATCH_TILE_LOCAL(width) \
  (((width) + 2 * LC_MATCH_RADIUS) * (2 * (LC_MATCH_TILE + 2 * LC_MATCH_RADIUS) + 3 * LC_MATCH_TILE))
// Half-resolution levels below the full picture.
#define LC_MATCH_LEVELS 2

// One vertex's match, in floats: u, v (px); root of the distance's weight a, b, c (see VertexMatch); weight, 0 = no
// match; correlation of the two patches; px^2 that the vertex stands for, of every visible one, matched or not.
#define LC_MATCH 8
#define LC_MATCH_WEIGHT_PX 5
#define LC_MATCH_CORRELATION 6
#define LC_MATCH_SEEN_PX 7

// How the picture shows a vertex, in floats: its normal, the shade in which it would look so (lit.h; it may be below
// 0), weight (0 = not seen).
#define LC_LIT_SAMPLE 5
#define LC_LIT_BRIGHTNESS 3
#define LC_LIT_WEIGHT 4

// How bright a vertex of skin is, in floats: its normal, brightness by albedo, px^2 that it stands for (0 = not seen,
// negative where the picture shows something of another colour), red and blue by albedo, each by the brightness.
#define LC_SKIN 7
#define LC_SKIN_BRIGHTNESS 3
#define LC_SKIN_PX 4
#define LC_SKIN_TINT 5
// Limbs that skin is on.
#define LC_SKIN_LIMBS 8
// All pixels so far around the vertex are averaged, and must be of skin.
#define LC_SKIN_RADIUS 2
// Work-items of a GPU for each vertex.
#define LC_SKIN_SHARE 32

typedef struct {
  int level;  // matched at: 0 = full resolution
  int iterations;
  float softness;         // contrast^2 per px^2 whose direction counts half
  float max_move_px;      // of the level; matches further away are dropped
  float min_correlation;  // as are those less alike; the weight grows from 0 there to all of it at 1
  float depth_range_mm;   // pixels of a patch further from the vertex than that belong to something else
} PatchOptions;

// For see_actor.cl: how wide its tiles are, twice the others since windows of wide ones share more; its work-items,
// which are a tile's; and its local memory, in floats.
#define LC_SEE_TILE_WIDTH (2 * LC_MATCH_TILE)
#define LC_SEE_GROUP (LC_SEE_TILE_WIDTH * LC_MATCH_TILE)
#define LC_SEE_LOCAL LC_MATCH_TILE_LOCAL(LC_SEE_TILE_WIDTH)

typedef struct {
  float least_moved_px;  // nothing is done where `moved` holds less
  int n_vertices, n_triangles;
  int n_skin;       // vertices of skin that are measured
  int new_picture;  // whether the camera's pyramid is made first
  int width, height;
  int cull;
  int contour_radius_px;
  float visible_tolerance_mm, contour_tolerance_mm;
  int texels, texture_width, texture_height;  // see textured_actor
  float focal_px;
  float blur;  // see blur_actor
  float variance_floor;
  float min_facing, skin_range_mm;  // see skin_brightness
} SeeOptions;

// Vertices of a work-item of a CPU that moves patches.
#define LC_MATCH_VERTICES 64
// A patch is so many pixels wide and high. A GPU has a work-item for each column.
#define LC_MATCH_PATCH 8

#endif

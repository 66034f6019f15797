// What host and kernels of the raster agree on. Read by both compilers.
#ifndef LC_RASTER_LAYOUT_H
#define LC_RASTER_LAYOUT_H

// Rows that share a record of which columns were drawn.
#define LC_STRIP_ROWS 8

// The most triangles that a work-item of a CPU sets up at once (LANES).
#define LC_RASTER_TRIANGLES 16

// The most rows of a triangle that a work-item of a CPU draws at once, a multiple of eight.
#define LC_RASTER_ROWS 64

// Work-items of a GPU that share a triangle.
#define LC_RASTER_SHARE 8

// Pixels that a work-item clears on a GPU.
#define LC_RASTER_CLEAR 4

// Body-part mask: pixels of a row that a work-item takes, a vector of them; rows of which it grows the parts at once;
// zeros before and behind each row of the planes, at least as many as parts grow.
#define LC_PART_PIXELS 16
#define LC_PART_ROWS 8
#define LC_PART_PAD 16

// How far apart depths of neighbouring pixels lie, and their triangles' ids: 2 where either is half of a word
// (raster/depth_and_id.h).
#ifndef LC_RASTER_APART
#define LC_RASTER_APART 1
#endif

#endif

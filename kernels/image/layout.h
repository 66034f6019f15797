// What host and kernels of foreground and distance field agree on. Read by both compilers.
#ifndef LC_IMAGE_LAYOUT_H
#define LC_IMAGE_LAYOUT_H

// Pixels of a row that a work-item takes, a vector of them.
#define LC_LANES 16

// Pixels along each side of a cell of gate and core.
#define LC_COARSE 4

// The distance field's exact columns begin at and count a multiple of this. On a GPU, rows come by as many: the bits of
// a word.
#define LC_BLOCK 32

#endif

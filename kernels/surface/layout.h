// What host and kernels of the surface stage agree on. Read by both compilers.
#ifndef LC_SURFACE_LAYOUT_H
#define LC_SURFACE_LAYOUT_H

// Work-items of a group of pcg_phases.cl, and the most groups.
#define LC_PCG_GROUP 256

// Pixels at most that a blurred colour is made of, along each axis: one more than the kernel's size.
#define LC_PHOTO_TAPS 16

#endif

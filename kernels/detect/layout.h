// The pose network's numbers, which host and kernels have in common. Read by both compilers.
#ifndef LC_DETECT_LAYOUT_H
#define LC_DETECT_LAYOUT_H

#define LC_LANDMARKS 39
// Sides of the crop that it sees, of its heat maps, and of the part of them that is looked at around a landmark, px.
#define LC_CROP 256
#define LC_HEATMAP 64
#define LC_WINDOW 7

#endif

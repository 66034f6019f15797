// What carving shares with the host.
#ifndef LC_ACQUIRE_LAYOUT_H
#define LC_ACQUIRE_LAYOUT_H

#define LC_CARVE_KEPT 6  // distances of a node to views' cones, the largest ones: one more than may be overruled

#endif

// Ring of a vertex that is snapped to the silhouette or follows (vertex snapping): 0 = snapped, k = k edges from a
// snapped vertex, RING_FREE = not reached, RING_HELD = may not move.
#ifndef LC_SURFACE_RINGS_H
#define LC_SURFACE_RINGS_H

#define RING_FREE 1000.0f
#define RING_HELD 2000.0f

#endif

// The kernels of the surface stage as one program, but those that work on slices of vertices (slices.cl).
#include "surface/match_system.cl"
#include "surface/pack.cl"
#include "surface/photo_system.cl"
#include "surface/silhouette_system.cl"
#include "surface/snap_targets.cl"

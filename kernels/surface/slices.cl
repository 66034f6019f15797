// The kernels of the surface stage that work on slices of vertices (shared/lanes.h) as one program, skinning as well.
#include "surface/pcg.cl"
#include "surface/pcg_phases.cl"
#include "surface/regularizer_system.cl"
#include "surface/skin.cl"
#include "surface/snap_warp.cl"

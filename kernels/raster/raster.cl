// All kernels of this folder as one program; visibility.cl last, since shared/lanes.h makes REAL a vector.
#include "raster/depth.cl"
#include "raster/part_mask.cl"
//
#include "raster/visibility.cl"

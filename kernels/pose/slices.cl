// The kernels of the pose stage that work on slices of vertices as one program.
#include "pose/contour_records.cl"
#include "pose/match_records.cl"
//
#include "pose/shading_records.cl"

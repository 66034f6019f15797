// All kernels of the pose stage as one program, but those that work on slices of vertices (slices.cl) and
// those for GPUs (gauss_newton.cl).
#include "pose/point_records.cl"
//
#include "pose/fill_rows.cl"
#include "pose/gram.cl"

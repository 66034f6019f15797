// All kernels of the pose stage as one program.
#include "pose/point_records.cl"
//
#include "pose/contour_records.cl"
#include "pose/fill_rows.cl"
#include "pose/gram.cl"
#include "pose/match_records.cl"

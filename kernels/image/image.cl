// All kernels of this folder as one program: PoCL takes as long to look one up in its cache however large it is.
#include "image/distance_field.cl"
#include "image/foreground.cl"
#include "image/lay_mask.cl"

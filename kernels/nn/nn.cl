// The kernels of a network as one program; layers.cl has what GPUs do instead of the last three.
#include "nn/elementwise.cl"
#include "nn/pool.cl"
#include "nn/resize_nearest.cl"
#if LC_CPU
#include "nn/conv2d.cl"
#include "nn/depthwise.cl"
#include "nn/resize.cl"
#endif

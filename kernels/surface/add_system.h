// A data term's share of one row added to the system, in programs that take a row at a time.
#ifndef LC_SURFACE_ADD_SYSTEM_H
#define LC_SURFACE_ADD_SYSTEM_H
#include "surface/system.h"

// blocks: 6 planes, rhs: 3 planes, `stride` apart.
static inline void add_system(VertexSystem s, int row, int stride, global float* restrict blocks,
                              global float* restrict rhs) {
  blocks[row] += s.xx;
  blocks[stride + row] += s.xy;
  blocks[2 * stride + row] += s.xz;
  blocks[3 * stride + row] += s.yy;
  blocks[4 * stride + row] += s.yz;
  blocks[5 * stride + row] += s.zz;
  rhs[row] += s.rhs.x;
  rhs[stride + row] += s.rhs.y;
  rhs[2 * stride + row] += s.rhs.z;
}

#endif

// Between the packed vertex arrays of the other rooms ([3n], mesh order) and the solver's planes (x, y, z planes of
// `stride` floats, rows in the order of src/surface/sell.h).

// order: [n] mesh vertex of each row. Rows beyond n become zero.
kernel void pack_planes(int n, int n_rows, int stride, global const int* restrict order,
                        global const float* restrict packed, global float* restrict planes) {
  int row = get_global_id(0);
  if (row >= n_rows) return;
#pragma unroll
  for (int a = 0; a < 3; ++a) planes[a * stride + row] = row < n ? packed[3 * order[row < n ? row : 0] + a] : 0.0f;
}

// A failed solve (scalars[3] != 0, see pcg.cl) gives back the start.
kernel void unpack_planes(int n, int stride, global const int* restrict order, global const float* restrict scalars,
                          global const float* restrict planes, global const float* restrict start,
                          global float* restrict packed) {
  int row = get_global_id(0);
  if (row >= n) return;
  int vertex = order[row];
#pragma unroll
  for (int a = 0; a < 3; ++a) {
    packed[3 * vertex + a] = scalars[3] != 0.0f ? start[3 * vertex + a] : planes[a * stride + row];
  }
}

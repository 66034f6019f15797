// Between the packed vertex arrays of the other rooms ([3n], mesh order) and the solver's planes (x, y, z planes of
// `stride` floats, rows in the order of src/surface/sell.h).

// Up to four arrays, as many as the range has rows. order: [n] mesh vertex of each row. Rows beyond n become zero.
kernel void pack_planes(int n, int n_rows, int stride, global const int* restrict order, global const float* packed0,
                        global const float* packed1, global const float* packed2, global const float* packed3,
                        global float* planes0, global float* planes1, global float* planes2, global float* planes3) {
  const int row = get_global_id(0), which = get_global_id(1);
  if (row >= n_rows) return;
  global const float* packed = which == 0 ? packed0 : which == 1 ? packed1 : which == 2 ? packed2 : packed3;
  global float* planes = which == 0 ? planes0 : which == 1 ? planes1 : which == 2 ? planes2 : planes3;
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

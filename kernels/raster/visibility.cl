// Which vertices the camera sees, and which of them make the outer silhouette (paper, "Dense Silhouette Alignment").
#ifdef LC_DEVICE

// visible[i] = 1 when vertex i projects into the image, its normal faces the camera, and nothing in the 3x3 pixels
// around it lies in front of it by more than the tolerance everywhere (an empty pixel hides nothing).
kernel void visible_vertices(int n, int width, int height, float tolerance_mm,
                             global const float* restrict positions,  // [3*n] mm, camera frame
                             global const float* restrict normals,    // [3*n]
                             global const float* restrict projected,  // [4*n] u, v, 1/z, z
                             global const float* restrict depth,      // [w*h] mm
                             global int* restrict visible) {
  const int i = get_global_id(0);
  if (i >= n) return;
  visible[i] = 0;
  const float4 q = vload4(i, projected);
  if (!(q.z > 0.0f)) return;
  const int x = convert_int_rte(q.x);
  const int y = convert_int_rte(q.y);
  if (x < 0 || y < 0 || x >= width || y >= height) return;
  const float3 p = vload3(i, positions);
  const float3 normal = vload3(i, normals);
  if (!(p.x * normal.x + p.y * normal.y + p.z * normal.z < 0.0f)) return;
  float farthest = 0.0f;
  for (int v = max(y - 1, 0); v <= min(y + 1, height - 1); ++v) {
    for (int u = max(x - 1, 0); u <= min(x + 1, width - 1); ++u) farthest = fmax(farthest, depth[v * width + u]);
  }
  visible[i] = q.w <= farthest + tolerance_mm ? 1 : 0;
}

// facing[t]: 1 towards the camera, -1 away, 0 edge-on or not projected.
kernel void triangle_facing(int n_triangles, global const float* restrict projected,
                            global const int* restrict triangles, global int* restrict facing) {
  const int t = get_global_id(0);
  if (t >= n_triangles) return;
  const int3 index = vload3(t, triangles);
  const float4 a = vload4(index.x, projected);
  const float4 b = vload4(index.y, projected);
  const float4 c = vload4(index.z, projected);
  // Counter-clockwise seen from outside is negative in an image whose y points down.
  const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const int projects = a.z > 0.0f && b.z > 0.0f && c.z > 0.0f;
  facing[t] = !projects ? 0 : area < 0.0f ? 1 : area > 0.0f ? -1 : 0;
}

// contour[i] = 1 when vertex i lies on an edge between a front and a back face (or on an open edge of the mesh), the
// disc of radius_px around its pixel leaves the rendered mask inside the image, and it is not behind the rendered
// surface. Only such vertices project onto the outline itself; others near it would be pulled outwards by their
// distance to it.
kernel void contour_vertices(int n, int width, int height, int radius_px, float tolerance_mm,
                             global const float* restrict projected,    // [4*n]
                             global const int* restrict fan_offsets,    // [n+1]
                             global const int* restrict fan_triangles,  // [fan_offsets[n]]
                             global const int* restrict on_open_edge,   // [n]
                             global const int* restrict facing,         // [n_triangles]
                             global const float* restrict depth,        // [w*h] mm
                             global int* restrict contour) {
  const int i = get_global_id(0);
  if (i >= n) return;
  contour[i] = 0;
  const float4 q = vload4(i, projected);
  if (!(q.z > 0.0f)) return;
  const int x = convert_int_rte(q.x);
  const int y = convert_int_rte(q.y);
  if (x < 0 || y < 0 || x >= width || y >= height) return;
  int front = 0, back = 0;
  for (int k = fan_offsets[i]; k < fan_offsets[i + 1]; ++k) {
    const int side = facing[fan_triangles[k]];
    front |= side > 0;
    back |= side < 0;
  }
  if (!(front & back) && !(on_open_edge[i] & (front | back))) return;
  int outside = 0;
  float farthest = 0.0f;  // of the rendered pixels
  for (int dv = -radius_px; dv <= radius_px; ++dv) {
    for (int du = -radius_px; du <= radius_px; ++du) {
      const int u = x + du;
      const int v = y + dv;
      if (u < 0 || v < 0 || u >= width || v >= height || du * du + dv * dv > radius_px * radius_px) continue;
      const float d = depth[v * width + u];
      if (d < INFINITY) {
        farthest = fmax(farthest, d);
      } else {
        outside = 1;
      }
    }
  }
  contour[i] = outside && (farthest == 0.0f || q.w <= farthest + tolerance_mm) ? 1 : 0;
}

#endif

// E_floor = lambda_floor sum_i r_i^2 over points of the soles: r = h below the floor, s h above, h the height above it.
// r in mm. Unknown: the point p. s in 0..1: how sure the point is to rest there. (n, offset): h = n . p + offset.
#include "shared/vec.h"

typedef struct {
  REAL r;
  REAL J[3];
} FloorRow;

LC_FN FloorRow floor_row(Vec3 p, Vec3 normal, REAL offset, REAL stands) {
  REAL height = dot3(normal, p) + offset;
  REAL share = height < LC_LIT(0.0) ? LC_LIT(1.0) : stands;
  FloorRow row;
  row.r = share * height;
  row.J[0] = share * normal.x;
  row.J[1] = share * normal.y;
  row.J[2] = share * normal.z;
  return row;
}

// x = p; params = normal, offset, s.
LC_FN void floor_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  FloorRow row = floor_row(vec3(x[0], x[1], x[2]), vec3(params[0], params[1], params[2]), params[3], params[4]);
  r[0] = row.r;
  for (int j = 0; j < 3; ++j) J[j] = row.J[j];
}

// A crop's mask laid over the image, where its box is; 0 elsewhere. The same as warp_affine of src/image on the host.
#include "image/warp_point.h"

typedef struct {
  int width, height;  // of the image
  int x0, y0, x1, y1;
  int size;  // of the crop
} MaskArg;

static int mask_at(global const uchar* restrict crop, int size, int x, int y) {
  return x >= 0 && y >= 0 && x < size && y < size ? crop[y * size + x] : 0;
}

// Over (width, height). steps: of the box.
kernel void lay_mask(MaskArg arg, global const uchar* restrict crop, global const int* restrict steps,
                     global uchar* restrict mask) {
  const int x = get_global_id(0), y = get_global_id(1);
  if (x >= arg.width || y >= arg.height) return;
  int value = 0;
  if (x >= arg.x0 && x < arg.x1 && y >= arg.y0 && y < arg.y1) {
    const WarpPoint p = warp_point(steps, arg.x1 - arg.x0, x - arg.x0, y - arg.y0);
    value = warp_mix(p, mask_at(crop, arg.size, p.x, p.y), mask_at(crop, arg.size, p.x + 1, p.y),
                     mask_at(crop, arg.size, p.x, p.y + 1), mask_at(crop, arg.size, p.x + 1, p.y + 1));
  }
  mask[y * arg.width + x] = (uchar)value;
}

// One prepared frame in the memory of the solver's device.
#pragma once

#include <cstdint>

#include "base/image_rgb.h"
#include "image/silhouette.h"
#include "ocl/buffer.h"

namespace livecap {

struct DeviceFrame {
  int width = 0;
  int height = 0;
  // [width*height] px, see image/silhouette.h; zero all over what may be a dark shadow or the person, which is neither
  // matched nor drawn to (DeviceDistanceField::leave_open).
  ocl::Buffer<float> signed_distance;
  ocl::Buffer<uint8_t> rgb;           // [3*width*height] undistorted
  ocl::Buffer<uint8_t> network_mask;  // [width*height] the network's probabilities, for the segmentation
  ocl::Buffer<uint8_t> mask;          // [width*height] 255 = person
  bool has_picture = false;           // rgb was written, as soon as the network had a look at the picture

  DeviceFrame(ocl::DeviceContext& device, int width, int height) : DeviceFrame(device, device, width, height) {}
  // picture_device: the same with a queue of its own, through which picture and network's mask come.
  DeviceFrame(ocl::DeviceContext& device, ocl::DeviceContext& picture_device, int width, int height)
      : width(width),
        height(height),
        signed_distance(device, size_t(width) * height),
        rgb(picture_device, size_t(3) * width * height),
        network_mask(picture_device, size_t(width) * height),
        mask(device, size_t(width) * height) {}

  // Blocking upload of all but the mask. Sizes must match.
  void upload(const Silhouette& silhouette, const ImageRgb& image) {
    signed_distance.write(silhouette.signed_distance);
    rgb.write(image.pixels);
  }
};

}  // namespace livecap

// ConvTranspose without an operator of its own: zeros between the pixels (Pad and Reshape), then a convolution with the
// kernel turned around.
#include <algorithm>

#include "base/text.h"
#include "nn/onnx_importer.h"

namespace livecap::nn {
int OnnxImporter::spread(NodeReader& node, int x, int stride_h, int stride_w) {
  const Shape from = graph_.tensors[x].shape;
  const auto follow_by_zeros = [&](int tensor, int rows, int columns, int64_t channels, int64_t zeros) {
    if (rows * (columns * (channels + zeros)) > kMaxElements) node.fail("the picture between its strides is too large");
    const int n = static_cast<int>(channels);
    const int whole = emit(node, Reshape{{1, rows, columns, n}}, {tensor}).tensor;
    Pad pad;
    pad.channels[1] = static_cast<int>(zeros);
    return emit(node, pad, {whole}).tensor;
  };
  if (stride_w > 1) x = follow_by_zeros(x, from[1], from[2], from[3], int64_t(stride_w - 1) * from[3]);
  const int64_t row = int64_t(from[2]) * stride_w * from[3];
  if (stride_h > 1) x = follow_by_zeros(x, from[1], 1, row, (stride_h - 1) * row);
  return emit(node, Reshape{{1, from[1] * stride_h, from[2] * stride_w, from[3]}}, {x}).tensor;
}

void OnnxImporter::transposed_convolution(NodeReader& node) {
  const OnnxValue x = image(node, 0);
  const Dims dims = constant(node, 1).dims;
  if (dims.size() != 4 || std::any_of(dims.begin(), dims.end(), [](int64_t n) { return n < 1; }))
    node.fail("weights of shape " + to_string(dims) + " must be [in,out,height,width]: only 2D is supported");
  node.require("group", 1);
  const int64_t channels = shape(x)[3], n_out = dims[1], kernel[2] = {dims[2], dims[3]};
  if (dims[0] != channels)
    node.fail("weights of shape " + to_string(dims) + format(" on %lld channels", static_cast<long long>(channels)));
  if (node.integers("kernel_shape", {kernel[0], kernel[1]}) != std::vector<int64_t>{kernel[0], kernel[1]})
    node.fail_attribute("kernel_shape", "must be that of the weights " + to_string(dims));
  if (kernel[0] > kMostInWindow || kernel[1] > kMostInWindow ||
      n_out * channels > kMaxElements / (kernel[0] * kernel[1]))
    node.fail("weights of shape " + to_string(dims) + " are too large");
  if (node.integers("dilations", {1, 1}) != std::vector<int64_t>{1, 1})
    node.fail_attribute("dilations", "only 1 is supported");
  if (!node.integers("output_shape", {}).empty())
    node.fail_attribute("output_shape", "is not supported: give pads and output_padding");
  const std::string rule = node.text("auto_pad", "NOTSET");
  if (rule != "NOTSET" && rule != "VALID") node.fail_attribute("auto_pad", "\"" + rule + "\" must be NOTSET or VALID");
  const std::vector<int> strides = sizes(node, "strides", 2, 1, 1), more = sizes(node, "output_padding", 2, 0, 0);
  std::vector<int> pads = sizes(node, "pads", 4, 0, 0);  // top, left, bottom, right: cut off the output
  if (rule == "VALID") pads.assign(4, 0);
  Window where;
  for (int axis : {0, 1}) {
    if (more[axis] >= strides[axis])
      node.fail_attribute("output_padding", format("%d must be less than the stride %d", more[axis], strides[axis]));
    if (pads[axis] >= kernel[axis])
      node.fail_attribute(
          "pads", format("%d must be less than the kernel's %lld", pads[axis], static_cast<long long>(kernel[axis])));
    const int around = static_cast<int>(kernel[axis]) - 1;
    // The zeros behind the last pixel are there already.
    const int behind = around - pads[axis + 2] + more[axis] - (strides[axis] - 1);
    if (behind < 0)
      node.fail_attribute("strides",
                          format("%d with a kernel of %lld, %d cut off behind and output_padding %d is not "
                                 "supported: the kernels of neighbouring pixels must touch",
                                 strides[axis], static_cast<long long>(kernel[axis]), pads[axis + 2], more[axis]));
    (axis == 0 ? where.pad_top : where.pad_left) = around - pads[axis];
    (axis == 0 ? where.pad_bottom : where.pad_right) = behind;
  }
  const std::vector<float> given = weights(node, 1);
  std::vector<float> turned(given.size());
  const int64_t area = kernel[0] * kernel[1];
  for (int64_t k = 0; k < channels; ++k)
    for (int64_t n = 0; n < n_out; ++n)
      for (int64_t tap = 0; tap < area; ++tap)
        turned[(n * area + area - 1 - tap) * channels + k] = given[(k * n_out + n) * area + tap];
  const int h = static_cast<int>(kernel[0]), w = static_cast<int>(kernel[1]), out = static_cast<int>(n_out);
  const int weight = add_constant(node, {out, h, w, static_cast<int>(channels)}, std::move(turned));
  const int bias = node.has_input(2) ? add_constant(node, {out}, weights(node, 2)) : -1;
  const int wide = strides[0] > 1 || strides[1] > 1 ? spread(node, x.tensor, strides[0], strides[1]) : x.tensor;
  define(node, emit(node, Conv2d{where}, {wide, weight, bias}));
}

}  // namespace livecap::nn

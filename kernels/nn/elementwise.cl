// The operators without weights. One work-item = one output element, neighbours are channels, unless said otherwise.
// in_offset and residual_offset name the inputs; ADD and MUL keep their second input as the residual.
#include "nn/panel.h"

// y = clamp(a + b). count = elements.
kernel void add(NnOp op, global float* arena) {
  const int i = get_global_id(0);
  if (i >= op.count) return;
  arena[op.out_offset + i] = clamp(arena[op.in_offset + i] + arena[op.residual_offset + i], op.low, op.high);
}

// y = clamp(a * b). count = elements.
kernel void mul(NnOp op, global float* arena) {
  const int i = get_global_id(0);
  if (i >= op.count) return;
  arena[op.out_offset + i] = clamp(arena[op.in_offset + i] * arena[op.residual_offset + i], op.low, op.high);
}

// y = clamp(x > 0 ? x : slope * x), with slope 1 the activation alone. count = elements.
kernel void leaky_relu(NnOp op, global float* arena) {
  const int i = get_global_id(0);
  if (i >= op.count) return;
  const float x = arena[op.in_offset + i];
  nn_store(op, arena, i, x > 0 ? x : op.slope * x);
}

// y = clamp(slope * x + offset to 0..1), mode 1: times x. count = elements.
kernel void hard_sigmoid(NnOp op, global float* arena) {
  const int i = get_global_id(0);
  if (i >= op.count) return;
  const float x = arena[op.in_offset + i];
  const float gate = clamp(op.slope * x + op.offset, 0.0f, 1.0f);
  nn_store(op, arena, i, op.mode ? x * gate : gate);
}

// One input's channels into their place of the output. count = elements of the input.
kernel void concat(NnOp op, global float* arena) {
  const int i = get_global_id(0);
  if (i >= op.count) return;
  const int at = i / op.in_channels * op.out_channels + op.pad_front + i % op.in_channels;
  nn_store(op, arena, at, arena[op.in_offset + i]);
}

// y = 1 / (1 + exp(-x)). count = elements.
kernel void logistic(NnOp op, global float* arena) {
  const int i = get_global_id(0);
  if (i >= op.count) return;
  arena[op.out_offset + i] = 1.0f / (1.0f + exp(-arena[op.in_offset + i]));
}

// 8-bit input to float: y = low + high * x. count = elements.
kernel void convert_u8(NnOp op, global const uchar* restrict input, global float* arena) {
  const int i = get_global_id(0);
  if (i >= op.count) return;
  arena[op.out_offset + i] = op.low + op.high * (float)input[i];
}

// Zeros around the image and its channels. count = elements.
kernel void pad(NnOp op, global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int c = id % op.out_channels - op.pad_front;
  const int pixel = id / op.out_channels;
  const int x = pixel % op.out_width - op.pad_left;
  const int y = pixel / op.out_width - op.pad_top;
  const int inside = c >= 0 && c < op.in_channels && x >= 0 && x < op.in_width && y >= 0 && y < op.in_height;
  nn_store(op, arena, id, inside ? arena[op.in_offset + (y * op.in_width + x) * op.in_channels + c] : 0.0f);
}

// One step of a network, by value, for host and device. Activations of all tensors live in one array, the arena; all
// offsets and strides count floats. Images are [height][width][channels].
#ifndef LC_NN_OP_PARAMS_H
#define LC_NN_OP_PARAMS_H

// Weights of a convolution are packed in panels of this many output channels: [cout/16][kh][kw][cin][16], of a
// depthwise one [c/16][kh][kw][16], biases [c/16][16], the last panel filled up with zeros.
#define NN_PANEL 16
// Neighbouring output pixels of one work-item on a CPU, whole register tiles of six or eight: of a window convolution
// and of one of 1x1.
#define NN_TILE 24
#define NN_STRIP 48
// The arena begins with zeros for reads outside an image and ends with slack, so that a vector of NN_PANEL channels may
// be read (never written) past the last channel of the last pixel.
#define NN_SLACK 64

typedef struct {
  int in_height, in_width, in_channels;
  int out_height, out_width, out_channels;
  int kernel_h, kernel_w;
  int stride_h, stride_w;
  int dilation_h, dilation_w;
  int pad_top, pad_left, pad_front;       // front: channels (PAD, and where an input of a CONCATENATION begins)
  int in_offset, out_offset;              // into the arena
  int residual_offset;                    // into the arena, shape of the output, added before the clamp; -1 = none.
                                          // The second input of ADD and MUL
  int weight_offset, bias_offset;         // into the weights; unused without
  int count;                              // work-items of this step
  int panels_innermost;                   // 1: work-items run over panels first (few weights), 0: over pixels first
  int align_corners, half_pixel_centers;  // RESIZE_BILINEAR, RESIZE_NEAREST
  int mode;             // RESIZE_NEAREST: rounding 0 down, 1 up, 2 to the nearest, halves down, 3 halves up.
                        // AVERAGE_POOL_2D: 1 counts the padding. HARD_SIGMOID: 1 multiplies with x
  float slope, offset;  // LEAKY_RELU, HARD_SIGMOID
  float low, high;      // the activation clamps to these
} NnOp;

// A step of layers.cl.
#define NN_POINTWISE 0
#define NN_WINDOW 1
#define NN_DEPTHWISE_LAYER 2
#define NN_ADD 3
#define NN_MAX_POOL 4
#define NN_RESIZE 5
#define NN_LOGISTIC 6
// Work-items of its work-groups.
#define NN_GROUP 256
// Most parts of a sum of a convolution, a power of two.
#define NN_MOST_SLICES 32

typedef struct {
  NnOp op;
  int kind;
  int slices;  // work-items that share a sum of a convolution: a power of two
} NnLayer;

#endif

// Exact Euclidean distance to the border between two kinds of pixels, signed, in two passes (after Meijster, Roerdink
// and Hesselink, "A general algorithm for computing distance transforms in linear time", 2000). Both sides come at
// once, since a pixel is on one of them: nothing on the far side of the next border in its row can be nearer than that
// border.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace livecap {

// inside: 8-bit, nonzero = inside; has pixels of both kinds, at most 16,000 rows and columns. distance: float of the
// same size. Distances run between pixel centres; half a pixel is taken off, so that the contour lies between the
// pixels: positive outside, negative inside.
void signed_distance(const cv::Mat& inside, cv::Mat& distance);

}  // namespace livecap

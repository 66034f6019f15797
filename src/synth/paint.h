// What the built-in people look like: colours as a function of the place on the rest surface.
#pragma once

#include "synth/body_shape.h"

namespace livecap::synth {

// sRGB in [0,1] at p (shape units, see body_shape.h) on the given part.
Vec3 paint(const BodyShape& shape, Part part, const Vec3& p);

// Where the painted features of the face are, to find the marker vertices.
struct FaceFeatures {
  Vec3 left_eye, right_eye, nose, chin;
};
FaceFeatures face_features(const BodyShape& shape);

}  // namespace livecap::synth

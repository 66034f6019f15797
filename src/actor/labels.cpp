#include "actor/labels.h"

namespace livecap {

const std::array<std::string_view, kLabelCount> kLabelNames = {
    "background", "hat",       "hair",     "glove",     "sunglasses", "upper-clothes", "dress",
    "coat",       "socks",     "pants",    "jumpsuit",  "scarf",      "skirt",         "face",
    "left-arm",   "right-arm", "left-leg", "right-leg", "left-shoe",  "right-shoe"};

float rigidity_of_label(int label) {
  constexpr std::array<float, kLabelCount> kRigidity = {1, 100, 200, 100, 200, 2,  1,  1,  50,  2.5f,
                                                        1, 3,   1,   200, 50,  50, 50, 50, 100, 100};
  return label >= 0 && label < kLabelCount ? kRigidity[label] : kRigidity[0];
}

}  // namespace livecap

// LIP label ids and the material weights of the paper's Table 1.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace livecap {

inline constexpr int kLabelCount = 20;

// Index = LIP id: background, hat, hair, glove, sunglasses, upper-clothes, dress, coat, socks, pants, jumpsuit, scarf,
// skirt, face, left-arm, right-arm, left-leg, right-leg, left-shoe, right-shoe.
extern const std::array<std::string_view, kLabelCount> kLabelNames;

// Those that the program itself tells apart. From kLeftArm on, left ones are even and the right one follows.
namespace lip {
enum Label : uint8_t {
  kHair = 2,
  kUpperClothes = 5,
  kDress = 6,
  kPants = 9,
  kSkirt = 12,
  kFace = 13,
  kLeftArm = 14,
  kRightArm = 15,
  kLeftLeg = 16,
  kRightLeg = 17,
  kLeftShoe = 18,
  kRightShoe = 19
};
}  // namespace lip

// Non-rigidity weight of a label; out-of-range ids count as background.
float rigidity_of_label(int label);

}  // namespace livecap

// What is guessed of a woman in a skirt whose colours are known, but for what the skirt hides.
#include <gtest/gtest.h>

#include "acquire/material_labels.h"
#include "acquire/skin_weights.h"
#include "acquire/true_actor.h"
#include "actor/labels.h"
#include "meshing/nearest_vertex.h"
#include "scan/mesh_volume.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

constexpr double kHiddenAboveMm = 540;  // the hem is at 529 mm, the legs end at 593

const Vector3d kSkin(0.85, 0.65, 0.55);

struct Guessed {
  double right = 0;        // share of all vertices
  double hidden_legs = 0;  // of the leg's vertices that the skirt hides: what is guessed to be a leg
  double shins = 0;        // of the shins': what is guessed to be no skirt
};

bool is_leg(uint8_t label) {
  return label == lip::kLeftLeg || label == lip::kRightLeg;
}

// What of the legs the skirt hides has its colour.
Guessed guess(const Vector3d& color_of_legs, bool says_what_is_seen) {
  const Actor actor = test::builtin_actor("skirt");
  const meshing::Surface surface = test::surface_of(actor);
  const acquire::BodyJoints joints = test::true_joints(actor);
  const Volume volume = volume_of(surface, 8);
  std::vector<Vector3d> colors;
  std::vector<char> seen;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const uint8_t label = actor.labels[i];
    seen.push_back(!is_leg(label) || surface.vertices[i].y() < kHiddenAboveMm);
    Vector3d color = kSkin;
    if (label == lip::kSkirt || !seen[i])
      color = {0.2, 0.25, 0.6};
    else if (is_leg(label))
      color = color_of_legs;
    else if (label == lip::kUpperClothes)
      color = {0.7, 0.2, 0.2};
    else if (label == lip::kHair)
      color = {0.15, 0.1, 0.08};
    else if (label == lip::kLeftShoe || label == lip::kRightShoe)
      color = {0.9, 0.9, 0.9};
    colors.push_back(color);
  }
  const std::vector<uint8_t> labels =
      acquire::guess_labels({surface, acquire::heat_weights(surface, joints, volume), joints, volume, colors,
                             meshing::nearest_vertex(surface, actor.keypoints[kNose].rest_position_mm),
                             says_what_is_seen ? seen : std::vector<char>()});
  Guessed result;
  int n_hidden = 0, n_shins = 0;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    result.right += labels[i] == actor.labels[i];
    if (!is_leg(actor.labels[i])) continue;
    if (!seen[i]) ++n_hidden, result.hidden_legs += is_leg(labels[i]);
    const double y = surface.vertices[i].y();
    if (y > 150 && y < 450) ++n_shins, result.shins += labels[i] != lip::kSkirt;
  }
  return {result.right / actor.n_vertices(), result.hidden_legs / n_hidden, result.shins / n_shins};
}

// No picture tells, and the colour of what is nearest is the skirt's.
TEST(GuessLabels, LegsGoOnInASkirt) {
  const Guessed told = guess(kSkin, true);
  EXPECT_GT(told.right, test::kGuessedLabels);
  EXPECT_GT(told.hidden_legs, test::kHiddenLegs);
  EXPECT_EQ(told.shins, 1);
  EXPECT_LT(guess(kSkin, false).hidden_legs, test::kFewHiddenLegs);  // guessed by its colour
}

TEST(GuessLabels, TightsAreNoSkirt) {
  EXPECT_EQ(guess({0.1, 0.1, 0.1}, true).shins, 1);
}

}  // namespace
}  // namespace livecap

#include "solve/term_table.h"

#include "geometry/reference.h"

namespace livecap {
namespace {

constexpr Term kTerms[] = {
    {"keypoint_2d", TermStage::kPose, 2, 3, 6, 460, reference::keypoint_2d_flat, "check_keypoint_2d"},
    {"keypoint_3d", TermStage::kPose, 3, 6, 3, 28, reference::keypoint_3d_flat, "check_keypoint_3d"},
    {"pose_silhouette", TermStage::kPose, 1, 3, 10, 200, reference::silhouette_flat, "check_silhouette"},
    {"match", TermStage::kPose, 2, 3, 9, 0, reference::match_flat, "check_match"},
    {"shading", TermStage::kPose, 1, 3, 10, 0, reference::shading_flat, "check_shading"},
    {"floor", TermStage::kPose, 1, 3, 5, 0, reference::floor_flat, "check_floor"},
    {"temporal", TermStage::kPose, 3, 3, 3, 1.5, reference::temporal_flat, "check_temporal"},
    {"anatomic", TermStage::kPose, 1, 1, 2, 1e6, reference::anatomic_flat, "check_anatomic"},
    {"rest", TermStage::kPose, 1, 1, 1, 0, reference::rest_flat, "check_rest"},
    {"photo", TermStage::kSurface, 3, 3, 19, 1e4, reference::photo_flat, "check_photo"},
    {"surface_silhouette", TermStage::kSurface, 1, 3, 10, 600, reference::silhouette_flat, "check_silhouette"},
    {"surface_match", TermStage::kSurface, 2, 3, 9, 0, reference::match_flat, "check_match"},
    {"smooth", TermStage::kSurface, 3, 6, 6, 10, reference::smooth_flat, "check_smooth"},
    {"edge", TermStage::kSurface, 1, 6, 1, 30, reference::edge_flat, "check_edge"},
    {"depth", TermStage::kSurface, 1, 3, 3, 0, reference::depth_flat, "check_depth"},
    {"velocity", TermStage::kSurface, 3, 3, 3, 0.25, reference::velocity_flat, "check_velocity"},
    {"acceleration", TermStage::kSurface, 3, 3, 6, 0.1, reference::acceleration_flat, "check_acceleration"},
};

}  // namespace

std::span<const Term> term_table() {
  return kTerms;
}

const Term* find_term(std::string_view name) {
  for (const Term& term : kTerms) {
    if (term.name == name) return &term;
  }
  return nullptr;
}

}  // namespace livecap

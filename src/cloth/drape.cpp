#include "cloth/drape.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "base/round_up.h"
#include "cloth/hanging_cloth.h"
#include "livecap/error.h"
#include "match/layout.h"

namespace livecap {
namespace {

static_assert(sizeof(DrapeStep) == 52, "as the kernel has it");

constexpr const char* kDrapeProgram = "cloth/drape.cl";
constexpr size_t kDrapeGroup = 64;  // of GPUs

Eigen::Vector3d joint(const PosedSkeleton& posed, int bone) {
  return posed.camera_from_bone[bone].translation();
}

std::array<std::array<int, 2>, 2> thighs_of(const Skeleton& skeleton) {
  return {{{skeleton.bone_index("left_hip"), skeleton.bone_index("left_knee")},
           {skeleton.bone_index("right_hip"), skeleton.bone_index("right_knee")}}};
}

// What is simulated, and linings by as much of it as they follow cloth.
struct DrapedVertices {
  std::vector<int32_t> vertices;
  std::vector<float> levels;
};

DrapedVertices draped(const Actor& actor, const ClothGraph& cloth, float looseness) {
  DrapedVertices of;
  for (int p = 0; p < cloth.n_particles(); ++p) {
    if (cloth.held[p]) continue;
    of.vertices.push_back(cloth.vertices[p]);
    of.levels.push_back(1);
  }
  for (size_t f = 0; f < cloth.followers.size(); ++f) {
    of.vertices.push_back(cloth.followers[f]);
    of.levels.push_back(std::lerp(cloth.follower_shares[f], 1.0f, looseness));
  }
  if (of.vertices.empty()) throw LogicError("drape: nothing hangs");
  const double hips = middle_of_the_hips(actor.skeleton).value().y();
  const auto height = [&](int i) { return double(actor.mesh.positions[3 * i + 1]); };
  double hem = hips;
  for (const int i : of.vertices) hem = std::min(hem, height(i));
  for (size_t k = 0; k < of.vertices.size(); ++k)
    of.levels[k] *= hem < hips ? float(std::clamp((hips - height(of.vertices[k])) / (hips - hem), 0.0, 1.0)) : 0.0f;
  return of;
}

}  // namespace

void DrapeOptions::validate() const {
  const auto require = [](bool fits, const char* field, double value, const char* range) {
    if (!fits)
      throw ConfigError(std::string("drape: ") + field + " is " + std::to_string(value) + ", must be " + range);
  };
  const auto above_0 = [&](float value, const char* field) {
    require(value > 0 && std::isfinite(value), field, value, "above 0 and finite");
  };
  above_0(memory_s, "memory_s");
  above_0(clings_doubt_mm, "clings_doubt_mm");
  above_0(narrows_doubt_mm, "narrows_doubt_mm");
  above_0(independent_parts, "independent_parts");
  require(narrows_from > -1 && narrows_from <= 0, "narrows_from", narrows_from, "above -1 and at most 0");
  require(narrows_to >= 0 && narrows_to < 1, "narrows_to", narrows_to, "at least 0 and below 1");
  require(lifted_from_deg >= 0 && lifted_from_deg < lifted_to_deg && lifted_to_deg <= 180, "lifted_from_deg",
          lifted_from_deg, "at least 0 and below lifted_to_deg, which is at most 180");
}

void DrapeEvidence::add(const std::array<float, LC_DRAPE_TOLD>& told, const DrapeShares& moved, double seconds) {
  if (!std::all_of(told.begin(), told.end(), [](float sum) { return std::isfinite(sum); })) return;
  const double kept = std::exp(-seconds / options_.memory_s);
  const Eigen::Vector2d off(told[3], told[4]), by(moved.clings, moved.narrows);
  Eigen::Matrix2d ways;
  ways << told[0], told[1], told[1], told[2];
  // From where cloth is simulated, not from where it was moved to.
  ways_ways_ = kept * ways_ways_ + ways;
  ways_off_ = kept * ways_off_ + off + ways * by;
  off_off_ = kept * off_off_ + told[5] + 2 * by.dot(off) + by.dot(ways * by);
  weight_ = std::max(kept * weight_, double(told[6]));
}

DrapeShares DrapeEvidence::shares() const {
  const Eigen::Vector2d doubt(options_.clings_doubt_mm, options_.narrows_doubt_mm);
  const Eigen::Matrix2d left = ways_ways_ + Eigen::Matrix2d((weight_ * doubt.cwiseAbs2()).asDiagonal());
  if (!(left.determinant() > 0)) return {};
  const Eigen::Vector2d least(0, options_.narrows_from), most(1, options_.narrows_to);
  Eigen::Vector2d shares = left.ldlt().solve(ways_off_);
  // A share out of its bounds stays at the nearer one, the other is the best with it.
  for (int k = 0; k < 2; ++k) {
    const double within = std::clamp(shares[k], least[k], most[k]);
    if (within == shares[k]) continue;
    shares[k] = within;
    shares[1 - k] = (ways_off_[1 - k] - left(0, 1) * within) / left(1 - k, 1 - k);
  }
  shares = shares.cwiseMax(least).cwiseMin(most);
  const double explained = 2 * shares.dot(ways_off_) - shares.dot(ways_ways_ * shares);
  if (!(explained > 0)) return {};
  shares *= std::max(0.0, 1 - (off_off_ - explained) / (options_.independent_parts * explained));
  return {shares[0], shares[1]};
}

Drape::Drape(ocl::DeviceContext& device, const Actor& actor, const ClothGraph& cloth, float looseness,
             const Camera& camera, const DrapeOptions& options)
    : options_((options.validate(), options)),
      camera_(pinhole_arg(camera)),
      group_(device.is_cpu() ? 1 : kDrapeGroup),
      thighs_(thighs_of(actor.skeleton)),
      only_skinned_(device, actor.mesh.positions.size()),
      told_(device, LC_DRAPE_TOLD),
      drape_(device, kDrapeProgram, "drape_cloth"),
      look_(device, kDrapeProgram, "look_at_drape"),
      evidence_(options) {
  const DrapedVertices of = draped(actor, cloth, looseness);
  n_ = int(of.vertices.size());
  vertices_ = {device, of.vertices};
  levels_ = {device, of.levels};
  ways_ = ocl::Buffer<float>(device, 6 * of.vertices.size());
}

void Drape::keep(const ocl::Buffer<float>& skinned) {
  only_skinned_.copy_from(skinned);
}

DrapeStep Drape::step_of(const PosedSkeleton& posed, const Eigen::Vector3d& up) const {
  double lifted_deg = 0;
  for (const auto& [hip, knee] : thighs_) {
    const double cosine = up.dot((joint(posed, hip) - joint(posed, knee)).normalized());
    lifted_deg = std::max(lifted_deg, std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI);
  }
  const double trusted = (options_.lifted_to_deg - lifted_deg) / (options_.lifted_to_deg - options_.lifted_from_deg);
  const Eigen::Vector3d axis = (joint(posed, thighs_[0][0]) + joint(posed, thighs_[1][0])) / 2;
  return {float(std::clamp(trusted, 0.0, 1.0)),
          float(shares_.clings),
          float(shares_.narrows),
          float(before_[0].clings),
          float(before_[0].narrows),
          float(before_[1].clings),
          float(before_[1].narrows),
          float(axis.x()),
          float(axis.y()),
          float(axis.z()),
          float(up.x()),
          float(up.y()),
          float(up.z())};
}

void Drape::move(const PosedSkeleton& posed, const Eigen::Vector3d& up, ocl::Buffer<float>& skinned,
                 ocl::Buffer<float>& start, ocl::Buffer<float>& start_before) {
  for (const ocl::Buffer<float>* points : {&skinned, &start, &start_before})
    if (points->size() != only_skinned_.size()) throw LogicError("drape: vertices of another mesh");
  drape_.launch(round_up(size_t(n_), group_), group_, n_, step_of(posed, up), vertices_, levels_, only_skinned_,
                skinned, start, start_before, ways_);
}

void Drape::look(const ocl::Buffer<int32_t>& visible, const ocl::Buffer<float>& skinned,
                 const ocl::Buffer<float>& matches) {
  if (skinned.size() != only_skinned_.size() || 3 * visible.size() != skinned.size() ||
      matches.size() != LC_MATCH * visible.size())
    throw LogicError("drape: a buffer is of another mesh");
  look_.launch(group_, group_, n_, camera_, vertices_, visible, skinned, matches, ways_, told_,
               ocl::LocalMemory{group_ * LC_DRAPE_TOLD * sizeof(float)});
  told_.read_later(std::span<float>(told_last_));
}

void Drape::learn(double seconds) {
  evidence_.add(told_last_, shares_, seconds);
  before_ = {shares_, before_[0]};
  shares_ = evidence_.shares();
}

void Drape::reset() {
  evidence_ = DrapeEvidence(options_);
  shares_ = {};
  before_ = {};
}

}  // namespace livecap

// The four Skeletool files.
#include <cmath>

#include "actor/skeletool.h"
#include "fuzz/fuzz.h"

namespace livecap::fuzz {
namespace {

const std::vector<std::string> kFiles = {"s.skeleton", "s.skin", "s.motion", "s.calibration"};

const char* const kSkeleton = R"(Skeletool Skeleton Definition V1.0
joints: 6
  root_tx   prismatic none      0 0 0   1 0 0  1
  root_rx   revolute  root_tx   0 0 0   1 0 0  1
  spine_rx  revolute  root_rx   0 100 0 1 0 0  1
  spine_ry  revolute  spine_rx  0 0 0   0 1 0  1
  arm_rz    revolute  spine_ry  90 50 0 0 0 2  2
  leg_rx    revolute  root_rx   80 -40 0 1 0 0 1
markers: 1
  hand  arm_rz  point 250 0 0 10 1 0 0
scaling joints: 1
  legs 1
    leg_rx
dofs: 3
  tx 1
    nolimits
    root_tx 1
  bend 2
    limits -1 2
    spine_rx 0.5
    spine_ry 0.5
  leg 1
    limits 0.1 0.5
    leg_rx -1
)";
const char* const kSkin = R"(Skeletool character skinning file V1.0
bones:
  spine arm leg
vertex weights:
  0 0 1
  1 0 0.5 1 0.5
  2 2 3 0 1 1 0
)";
const char* const kMotion = "Skeletool Motion File V1.0\n0 1 0.5 0\n1 2 0.25 -0.1\n";
const char* const kCalibration = R"(Skeletool Camera Calibration File V1.0
name          0
  sensor      10 10
  size        1296 972
  animated    0
  intrinsic   1500 0 640 0  0 1501 480 0  0 0 1 0  0 0 0 1
  extrinsic   1 0 0 -10  0 -1 0 1000  0 0 -1 3000  0 0 0 1
  radial      0
)";

// All that a program reads of them, with the skeleton posed.
void read_files(const std::filesystem::path& folder, const std::map<std::string, std::string>& files) {
  if (files.count("s.calibration"))
    for (const SkeletoolCamera& camera : load_skeletool_cameras(folder / "s.calibration")) camera.camera.validate();
  if (!files.count("s.skeleton")) return;
  const SkeletoolSkeleton skeleton = load_skeletool_skeleton(folder / "s.skeleton");
  skeleton.skeleton.validate();
  const Pose pose = skeleton.pose(Eigen::VectorXd::Constant(skeleton.n_parameters(), 0.1));
  for (const Eigen::Isometry3d& bone : forward_kinematics(skeleton.skeleton, pose).camera_from_bone)
    require(bone.matrix().allFinite(), "a skeleton that can be posed");
  for (const SkeletoolMarker& marker : skeleton.markers)
    require(marker.bone < skeleton.skeleton.n_bones() && marker.rest_position_mm.allFinite(), "markers of its bones");
  if (files.count("s.motion")) load_skeletool_motion(folder / "s.motion", skeleton.n_parameters());
  if (!files.count("s.skin")) return;
  std::vector<std::string> notes;
  for (float weight : load_skeletool_skin(folder / "s.skin", skeleton, notes).weights)
    require(std::isfinite(weight), "finite weights");
}

}  // namespace

std::vector<std::string> seeds() {
  return {join_files({{"s.skeleton", kSkeleton}, {"s.skin", kSkin}, {"s.motion", kMotion}}),
          join_files({{"s.calibration", kCalibration}})};
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  static const fuzz::ScratchFolder folder;
  const auto files = fuzz::split_files({reinterpret_cast<const char*>(data), size}, fuzz::kFiles);
  for (const auto& [name, bytes] : files) folder.write(name, bytes);
  fuzz::accepts((folder.path() / "s.").string(), [&] { fuzz::read_files(folder.path(), files); });
  return 0;
}

#include "level/capture_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "eval/body_points.h"
#include "image/upright_edges.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr int kLowestSamples = 60;  // rows that tell which vertex is the lowest

constexpr double kKnownTiltRad = 1e-4;  // feet hardly change it

// As the tracker learns it, but of the poses as they are, in all frames, with every ankle believed, and below the
// captured feet, in balance or not. Its tilt is what the capture had at its end, which knew the edges of the room.
std::optional<Floor> learned_floor(const CaptureFolder& capture) {
  FloorOptions options;
  options.balance = no_balance();
  FloorFinder finder(capture.actor, options, std::nullopt);
  // One that is steeper in the picture is learned from feet alone.
  if (const std::optional<FloorPlane>& known = capture.floor; known && known->normal[1] < kUprightY) {
    const auto& [x, y, z] = known->normal;
    finder.set_upright({.up = {x, y, z}, .information = Eigen::Matrix3d::Identity() / std::pow(kKnownTiltRad, 2)});
  }
  Detections seen;
  for (int ankle : {kLeftAnkle, kRightAnkle}) seen.keypoints[ankle].confidence = 1;
  std::optional<Pose> previous;
  for (int64_t row = 0; row < static_cast<int64_t>(capture.rows.size()); ++row) {
    const std::optional<Pose> pose =
        capture.rows[row].tracked() ? captured_pose(capture, row, captured_joints(capture, row)) : std::nullopt;
    if (previous && pose) finder.learn(*previous, *pose, &*pose, seen);
    previous = pose;
  }
  if (!finder.floor()) return std::nullopt;
  return *finder.floor();
}

}  // namespace

CaptureFloor floor_of_level_camera(CaptureFolder& capture) {
  std::vector<int64_t> tracked;
  for (int64_t row = 0; row < static_cast<int64_t>(capture.rows.size()); ++row)
    if (capture.rows[row].tracked()) tracked.push_back(row);
  if (tracked.empty()) throw IoError((capture.path / "frames.csv").string() + ": nobody was tracked in any frame");
  double lowest = -std::numeric_limits<double>::infinity();  // y points down
  const size_t step = std::max<size_t>(1, tracked.size() / kLowestSamples);
  for (size_t k = 0; k < tracked.size(); k += step) {
    const std::vector<float> vertices = captured_vertices(capture, tracked[k]);
    for (size_t i = 1; i < vertices.size(); i += 3) lowest = std::max<double>(lowest, vertices[i]);
  }
  if (!std::isfinite(lowest))
    throw IoError((capture.path / "vertices.pc2").string() + ": has no vertices in any tracked frame");
  return {{-Eigen::Vector3d::UnitY(), lowest}, FloorSource::kLevelCamera};
}

CaptureFloor find_floor(CaptureFolder& capture) {
  if (const std::optional<Floor> floor = measured_floor(capture.camera)) return {*floor, FloorSource::kMeasured};
  if (const std::optional<Floor> floor = learned_floor(capture)) return {*floor, FloorSource::kFeet};
  return floor_of_level_camera(capture);
}

}  // namespace livecap

#include "export/csv.h"

#include <cmath>
#include <numbers>

#include "base/number_text.h"
#include "base/text.h"
#include "export/export_frame.h"
#include "livecap/error.h"

namespace livecap {

CsvWriter::CsvWriter(const std::filesystem::path& path, const std::vector<std::string>& columns)
    : path_(path), file_(path, std::ios::binary | std::ios::trunc), n_columns_(columns.size()) {
  if (!file_) throw IoError(path.string() + ": cannot be written");
  append(columns);
}

void CsvWriter::append(const std::vector<std::string>& cells) {
  if (cells.size() != n_columns_)
    throw LogicError(format("%s: %zu cells in a table of %zu columns", path_.c_str(), cells.size(), n_columns_));
  std::string row;
  for (const std::string& cell : cells) {
    if (!row.empty() || &cell != &cells.front()) row += ',';
    if (cell.find_first_of(",\"\n\r") == std::string::npos) {
      row += cell;
    } else {
      row += '"';
      for (char c : cell) row += c == '"' ? std::string("\"\"") : std::string(1, c);
      row += '"';
    }
  }
  row += '\n';
  file_.write(row.data(), static_cast<std::streamsize>(row.size()));
  file_.flush();
  if (!file_) throw IoError(path_.string() + ": row cannot be written, is the disk full?");
}

std::string csv_number(double value, int digits) {
  return std::isfinite(value) ? general_text(value, digits) : std::string();
}

namespace {

std::vector<std::string> frame_columns(const std::vector<std::string>& stage_names) {
  if (stage_names.size() != kStageCount)
    throw LogicError(format("FramesCsvWriter: %zu stage names for %d stages", stage_names.size(), kStageCount));
  std::vector<std::string> columns = {"index", "pts_ms",      "status",         "score",
                                      "iou",   "pose_energy", "surface_energy", "keypoint_error_px"};
  for (const std::string& stage : stage_names) columns.push_back(stage + "_ms");
  columns.push_back("latency_ms");
  return columns;
}

std::vector<std::string> angle_columns(const Skeleton& skeleton) {
  std::vector<std::string> columns = {"index", "pts_ms", "tracked"};
  for (const Dof& dof : skeleton.dofs) columns.push_back(dof.name);
  return columns;
}

std::vector<std::string> joint_columns(const Actor& actor) {
  std::vector<std::string> columns = {"index", "pts_ms", "tracked"};
  auto add = [&](const std::string& name) {
    for (const char* axis : {"_x", "_y", "_z"}) columns.push_back(name + axis);
  };
  for (const Bone& bone : actor.skeleton.bones) add("joint_" + bone.name);
  for (int k = 0; k < kKeypointCount; ++k) {
    if (actor.keypoints[k].bone >= 0) add("keypoint_" + std::string(kKeypointNames[k]));
  }
  return columns;
}

}  // namespace

FramesCsvWriter::FramesCsvWriter(const std::filesystem::path& path, const std::vector<std::string>& stage_names)
    : csv_(path, frame_columns(stage_names)) {}

void FramesCsvWriter::append(const FrameReport& r, const std::string& status) {
  std::vector<std::string> cells = {std::to_string(r.index),
                                    csv_number(r.pts_ms),
                                    status,
                                    csv_number(r.score, 5),
                                    csv_number(r.iou, 5),
                                    csv_number(r.pose_energy, 7),
                                    csv_number(r.surface_energy, 7),
                                    csv_number(r.keypoint_error_px, 5)};
  for (double ms : r.stage_ms) cells.push_back(csv_number(ms, 5));
  cells.push_back(csv_number(r.latency_ms, 5));
  csv_.append(cells);
}

JointsCsvWriter::JointsCsvWriter(const std::filesystem::path& path, const Actor& actor)
    : skeleton_(actor.skeleton), keypoints_(actor.keypoints), csv_(path, joint_columns(actor)) {}

void JointsCsvWriter::append(int64_t index, double pts_ms, bool tracked, const Pose& pose) {
  std::vector<std::string> cells = {std::to_string(index), csv_number(pts_ms), tracked ? "1" : "0"};
  auto add = [&](const Eigen::Vector3d& camera_mm) {
    const Eigen::Vector3d p = gltf_from_camera(camera_mm);
    for (int k = 0; k < 3; ++k) cells.push_back(csv_number(p[k], 7));
  };
  const PosedSkeleton posed = forward_kinematics(skeleton_, pose);
  for (const Eigen::Isometry3d& bone : posed.camera_from_bone) add(bone.translation());
  for (const KeypointAnchor& anchor : keypoints_) {
    if (anchor.bone >= 0) add(posed.camera_from_rest[anchor.bone] * anchor.rest_position_mm);
  }
  csv_.append(cells);
}

void JointsCsvWriter::append_missing(int64_t index, double pts_ms) {
  std::vector<std::string> cells = {std::to_string(index), csv_number(pts_ms), "0"};
  size_t n_points = skeleton_.bones.size();
  for (const KeypointAnchor& anchor : keypoints_) n_points += anchor.bone >= 0;
  cells.resize(3 + 3 * n_points);
  csv_.append(cells);
}

AnglesCsvWriter::AnglesCsvWriter(const std::filesystem::path& path, const Skeleton& skeleton)
    : n_angles_(skeleton.n_dofs()), csv_(path, angle_columns(skeleton)) {}

void AnglesCsvWriter::append(int64_t index, double pts_ms, bool tracked, const Pose& pose) {
  std::vector<std::string> cells = {std::to_string(index), csv_number(pts_ms), tracked ? "1" : "0"};
  for (int k = 0; k < n_angles_; ++k) cells.push_back(csv_number(pose.angles_rad[k] * 180 / std::numbers::pi, 6));
  csv_.append(cells);
}

void AnglesCsvWriter::append_missing(int64_t index, double pts_ms) {
  std::vector<std::string> cells = {std::to_string(index), csv_number(pts_ms), "0"};
  cells.resize(3 + static_cast<size_t>(n_angles_));
  csv_.append(cells);
}

}  // namespace livecap

// Comparing a capture folder with the ground truth of its sequence (docs/formats.md).
//
// Judged are all frames in which the truth has a person: frames the capture lost count with the result it held, and
// with an IoU of 0 when it held none. Nothing is left out because it went wrong.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "eval/metrics.h"

namespace livecap {

struct EvalOptions {
  std::filesystem::path capture;  // capture folder
  std::filesystem::path truth;    // truth folder: any of vertices.pc2, joints.json, masks/
  std::string actor;              // empty: what report.json names
  std::string camera;             // empty: what report.json names
};

// Values are NaN where the frame has no such truth or no result.
struct FrameEval {
  int64_t index = 0;             // of the input frame
  std::string status;            // of the capture
  bool tracked = false;          // status ok or initialized
  double iou = 0;                // captured mesh against the true mask
  double vertex_mm = 0;          // mean vertex distance
  double vertex_aligned_mm = 0;  // after the best translation of the frame
  double joint_mm = 0;           // mean joint distance
  double joint_aligned_mm = 0;   // after the best similarity transform of the frame
};

struct EvalReport {
  int64_t n_frames = 0;          // rows of the capture
  int64_t n_person = 0;          // of these the truth has a person in: the frames judged
  int64_t n_tracked = 0;         // judged frames with status ok or initialized
  int64_t n_lost = 0;            // judged frames with another status
  int64_t n_without_result = 0;  // judged frames in which the capture has no mesh at all
  int64_t n_invented = 0;        // tracked though the truth has nobody
  Summary iou;                   // over frames
  Summary vertex_mm;             // over all vertices of all frames
  Summary vertex_aligned_mm;
  Summary joint_mm;  // over all joints of all frames
  Summary joint_aligned_mm;
  std::vector<std::pair<std::string, double>> joints_aligned_mm;  // mean of each joint
  std::vector<FrameEval> frames;                                  // the judged ones
};

// Throws IoError naming the file when a folder does not hold what is needed or the sizes do not fit together.
EvalReport evaluate(const EvalOptions& options);

std::string eval_report_text(const EvalReport& report);
// Everything, frames included.
std::string eval_report_json(const EvalReport& report);

}  // namespace livecap

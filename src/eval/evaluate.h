// Comparing a capture folder with the ground truth of its sequence (docs/formats.md, docs/evaluation.md).
//
// Judged are all frames in which the truth has a person: frames the capture lost count with the result it held, and
// with an IoU of 0 when it held none. Nothing is left out because it went wrong.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "eval/capture_folder.h"
#include "eval/extra_view.h"
#include "eval/metrics.h"
#include "eval/motion_metrics.h"
#include "eval/vertex_errors.h"

namespace livecap {

struct EvalOptions {
  std::filesystem::path capture;  // capture folder
  std::filesystem::path truth;    // truth folder: any of vertices.pc2, joints.json, masks/
  std::string actor;              // empty: what report.json names
  std::string camera;             // empty: what report.json names
  std::vector<ExtraView> views;   // further cameras with masks
  std::string truth_actor;  // the mesh of vertices.pc2; empty: actor.glb beside the truth folder, when it is there
  std::function<bool()> go_on{};  // asked once a frame, also where pictures are made of what was compared
};

struct FrameEval {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();  // no such truth, or no result

  int64_t index = 0;                     // of the input frame
  int64_t row = 0;                       // of the capture's tables
  std::string status;                    // of the capture
  bool tracked = false;                  // status ok or initialized
  double iou = kUnknown;                 // captured mesh against the true mask
  double vertex_mm = kUnknown;           // mean vertex distance
  double vertex_aligned_mm = kUnknown;   // after the best translation of the frame
  double loose_aligned_mm = kUnknown;    // the same of the loose garments' vertices
  double joint_mm = kUnknown;            // mean joint distance
  double joint_aligned_mm = kUnknown;    // after the best similarity transform of the frame
  double network_aligned_mm = kUnknown;  // the same of the network's own joints
  bool arms_exchanged = false;           // left and right, see sides_exchanged()
  bool legs_exchanged = false;
  bool limb_inside = false;  // an elbow or wrist in the trunk, see limb_inside_trunk()
};

// 3DPCK at 150 mm and the area under its curve, over all joints of all judged frames; missing results are misses.
struct PckScore {
  double pck = 0;
  double auc = 0;
};

struct ViewScore {
  std::string name;
  Summary iou;  // over frames
};

struct EvalReport {
  std::string run;               // what was unusual about the capture, CaptureFolder::run
  int64_t n_frames = 0;          // rows of the capture
  int64_t n_person = 0;          // of these the truth has a person in: the frames judged
  int64_t n_true_person = 0;     // all that the truth has a person in, with a row or without
  int64_t n_not_asked = 0;       // of these without a row because of the capture's --first or --frames
  int64_t n_tracked = 0;         // judged frames with status ok or initialized
  int64_t n_lost = 0;            // judged frames with another status
  int64_t n_without_result = 0;  // judged frames in which the capture has no mesh, or being a skeleton no joint
  int64_t n_invented = 0;        // tracked though the truth has nobody
  Losses losses;
  Summary iou;  // over frames
  std::vector<ViewScore> views;

  Summary vertex_mm;  // over all vertices of all frames
  Summary vertex_aligned_mm;
  bool other_mesh = false;  // the capture's mesh is not the truth's: true vertices are the points of the true surface
                            // that the actor's vertices lie on at rest (other_mesh.h)
  Summary true_vertex_aligned_mm;  // of another mesh: at the truth's vertices, so that how densely a mesh covers the
                                   // head or the skirt does not count; else as vertex_aligned_mm
  Summary surface_mm;  // captured vertices to the true surface after translation; n = 0: the true mesh is not known
  Summary loose_mm;    // of loose garments (is_loose_garment); n = 0 when the actor wears none
  Summary loose_aligned_mm;
  std::vector<LabelError> labels;
  std::vector<float> vertex_mean_mm;  // [n_vertices] translation-aligned, mean over frames; empty without true vertices

  Summary joint_mm;  // over all joints of all frames
  Summary joint_aligned_mm;
  PckScore pck_similarity;  // after the similarity alignment of the frame; NaN without true joints
  PckScore pck_root;        // with the roots on top of each other, without the root
  std::vector<std::pair<std::string, double>> joints_aligned_mm;  // mean of each joint
  Summary body_point_mm;  // the same points of the body (body_points.h); of the truth's own mesh: as the joints
  Summary body_point_aligned_mm;
  std::vector<std::pair<std::string, double>> body_points_aligned_mm;  // mean of each
  Summary network_joint_mm;  // the network's own joints, from detections.jsonl (network_baseline.h)
  Summary network_joint_aligned_mm;

  double video_fps = 0;
  Jitter vertex_jitter;
  Jitter vertex_jitter_centred;  // of the vertices relative to their centroid: without the body's wobble as a whole
  Jitter joint_jitter;
  FootSlide foot_slide;  // of both ankles
  int64_t n_arms_exchanged = 0;
  int64_t n_legs_exchanged = 0;
  int64_t n_limb_inside = 0;
  double at_limit = 0;  // share of the angles of the judged frames; NaN without angles.csv
  std::vector<std::pair<std::string, double>> angles_at_limit;  // share of each angle that ever is
  CaptureSpeed speed;

  std::vector<FrameEval> frames;  // the judged ones
};

// Throws IoError naming the file when a folder does not hold what is needed, the sizes do not fit together or the truth
// has nobody in any captured frame, Error when go_on says no.
EvalReport evaluate(const EvalOptions& options);
void require_going_on(const EvalOptions& options);

std::string eval_report_text(const EvalReport& report);
// Everything, frames included.
std::string eval_report_json(const EvalReport& report);

}  // namespace livecap

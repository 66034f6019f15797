// The ground truth of a sequence (docs/formats.md), frame by frame.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "base/image_rgb.h"
#include "eval/sequence_files.h"
#include "export/pc2.h"
#include "livecap/camera.h"

namespace livecap {

struct TruthFolder {
  std::filesystem::path path;
  std::optional<Pc2Reader> vertices;
  JointTrack joints;
  std::filesystem::path masks;  // empty: none
};

// n_vertices: of the capture, 0 = it has none. Throws IoError naming the file when there is no truth at all or it is of
// another mesh.
TruthFolder open_truth(const std::filesystem::path& folder, int n_vertices);

// What the truth knows about one frame.
struct TruthFrame {
  std::vector<float> vertices_mm;  // [3*n_vertices] camera frame; empty: nobody, or not known
  std::vector<float> joints_mm;    // [3*n_joints] likewise
  ImageGray mask;                  // empty: not known
  bool person = false;             // by the best truth there is: vertices, else joints, else the mask
};

// Throws IoError when the mask is not of the camera's size.
TruthFrame truth_frame(TruthFolder& truth, int64_t index, const Camera& camera);

// TruthFrame::person alone, of which only the best truth is read.
bool has_person(TruthFolder& truth, int64_t index, const Camera& camera);

// How many frames, from 0 on, the best truth tells of; whether it has an entry of one, be it that nobody is there; and
// which file or folder it is.
int64_t n_true_frames(const TruthFolder& truth);
bool tells_of(const TruthFolder& truth, int64_t index);
std::filesystem::path best_truth(const TruthFolder& truth);

// masks/%06d.png of a frame; empty when there is none. Throws IoError when it is not of the camera's size.
ImageGray read_mask(const std::filesystem::path& folder, int64_t index, const Camera& camera);

}  // namespace livecap

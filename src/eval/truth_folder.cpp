#include "eval/truth_folder.h"

#include <algorithm>
#include <cstdio>

#include "base/is_there.h"
#include "base/text.h"
#include "eval/capture_folder.h"
#include "image/image_io.h"
#include "image/mask_iou.h"
#include "livecap/error.h"

namespace livecap {

namespace fs = std::filesystem;

namespace {

constexpr const char* kMaskName = "%06lld.png";

fs::path mask_file(const fs::path& folder, int64_t index) {
  return folder / format(kMaskName, static_cast<long long>(index));
}

std::vector<float> true_joints(const TruthFolder& truth, int64_t index) {
  if (index >= static_cast<int64_t>(truth.joints.frames.size())) return {};
  return to_camera_mm(truth.joints.frames[index]);
}

bool is_person(const TruthFolder& truth, const TruthFrame& frame) {
  return truth.vertices          ? !frame.vertices_mm.empty()
         : !truth.joints.empty() ? !frame.joints_mm.empty()
                                 : mask_has_person(frame.mask);
}

}  // namespace

TruthFolder open_truth(const fs::path& folder, int n_vertices) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) throw IoError(folder.string() + ": is not a folder");
  TruthFolder truth;
  truth.path = folder;
  if (const fs::path file = folder / "vertices.pc2"; is_there(file)) {
    truth.vertices.emplace(file);
    if (n_vertices > 0 && truth.vertices->n_points() != n_vertices) {
      throw IoError(file.string() + format(": has %d points, the capture has %d; of another mesh give --truth-actor",
                                           truth.vertices->n_points(), n_vertices));
    }
  }
  if (is_there(folder / "joints.json")) truth.joints = read_joints_json(folder / "joints.json");
  if (is_there(folder / "masks") && fs::is_directory(folder / "masks", ignored)) truth.masks = folder / "masks";
  if (!truth.vertices && truth.joints.empty() && truth.masks.empty()) {
    throw IoError(folder.string() + ": holds none of vertices.pc2, joints.json, masks/");
  }
  return truth;
}

ImageGray read_mask(const fs::path& folder, int64_t index, const Camera& camera) {
  if (folder.empty()) return {};
  const fs::path file = mask_file(folder, index);
  if (!is_there(file)) return {};
  ImageGray mask = read_image_gray(file);
  if (mask.width != camera.width || mask.height != camera.height) {
    throw IoError(file.string() +
                  format(": is %dx%d, the camera %dx%d", mask.width, mask.height, camera.width, camera.height));
  }
  return mask;
}

TruthFrame truth_frame(TruthFolder& truth, int64_t index, const Camera& camera) {
  TruthFrame frame{known_sample(truth.vertices, index), true_joints(truth, index),
                   read_mask(truth.masks, index, camera)};
  frame.person = is_person(truth, frame);
  return frame;
}

bool has_person(TruthFolder& truth, int64_t index, const Camera& camera) {
  TruthFrame frame;
  if (truth.vertices)
    frame.vertices_mm = known_sample(truth.vertices, index);
  else if (!truth.joints.empty())
    frame.joints_mm = true_joints(truth, index);
  else
    frame.mask = read_mask(truth.masks, index, camera);
  return is_person(truth, frame);
}

bool tells_of(const TruthFolder& truth, int64_t index) {
  const bool by_masks = !truth.vertices && truth.joints.empty();
  return by_masks ? is_there(mask_file(truth.masks, index)) : index < n_true_frames(truth);
}

fs::path best_truth(const TruthFolder& truth) {
  return truth.vertices ? truth.path / "vertices.pc2" : truth.joints.empty() ? truth.masks : truth.path / "joints.json";
}

int64_t n_true_frames(const TruthFolder& truth) {
  if (truth.vertices) return truth.vertices->n_samples();
  if (!truth.joints.empty()) return static_cast<int64_t>(truth.joints.frames.size());
  int64_t n = 0;
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(truth.masks, code)) {
    long long index = 0;
    if (std::sscanf(entry.path().filename().c_str(), kMaskName, &index) == 1) n = std::max<int64_t>(n, index + 1);
  }
  if (code) throw IoError(truth.masks.string() + ": cannot be listed: " + code.message());
  return n;
}

}  // namespace livecap

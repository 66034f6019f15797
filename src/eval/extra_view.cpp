#include "eval/extra_view.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// How far R^T R may be from the identity: matrices are written with a few digits.
constexpr double kOrthogonal = 1e-3;
constexpr const char* kField = "view_from_camera";

}  // namespace

ExtraView open_view(const std::filesystem::path& camera, const std::filesystem::path& masks) {
  ExtraView view;
  view.name = camera.filename().string();
  view.camera = load_camera(camera);
  view.masks = masks;
  std::error_code ignored;
  if (!std::filesystem::is_directory(masks, ignored)) throw IoError(masks.string() + ": is not a folder");

  const nlohmann::json json = nlohmann::json::parse(read_file(camera), nullptr, false);
  const auto rows = json.find(kField);
  const std::string where = camera.string() + ": field \"" + kField + "\"";
  if (rows == json.end()) throw IoError(where + " is missing: three rows [r,r,r,t], mm");
  if (!rows->is_array() || rows->size() < 3) throw IoError(where + " must be three rows [r,r,r,t], mm");
  Eigen::Matrix<double, 3, 4> matrix;
  for (int i = 0; i < 3; ++i) {
    const nlohmann::json& row = (*rows)[i];
    if (!row.is_array() || row.size() != 4) throw IoError(where + format("[%d] must be four numbers r,r,r,t", i));
    for (int j = 0; j < 4; ++j) {
      if (!row[j].is_number()) throw IoError(where + format("[%d][%d] must be a number", i, j));
      matrix(i, j) = row[j].get<double>();
    }
  }
  const Eigen::Matrix3d rotation = matrix.leftCols<3>();
  if (!matrix.allFinite() || !(rotation * rotation.transpose()).isIdentity(kOrthogonal) || rotation.determinant() < 0) {
    throw IoError(where + " does not begin with a rotation");
  }
  view.view_from_camera.linear() = rotation;
  view.view_from_camera.translation() = matrix.col(3);
  return view;
}

std::vector<float> to_view(const ExtraView& view, std::span<const float> positions_mm) {
  std::vector<float> moved(positions_mm.size());
  for (size_t i = 0; i + 2 < positions_mm.size(); i += 3) {
    const Eigen::Vector3d point =
        view.view_from_camera * Eigen::Vector3d(positions_mm[i], positions_mm[i + 1], positions_mm[i + 2]);
    for (int k = 0; k < 3; ++k) moved[i + k] = static_cast<float>(point[k]);
  }
  return moved;
}

}  // namespace livecap

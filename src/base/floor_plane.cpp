#include "base/floor_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kUnitNormal = 1e-3;
// A camera may look down steeply or be held on its side, but nobody films upside down: such a normal's sign is wrong.
constexpr double kDownY = 0.5;
// Of a camera above its floor. Metres are the likeliest mistake.
constexpr double kLowestMm = 50, kHighestMm = 20000;

}  // namespace

std::string fault_of(const FloorPlane& floor) {
  const auto& n = floor.normal;
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(std::abs(length - 1) <= kUnitNormal))
    return format("floor.normal [%g, %g, %g] has length %g; it must be 1", n[0], n[1], n[2], length);
  if (n[1] > kDownY)
    return format(
        "floor.normal [%g, %g, %g] points down; it must point up, out of the floor (y is below 0 for a level "
        "camera)",
        n[0], n[1], n[2]);
  if (!(floor.distance_mm >= kLowestMm && floor.distance_mm <= kHighestMm))
    return format("floor.distance_mm is %g; it must be %g..%g, the camera's height over the floor in mm",
                  floor.distance_mm, kLowestMm, kHighestMm);
  return {};
}

FloorPlane floor_from_json(const nlohmann::json& value, const std::string& file) {
  const auto is_number = [](const nlohmann::json& number) { return number.is_number(); };
  if (!value.is_object() || !value.contains("normal") || !value["normal"].is_array() || value["normal"].size() != 3 ||
      !std::all_of(value["normal"].begin(), value["normal"].end(), is_number) || !value.contains("distance_mm") ||
      !is_number(value["distance_mm"]))
    throw IoError(file + ": field \"floor\" must be {\"normal\": [x, y, z], \"distance_mm\": number}");
  const FloorPlane floor{value["normal"].get<std::array<double, 3>>(), value["distance_mm"].get<double>()};
  if (const std::string fault = fault_of(floor); !fault.empty()) throw IoError(file + ": " + fault);
  return floor;
}

nlohmann::ordered_json floor_json(const FloorPlane& floor) {
  return {{"normal", floor.normal}, {"distance_mm", floor.distance_mm}};
}

FloorPlane load_floor(const std::filesystem::path& path) {
  const nlohmann::json json = nlohmann::json::parse(read_file(path), nullptr, false);
  if (!json.is_object()) throw IoError(path.string() + ": is no camera.json or report.json: not a JSON object");
  if (!json.contains("floor") || json["floor"].is_null())
    throw IoError(path.string() +
                  ": tells no floor: a capture does once somebody has stood on one, a camera's file once "
                  "it was measured (livecap calibrate --floor)");
  return floor_from_json(json["floor"], path.string());
}

}  // namespace livecap

#include "actor/actor_extras.h"

#include <algorithm>
#include <cmath>

#include "actor/actor.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using nlohmann::json;

constexpr double kMostDegrees = 3600, kMostMetres = 10;

void merge_extras(const json& holder, ActorExtras& extras, const GltfReader& file) {
  if (!holder.is_object() || !holder.contains("extras")) return;
  const json& all = holder["extras"];
  if (!all.is_object() || !all.contains("livecap")) return;
  const json& own = all["livecap"];
  if (!own.is_object()) file.fail("extras.livecap must be an object");
  const auto refuse = [&](const std::string& field, const json& value, const std::string& expected) {
    file.fail("extras.livecap." + field + " is " + one_line(value.dump(), 40) + ", must be " + expected);
  };
  auto each = [&](const char* field, const char* expected, auto&& take) {
    if (!own.contains(field)) return;
    if (!own[field].is_object()) file.fail(std::string("extras.livecap.") + field + " must be an object");
    for (const auto& [key, value] : own[field].items()) {
      if (!take(key, value)) refuse(std::string(field) + "." + key, value, expected);
    }
  };
  auto numbers = [](const json& value, size_t n, double largest) {
    return value.is_array() && value.size() == n && std::all_of(value.begin(), value.end(), [&](const json& v) {
             return v.is_number() && std::abs(v.get<double>()) <= largest;
           });
  };
  const auto flag = [&](const char* field, const char* only) {
    if (!own.contains(field)) return false;
    if (own[field] != only) refuse(field, own[field], std::string("\"") + only + "\"");
    return true;
  };
  extras.guessed_weights |= flag("weights", "guessed");
  extras.rough_shape |= flag("shape", "rough");
  each("bones", "the name of a node", [&](const std::string& key, const json& value) {
    return value.is_string() && (extras.bones.emplace(key, value.get<std::string>()), true);
  });
  each("limits", "[min, max], degrees within 3600", [&](const std::string& key, const json& value) {
    if (!numbers(value, 2, kMostDegrees) || value[0].get<double>() > value[1].get<double>()) return false;
    extras.limits_deg.emplace(key, std::pair{value[0].get<double>(), value[1].get<double>()});
    return true;
  });
  each("markers", "the index of a vertex", [&](const std::string& key, const json& value) {
    if (!value.is_number_integer() || value.get<int64_t>() < 0 || value.get<int64_t>() > kMaxVertices) return false;
    extras.markers.emplace(key, value.get<int>());
    return true;
  });
  each("keypoints", "[x, y, z], metres within 10", [&](const std::string& key, const json& value) {
    if (!numbers(value, 3, kMostMetres)) return false;
    extras.keypoint_offsets_m.emplace(
        key, Eigen::Vector3d(value[0].get<double>(), value[1].get<double>(), value[2].get<double>()));
    return true;
  });
}

}  // namespace

ActorExtras read_actor_extras(const GltfReader& file) {
  ActorExtras extras;
  const json& document = file.document();
  if (document.contains("asset")) merge_extras(document["asset"], extras, file);
  for (const char* list : {"scenes", "meshes", "skins", "nodes"}) {
    if (!document.contains(list) || !document[list].is_array()) continue;
    for (const json& item : document[list]) merge_extras(item, extras, file);
  }
  return extras;
}

}  // namespace livecap

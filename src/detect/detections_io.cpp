#include "detect/detections_io.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::detect {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kNumbers = 6;  // of one keypoint

class LineReader {
 public:
  LineReader(std::string where, const Json& json) : where_(std::move(where)), json_(json) {}

  Detections read() const {
    if (!json_.is_object()) fail("expected a JSON object");
    Detections out;
    const Json& frame = field("frame");
    if (!frame.is_number_integer() ||
        (frame.is_number_unsigned() && frame.get<uint64_t>() > std::numeric_limits<int64_t>::max()))
      fail("field \"frame\" must be a whole number");
    out.frame_index = frame.get<int64_t>();
    if (!field("person").is_boolean()) fail("field \"person\" must be true or false");
    out.person = field("person").get<bool>();
    out.score = number(field("score"), "score");
    if (!out.person) return out;
    const Json& keypoints = field("keypoints");
    if (!keypoints.is_object()) fail("field \"keypoints\" must be an object");
    for (const auto& [name, values] : keypoints.items()) {
      const auto known = std::find(kKeypointNames.begin(), kKeypointNames.end(), name);
      if (known == kKeypointNames.end())
        fail("field \"keypoints\" has an unknown keypoint \"" + one_line(name, 60) + "\"");
      if (!values.is_array() || values.size() != kNumbers)
        fail("keypoint \"" + name + "\" must be a list of 6 numbers");
      float v[kNumbers];
      for (int i = 0; i < kNumbers; ++i) v[i] = number(values[i], name);
      if (v[5] < 0 || v[5] > 1)
        fail(format("keypoint \"%s\": confidence %g must be in 0..1", name.c_str(), double(v[5])));
      out.keypoints[known - kKeypointNames.begin()] = {v[0], v[1], v[2], v[3], v[4], v[5]};
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw IoError(where_ + ": " + what); }
  const Json& field(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end()) fail(std::string("field \"") + name + "\" is missing");
    return *found;
  }
  float number(const Json& value, const std::string& name) const {
    if (!value.is_number() || !std::isfinite(value.get<float>()))
      fail("field \"" + name + "\" must be a finite number");
    return value.get<float>();
  }

  std::string where_;
  const Json& json_;
};

// Shortest text that reads back as the same float.
Json shortest(float value) {
  char text[40];
  for (int digits = 6; digits <= 9; ++digits) {
    std::snprintf(text, sizeof(text), "%.*g", digits, double(value));
    if (std::strtof(text, nullptr) == value) break;
  }
  return std::strtod(text, nullptr);
}

}  // namespace

DetectionsWriter::DetectionsWriter(const std::filesystem::path& path)
    : path_(path), out_(path, std::ios::binary | std::ios::trunc) {
  if (!out_) throw IoError(path.string() + ": cannot be written: " + std::strerror(errno));
}

void DetectionsWriter::append(const Detections& detections) {
  Json json;
  json["frame"] = detections.frame_index;
  json["person"] = detections.person;
  json["score"] = shortest(detections.score);
  json["keypoints"] = Json::object();
  if (detections.person) {
    for (int i = 0; i < kKeypointCount; ++i) {
      const KeypointDetection& k = detections.keypoints[i];
      json["keypoints"][std::string(kKeypointNames[i])] = {shortest(k.x_px), shortest(k.y_px), shortest(k.x_mm),
                                                           shortest(k.y_mm), shortest(k.z_mm), shortest(k.confidence)};
    }
  }
  out_ << json.dump() << '\n';
  out_.flush();
  if (!out_) throw IoError(path_.string() + ": write failed: " + std::strerror(errno));
}

std::vector<Detections> load_detections(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  std::vector<Detections> result;
  int line_number = 0;
  for (size_t start = 0; start < text.size();) {
    const size_t end = std::min(text.find('\n', start), text.size());
    const std::string line = text.substr(start, end - start);
    start = end + 1;
    ++line_number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string where = path.string() + format(":%d", line_number);
    Json json;
    try {
      json = Json::parse(line);
    } catch (const nlohmann::json::exception&) {
      throw IoError(where + ": not valid JSON (a truncated line?)");
    }
    Detections detections = LineReader(where, json).read();
    if (!result.empty() && detections.frame_index <= result.back().frame_index)
      throw IoError(where + format(": field \"frame\" is %lld after %lld, must rise",
                                   static_cast<long long>(detections.frame_index),
                                   static_cast<long long>(result.back().frame_index)));
    result.push_back(std::move(detections));
  }
  return result;
}

}  // namespace livecap::detect

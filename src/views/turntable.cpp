#include "views/turntable.h"

#include <algorithm>
#include <cmath>

#include "base/median.h"
#include "base/text.h"
#include "detect/pose_detector.h"
#include "image/undistort.h"
#include "image/video.h"
#include "image/video_camera.h"
#include "livecap/error.h"
#include "views/fit_turn.h"
#include "views/load_views.h"

namespace livecap {

namespace {

constexpr double kDegree = M_PI / 180;
constexpr double kFullTurn = 2 * M_PI;
constexpr double kStillTurn = 60 * kDegree;    // less is no turn at all
constexpr double kNearlyFull = 350 * kDegree;  // the gap that may be left
constexpr double kHiddenTurn = 25 * kDegree;   // the network's error of a direction
constexpr double kBackwards = 40 * kDegree;    // more than the network's unsteadiness
constexpr double kMostNotWhole = 0.2;          // of the turn's frames
constexpr double kWidestGap = 20 * kDegree;    // in which a part of the person is outside
constexpr int kLeastFrames = 16;
constexpr double kBlurred = 0.4;  // of the usual sharpness

Camera open_camera(const TurntableOptions& options, const VideoInfo& video, std::vector<std::string>& notes) {
  const bool assumed = options.camera.empty() && options.fov_deg <= 0;
  if (assumed)
    notes.push_back(format("no --camera and no --fov: a field of view of %g degrees is assumed for the longer side",
                           kAssumedFovDeg));
  return video_camera(options.camera, assumed ? kAssumedFovDeg : options.fov_deg, video, options.video);
}

// All keypoints are inside the picture, also those the network only guesses.
bool is_whole(const Detections& detections, const Camera& camera) {
  return std::all_of(detections.keypoints.begin(), detections.keypoints.end(), [&](const KeypointDetection& point) {
    return point.x_px >= 0 && point.y_px >= 0 && point.x_px < camera.width && point.y_px < camera.height;
  });
}

double wrapped(double angle) {
  return std::remainder(angle, kFullTurn);
}

// Without jumps of a full turn, a median over five; by sample that shows all of them.
std::vector<double> unwrapped(const std::vector<TurnSample>& samples, const std::vector<int>& seen) {
  std::vector<double> raw;
  const int n = static_cast<int>(seen.size());
  for (int i = 0; i < n; ++i) {
    const double last = raw.empty() ? samples[seen[0]].facing_rad : raw.back();
    const auto jump = [&](int k) { return wrapped(samples[seen[k]].facing_rad - last); };
    // A jump that is taken back within some frames is the network's.
    bool wrong = false;
    for (int k = i + 1; std::abs(jump(i)) > M_PI / 2 && k < std::min(n, i + 6) && !wrong; ++k)
      wrong = std::abs(jump(k)) < M_PI / 2;
    raw.push_back(wrong ? last : last + jump(i));
  }
  std::vector<double> smooth = raw;
  for (int i = 0; i < n; ++i) {
    const int reach = std::min({2, i, n - 1 - i});
    smooth[i] = median(std::vector<double>(raw.begin() + i - reach, raw.begin() + i + reach + 1));
  }
  return smooth;
}

// The network is up to 25 degrees off, the same way whenever the person faces the same way. What fits one rigid body is
// far nearer: samples between the chosen ones get the angle between theirs.
void use_fitted_angles(const Camera& camera, const std::vector<Detections>& detections, const std::vector<int>& chosen,
                       const std::vector<double>& angle_rad, std::vector<TurnSample>& samples) {
  std::vector<Detections> kept;
  for (int i : chosen) kept.push_back(detections[i]);
  const std::vector<double> fitted = fit_keypoint_turn(camera, kept, angle_rad).angle_rad;
  const int last = static_cast<int>(chosen.size()) - 1;
  for (int i = 0; i < static_cast<int>(samples.size()); ++i) {
    const int next = static_cast<int>(std::lower_bound(chosen.begin(), chosen.end(), i) - chosen.begin());
    if (next == 0 || next > last) {
      const int end = std::min(next, last);
      samples[i].facing_rad += fitted[end] - angle_rad[end];
      continue;
    }
    const double share = static_cast<double>(i - chosen[next - 1]) / (chosen[next] - chosen[next - 1]);
    samples[i].facing_rad = fitted[next - 1] + share * (fitted[next] - fitted[next - 1]);
  }
}

// From behind the network may see one direction while the person turns by twenty degrees, over which no point of the
// clothes can be followed. Where the chosen are much farther apart in time than usual, some between are chosen as well,
// as many as kHiddenTurn needs: it may also be that the person paused. Indices into `seen`.
void fill_pauses(const std::vector<TurnSample>& samples, const std::vector<int>& seen, int n_views,
                 std::vector<int>& chosen) {
  std::vector<int> steps;
  for (size_t k = 1; k < chosen.size(); ++k) steps.push_back(chosen[k] - chosen[k - 1]);
  const int usual = std::max(1, median(steps)), most = static_cast<int>(std::ceil(kHiddenTurn / kFullTurn * n_views));
  std::vector<int> filled;
  for (int to : chosen) {
    const int from = filled.empty() ? to : filled.back();
    const int n_between = to - from > 2 * usual ? std::min(most, (to - from + usual / 2) / usual - 1) : 0;
    for (int k = 1; k <= n_between; ++k) {
      const auto at = seen.begin() + from + (to - from) * k / (n_between + 1);
      const auto sharpest = std::max_element(at - usual / 3, at + usual / 3 + 1,
                                             [&](int a, int b) { return samples[a].sharpness < samples[b].sharpness; });
      filled.push_back(static_cast<int>(sharpest - seen.begin()));
    }
    filled.push_back(to);
  }
  chosen = std::move(filled);
}

// The detector for a person who is the same from frame to frame, but no filter that lags behind.
detect::PoseDetectorOptions detector_options(const std::string& model) {
  detect::PoseDetectorOptions options;
  options.model = model;
  options.mask = options.filter = options.drop_jumps = options.correct_posture = options.alternate_mirror = false;
  return options;
}

}  // namespace

void TurntableOptions::validate() const {
  if (video.empty()) throw ConfigError("--video is needed");
  if (is_webcam(video)) throw ConfigError("--video " + video + ": record it first; it is read twice");
  if (!camera.empty() && fov_deg > 0) throw ConfigError("give either --camera or --fov");
  if (n_views < kMinViews || n_views > 400)
    throw ConfigError(format("--views %d; must be within %d..400", n_views, kMinViews));
}

double facing_rad(const Detections& detections) {
  double x = 0, z = 0;
  for (const auto& [left, right] : {std::pair{kLeftHip, kRightHip}, {kLeftShoulder, kRightShoulder}}) {
    const KeypointDetection &a = detections.keypoints[left], &b = detections.keypoints[right];
    const double dx = a.x_mm - b.x_mm, dz = a.z_mm - b.z_mm, length = std::hypot(dx, dz);
    if (length > 0) x += dx / length, z += dz / length;
  }
  return std::atan2(z, x);
}

std::vector<int> choose_turn(const std::vector<TurnSample>& samples, int n_views, const std::string& what,
                             std::vector<double>& angle_rad) {
  std::vector<int> seen;
  bool anybody = false;
  for (size_t i = 0; i < samples.size(); ++i) {
    anybody |= samples[i].person;
    if (samples[i].whole) seen.push_back(static_cast<int>(i));
  }
  const int n = static_cast<int>(seen.size());
  if (!anybody) throw ConfigError(what + ": the network sees nobody in its frames");
  if (n == 0) throw ConfigError(what + ": no frame shows all of the person, from head to feet and with both arms");
  const auto require_few = [&](int n_cut, int n_frames) {  // where too little of a turn is seen
    if (n_cut > kMostNotWhole * n_frames)
      throw ConfigError(what + format(": the person leaves the picture: %d of %d frames do not show all of them, from "
                                      "head to feet and with both arms",
                                      n_cut, n_frames));
  };
  std::vector<double> turned = unwrapped(samples, seen);
  const auto [low, high] = std::minmax_element(turned.begin(), turned.end());
  if (*high - *low < kStillTurn) {
    const auto n_people = static_cast<int>(
        std::count_if(samples.begin(), samples.end(), [](const TurnSample& sample) { return sample.person; }));
    require_few(n_people - n, n_people);
    throw ConfigError(what +
                      format(": the person does not turn (%.0f degrees); one full turn before a static camera is "
                             "needed",
                             (*high - *low) / kDegree));
  }
  const double sign = high > low ? 1 : -1;
  for (double& angle : turned) angle *= sign;

  // The longest turn, or the quickest one all around.
  double most = 0;
  int begin = 0, end = 0;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      const double angle = std::min(turned[j] - turned[i], kFullTurn);
      const bool shorter = angle == most && j - i < end - begin;
      if (angle > most || shorter) most = angle, begin = i, end = j;
      if (angle >= kFullTurn) break;
    }
  if (most < kNearlyFull) {
    require_few(static_cast<int>(samples.size()) - n, static_cast<int>(samples.size()));
    throw ConfigError(what + format(": the person turns by only %.0f degrees; a full turn is needed", most / kDegree));
  }
  double highest = turned[begin], back = 0, gap = 0;
  for (int i = begin; i <= end; ++i) {
    highest = std::max(highest, turned[i]);
    back = std::max(back, highest - turned[i]);
    if (i > begin && seen[i] > seen[i - 1] + 1) gap = std::max(gap, turned[i] - turned[i - 1]);
  }
  const int n_frames = seen[end] - seen[begin] + 1, n_cut = n_frames - (end - begin + 1);
  if (n_cut > kMostNotWhole * n_frames || gap > kWidestGap)
    throw ConfigError(what + format(": the person leaves the picture: %d of the turn's %d frames do not show all of "
                                    "them, from head to feet and with both arms",
                                    n_cut, n_frames));
  if (back > kBackwards)
    throw ConfigError(what +
                      format(": the person turns back by %.0f degrees on the way; turn one way only", back / kDegree));

  std::vector<int> best(n_views, -1);
  for (int i = begin; i <= end; ++i) {
    const TurnSample& sample = samples[seen[i]];
    const double side = (turned[i] - turned[begin]) / most * n_views;
    const int bin = static_cast<int>(side);
    if (bin < 0 || bin >= n_views || std::abs(side - bin - 0.5) > 0.4) continue;
    if (best[bin] < 0 || sample.sharpness > samples[seen[best[bin]]].sharpness) best[bin] = i;
  }
  std::vector<int> chosen;  // of the samples seen
  for (int i : best)
    if (i >= 0 && (chosen.empty() || i > chosen.back())) chosen.push_back(i);  // the order of the video
  fill_pauses(samples, seen, n_views, chosen);
  angle_rad.clear();
  for (int& i : chosen) {
    angle_rad.push_back(sign * turned[i]);
    i = seen[i];
  }
  if (static_cast<int>(chosen.size()) < std::min(kLeastFrames, n_views - n_views / 4))
    throw ConfigError(
        what + format(": only %zu frames of the turn are usable; turn slower, in ten seconds or more", chosen.size()));
  return chosen;
}

TurntableViews read_turntable(ocl::DeviceContext& device, const std::string& model, const TurntableOptions& options,
                              std::vector<std::string>& notes, const std::function<void(int, int)>& progress) {
  options.validate();
  std::vector<TurnSample> samples;
  std::vector<Detections> detections;
  std::vector<int64_t> frame_of;
  Camera camera;
  int stride = 1, total = options.max_looked_at;
  {
    VideoReader video(options.video);
    const VideoInfo info = video.info();
    camera = open_camera(options, info, notes);
    if (info.frame_count_hint > 0) {
      stride = static_cast<int>((info.frame_count_hint + options.max_looked_at - 1) / options.max_looked_at);
      total = static_cast<int>(info.frame_count_hint);
    }
    const Undistorter undistorter(camera);
    detect::PoseDetector detector(device, detector_options(model));
    Frame frame;
    while (static_cast<int>(samples.size()) < 4 * options.max_looked_at && video.read(frame)) {
      if (frame.damaged || frame.index % stride != 0) continue;
      progress(std::min(static_cast<int>(frame.index), total), total);
      const ImageRgb image = undistorter.undistort(std::move(frame.image));
      const Detections seen =
          detector.detect(image, undistorter.undistorted_camera(), frame.index, frame.pts_ms / 1000);
      TurnSample sample;
      sample.person = seen.person;
      sample.whole = seen.person && is_whole(seen, camera);
      sample.facing_rad = seen.person ? facing_rad(seen) : 0;
      sample.sharpness = sample.whole ? sharpness(image) : 0;
      samples.push_back(sample);
      detections.push_back(seen);
      frame_of.push_back(frame.index);
    }
  }
  TurntableViews result;
  std::vector<double> angles;
  std::vector<int> chosen = choose_turn(samples, options.n_views, options.video, angles);
  use_fitted_angles(Undistorter(camera).undistorted_camera(), detections, chosen, angles, samples);
  chosen = choose_turn(samples, options.n_views, options.video, angles);
  std::vector<double> sharp;
  for (int i : chosen) sharp.push_back(samples[i].sharpness);
  const double usual = median(sharp);
  int n_blurred = 0;
  size_t next = 0;
  VideoReader video(options.video);
  Frame frame;
  while (next < chosen.size() && video.read(frame)) {
    if (frame.index != frame_of[chosen[next]]) continue;
    if (samples[chosen[next]].sharpness < kBlurred * usual) {
      ++n_blurred;
    } else {
      result.views.push_back(
          view_of(format("frame %lld", static_cast<long long>(frame.index)), frame.image, camera, options.max_side_px));
      result.angle_rad.push_back(angles[next]);
    }
    ++next;
  }
  if (n_blurred > 0) notes.push_back(format("%d frames of the turn are blurred; left out", n_blurred));
  if (static_cast<int>(result.views.size()) < kMinViews)
    throw ConfigError(options.video + format(": only %zu frames of the turn are sharp", result.views.size()));
  return result;
}

}  // namespace livecap

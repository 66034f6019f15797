// write_sequence of synth.h.
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <system_error>

#include "actor/height_range.h"
#include "base/text.h"
#include "base/timer.h"
#include "image/image_io.h"
#include "image/video.h"
#include "livecap/error.h"
#include "synth/actor_model.h"
#include "synth/cloth.h"
#include "synth/motion.h"
#include "synth/numbered_files.h"
#include "synth/renderer.h"
#include "synth/scenario.h"
#include "synth/synth.h"

namespace livecap {

namespace {

using namespace synth;

constexpr char kMaskName[] = "%06d.png";

View make_view(const SynthOptions& options) {
  View view;
  view.camera = camera_from_fov(options.width, options.height, options.fov_deg);
  // At the given height, looking at the middle of the actor's reach.
  const Vec3 eye(0, options.camera_height_mm, options.distance_mm), goal(0, 0.585 * options.height_mm, 0);
  const Vec3 forward = (goal - eye).normalized(), right = forward.cross(Vec3::UnitY()).normalized();
  Eigen::Matrix3d rotation;
  rotation.row(0) = right;
  rotation.row(1) = forward.cross(right);
  rotation.row(2) = forward;
  rotation = Eigen::AngleAxisd(options.camera_roll_deg * M_PI / 180, Vec3::UnitZ()).toRotationMatrix() * rotation;
  view.camera_from_room_rotation = rotation;
  view.camera_from_room_translation = -rotation * eye;
  if (options.floor) {
    const Vec3 up = rotation * Vec3::UnitY();
    view.camera.floor = FloorPlane{{up.x(), up.y(), up.z()}, eye.y()};
  }
  return view;
}

// Camera frame (OpenCV axes, mm) -> glTF (metres, Y up).
Vec3 gltf_from_camera(const Vec3& p) {
  return Vec3(p.x(), -p.y(), -p.z()) / 1000;
}

void write_bytes(std::ofstream& out, const void* data, size_t bytes, const std::filesystem::path& path) {
  if (!out.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes)))
    throw IoError(path.string() + ": cannot be written; is the disk full?");
}

// PC2 point cache, one sample per frame (docs/formats.md); valid after every frame.
class TruthVertices {
 public:
  TruthVertices(const std::filesystem::path& path, int n_points)
      : path_(path), n_points_(n_points), out_(path, std::ios::binary) {
    if (!out_) throw IoError(path.string() + ": cannot be created");
    const int32_t version = 1, points = n_points, samples = 0;
    const float start = 0, rate = 1;
    write_bytes(out_, "POINTCACHE2\0", 12, path_);
    write_bytes(out_, &version, 4, path_);
    write_bytes(out_, &points, 4, path_);
    write_bytes(out_, &start, 4, path_);
    write_bytes(out_, &rate, 4, path_);
    write_bytes(out_, &samples, 4, path_);
  }

  // room: empty for a frame without a person.
  void append(const View& view, const std::vector<Vec3>& room) {
    std::vector<float> row(3 * static_cast<size_t>(n_points_), std::numeric_limits<float>::quiet_NaN());
    for (size_t i = 0; i < room.size(); ++i) {
      const Vec3 p = gltf_from_camera(view.to_camera(room[i]));
      for (int k = 0; k < 3; ++k) row[3 * i + k] = static_cast<float>(p[k]);
    }
    write_bytes(out_, row.data(), row.size() * sizeof(float), path_);
    ++n_samples_;
    out_.seekp(kCountOffset);
    write_bytes(out_, &n_samples_, 4, path_);
    out_.seekp(0, std::ios::end);
  }

  void close() {
    out_.close();
    if (!out_) throw IoError(path_.string() + ": cannot be written; is the disk full?");
  }

 private:
  static constexpr int kCountOffset = 28;
  std::filesystem::path path_;
  int n_points_;
  int32_t n_samples_ = 0;
  std::ofstream out_;
};

nlohmann::json joints_row(const View& view, const BonePose& pose) {
  nlohmann::json row = nlohmann::json::array();
  for (const Vec3& origin : pose.origins) {
    const Vec3 p = gltf_from_camera(view.to_camera(origin));
    row.push_back({std::round(p.x() * 1e5) / 1e5, std::round(p.y() * 1e5) / 1e5, std::round(p.z() * 1e5) / 1e5});
  }
  return row;
}

// NumPy .npy, version 1, one byte per vertex.
std::string labels_npy(const std::vector<uint8_t>& labels) {
  std::string header = format("{'descr': '|u1', 'fortran_order': False, 'shape': (%zu,), }", labels.size());
  header.resize((10 + header.size() + 1 + 63) / 64 * 64 - 10 - 1, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 255);
  bytes += static_cast<char>(header.size() >> 8);
  return bytes + header + std::string(labels.begin(), labels.end());
}

// Truth of one frame: bones and cloth surface, room frame.
struct Performance {
  BonePose pose;
  std::vector<Vec3> vertices;
  std::vector<Vec3> skinned;
};

class Performer {
 public:
  Performer(const ActorModel& actor, const SynthOptions& options)
      : actor_(actor), cloth_(actor), use_cloth_(options.cloth), fps_(options.fps) {}

  const ActorModel& actor() const { return actor_; }
  const std::vector<int>& cloth_vertices() const { return cloth_.vertices(); }

  // The next frame.
  Performance perform(const Posture& posture) {
    Performance now;
    now.pose = pose_of(posture, actor_.joints, actor_.scale);
    now.skinned = skin_vertices(actor_.surface.vertices, actor_.weights, actor_.joints, now.pose);
    now.vertices = now.skinned;
    if (!use_cloth_) return now;
    if (!started_) {
      cloth_.reset(now.skinned, now.pose);
      for (int i = 0; i < 30; ++i) cloth_.step(now.skinned, now.pose, 1 / 30.0);  // let it settle
      started_ = true;
    }
    now.vertices = cloth_.step(now.skinned, now.pose, 1 / fps_);
    return now;
  }

 private:
  const ActorModel& actor_;
  Cloth cloth_;
  bool use_cloth_;
  double fps_;
  bool started_ = false;
};

// Who is there in one frame; the first of `people` is the one the truth is about.
struct Moment {
  struct Person {
    const ActorModel* actor;
    Performance performance;
  };
  std::vector<Person> people;
  MovingShadow shadow;
};

// The sequence's stage direction: calls each frame in order.
class Play {
 public:
  Play(const SynthOptions& options, const ActorModel& actor)
      : options_(options),
        scenario_(scenario_from_name(options.scenario)),
        postures_(make_motion(options.motions, options.fps, options.crouch_deg * M_PI / 180)),
        first_(actor, options) {
    if (scenario_ != Scenario::kTwoPeople) return;
    const std::string other = options.actor == "skirt" ? "trousers" : "skirt";
    second_actor_.emplace(build_actor(other, options.height_mm, 5000));
    second_.emplace(*second_actor_, options);
    second_postures_ = make_motion({"walk"}, options.fps);
  }

  int n_postures() const { return static_cast<int>(postures_.size()); }
  const std::vector<int>& cloth_vertices() const { return first_.cloth_vertices(); }

  // frame: since the first person's first; the motion starts again when it ends.
  Moment next(int frame) {
    const double t = frame / options_.fps;
    Moment moment;
    Posture posture = postures_[frame % postures_.size()];
    if (scenario_ == Scenario::kLeave) leave_and_return(t, out_mm(0), posture);
    moment.people.push_back({&first_.actor(), first_.perform(posture)});
    if (second_) {
      const auto passing = passer_by(t, out_mm(kPasserByZ), second_postures_[frame % second_postures_.size()]);
      if (passing) moment.people.push_back({&*second_actor_, second_->perform(*passing)});
    }
    if (scenario_ == Scenario::kMovingShadow) moment.shadow = moving_shadow(t);
    return moment;
  }

  bool left_out(int frame) const { return scenario_ == Scenario::kGap && is_left_out(frame / options_.fps); }

 private:
  // How far to the side a person at depth z is out of the picture: half of what it shows there and an arm.
  double out_mm(double z) const {
    const Camera camera = camera_from_fov(options_.width, options_.height, options_.fov_deg);
    return 0.5 * camera.width / camera.fx * (options_.distance_mm - z) + 0.28 * options_.height_mm;
  }

  SynthOptions options_;
  Scenario scenario_;
  std::vector<Posture> postures_, second_postures_;
  Performer first_;
  std::optional<ActorModel> second_actor_;
  std::optional<Performer> second_;
};

struct Picture {
  ImageRgb rgb;
  ImageGray mask;             // what is to be seen of the first person
  bool shows_person = false;  // something of the first person is inside the picture, covered or not
};

Picture take_picture(const View& view, const Lighting& lighting, const Plate& empty, const Moment& moment,
                     const Sensor& sensor) {
  const int width = view.camera.width, height = view.camera.height;
  Picture picture;
  picture.mask = {width, height, std::vector<uint8_t>(static_cast<size_t>(width) * height, 0)};
  if (moment.people.empty()) {
    picture.rgb = expose(empty.lit, width, height, sensor);
    return picture;
  }
  Plate plate = empty;
  if (moment.shadow.strength > 0) darken(moment.shadow, plate);
  for (const auto& person : moment.people) add_shadow(lighting, *person.actor, person.performance.vertices, plate);
  // Whoever's hips are nearer to the camera covers the other.
  std::vector<size_t> order(moment.people.size());
  std::iota(order.begin(), order.end(), 0);
  const auto depth = [&](size_t i) { return view.to_camera(moment.people[i].performance.pose.origins[kHips]).z(); };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return depth(a) > depth(b); });
  std::vector<Color>& linear = plate.lit;
  std::vector<float> seen(linear.size(), 0);  // share of each pixel that shows the first person
  for (size_t who : order) {
    const auto& person = moment.people[who];
    const PersonLayer layer = render_person(view, lighting, *person.actor, person.performance.vertices, moment.shadow);
    for (size_t i = 0; i < linear.size(); ++i) {
      if (layer.covered[i] == 0) continue;
      const float share = static_cast<float>(layer.covered[i]) / kSamples;
      linear[i] = (1 - share) * linear[i] + layer.color[i] / kSamples;
      seen[i] = (1 - share) * seen[i] + (who == 0 ? share : 0);
      if (who == 0) picture.shows_person = true;
    }
  }
  for (size_t i = 0; i < seen.size(); ++i) picture.mask.pixels[i] = seen[i] >= 0.5f ? 255 : 0;
  picture.rgb = expose(linear, width, height, sensor);
  return picture;
}

// name: of the option of `livecap synth`; of the field where there is none.
void require_within(const char* name, double value, double least, double most, const char* unit = "") {
  if (!(value >= least && value <= most))
    throw ConfigError(format("synth: %s %g: must be between %g and %g%s", name, value, least, most, unit));
}

}  // namespace

void SynthOptions::validate() const {
  outfit_from_name(actor);
  physique.validate();
  require_within("--height", height_mm / 1000, kActorHeightMm.least / 1000, kActorHeightMm.most / 1000, " metres");
  if (motions.empty()) throw ConfigError("synth: --motion: name at least one");
  make_motion(motions, 1);
  require_within("--crouch", crouch_deg, 0, 40, " degrees");
  scenario_from_name(scenario);
  for (const auto& [name, value] : {std::pair{"--width", width}, {"--picture-height", height}}) {
    require_within(name, value, 64, 4096, " px");
    if (value % 2 != 0) throw ConfigError(format("synth: %s %d: must be even", name, value));
  }
  require_within("--fps", fps, 1, 240);
  require_within("--frames", n_frames, 0, 100000);
  require_within("--empty-frames", empty_frames, 0, 10000);
  require_within("--fov", fov_deg, 10, 120, " degrees");
  require_within("--distance", distance_mm / 1000, 1, 20, " metres");
  require_within("camera_height_mm", camera_height_mm, 100, 5000);
  require_within("camera_roll_deg", camera_roll_deg, -45, 45);
  require_within("--noise", noise, 0, 50);
  require_within("gain_drift", gain_drift, 0, 0.5);
  require_within("blur_px", blur_px, 0, 10);
}

SynthReport write_sequence(const SynthOptions& options, const std::filesystem::path& folder,
                           const SynthProgress& progress) {
  options.validate();
  const auto masks = folder / "truth" / "masks";
  std::error_code error;
  std::filesystem::create_directories(masks, error);
  if (error) throw IoError(masks.string() + ": cannot be created: " + error.message());

  ActorModel actor = build_actor(options.actor, options.height_mm, 5000);
  apply_physique(options.physique, actor);
  write_file_atomically(folder / "actor.glb", actor_glb(actor));
  write_file_atomically(folder / "truth" / "labels.npy", labels_npy(actor.labels));
  const View view = make_view(options);
  save_camera(view.camera, folder / "camera.json");
  const Lighting lighting;
  std::optional<Wallpaper> wallpaper;
  if (scenario_from_name(options.scenario) == Scenario::kSimilarBackground) wallpaper = clothes_wallpaper(actor);
  const Plate plate = render_plate(view, lighting, options.seed, wallpaper);
  write_png(expose(plate.lit, options.width, options.height, {options.blur_px, 0, 1, 0}), folder / "background.png");

  Play play(options, actor);
  SynthReport report;
  const int n_frames = options.n_frames > 0 ? options.n_frames : options.empty_frames + play.n_postures();
  report.n_vertices = static_cast<int>(actor.surface.vertices.size());
  VideoWriter video((folder / "video.mp4").string(), options.width, options.height, options.fps);
  TruthVertices truth(folder / "truth" / "vertices.pc2", report.n_vertices);
  nlohmann::json joints;
  for (const auto& bone : kBones) joints["names"].push_back(bone.name);
  std::vector<float> swing;
  double render_ms = 0;
  for (int frame = 0; frame < n_frames; ++frame) {
    if (progress && !progress(frame, n_frames)) break;
    Moment moment;
    if (frame >= options.empty_frames) moment = play.next(frame - options.empty_frames);
    if (!moment.people.empty() && play.left_out(frame - options.empty_frames)) {
      video.skip(1);
      continue;
    }
    const double seconds = frame / options.fps;
    const Sensor sensor{options.blur_px, options.noise, 1 + options.gain_drift * std::sin(2 * M_PI * seconds / 4.3),
                        options.seed * 1000003 + frame};
    const Timer timer;
    const Picture picture = take_picture(view, lighting, plate, moment, sensor);
    render_ms += timer.elapsed_ms();
    video.write(picture.rgb);
    write_png(picture.mask, masks / format(kMaskName, report.n_frames));
    const Performance now = picture.shows_person ? moment.people.front().performance : Performance{};
    truth.append(view, now.vertices);
    joints["frames"].push_back(picture.shows_person ? joints_row(view, now.pose) : nlohmann::json());
    if (picture.shows_person)
      for (int i : play.cloth_vertices())
        swing.push_back(static_cast<float>((now.vertices[i] - now.skinned[i]).norm()));
    ++report.n_frames;
  }
  remove_numbered_from(report.n_frames, masks, kMaskName);
  video.close();
  truth.close();
  write_file_atomically(folder / "truth" / "joints.json", joints.dump());

  if (report.n_frames > 0) report.render_ms_per_frame = render_ms / report.n_frames;
  if (!swing.empty()) {
    for (float d : swing) report.cloth_mean_mm += d / static_cast<double>(swing.size());
    auto p95 = swing.begin() + static_cast<std::ptrdiff_t>(0.95 * (swing.size() - 1));
    std::nth_element(swing.begin(), p95, swing.end());
    report.cloth_p95_mm = *p95;
  }
  return report;
}

}  // namespace livecap

// write_sequence of synth.h.
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/text.h"
#include "base/timer.h"
#include "image/image_io.h"
#include "image/video.h"
#include "livecap/error.h"
#include "synth/actor_model.h"
#include "synth/cloth.h"
#include "synth/motion.h"
#include "synth/renderer.h"
#include "synth/synth.h"

namespace livecap {

namespace {

using namespace synth;

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

struct Picture {
  ImageRgb rgb;
  ImageGray mask;
};

// vertices: empty for a frame without a person.
Picture take_picture(const View& view, const Lighting& lighting, const Plate& plate, const ActorModel& actor,
                     const std::vector<Vec3>& vertices, const Sensor& sensor) {
  const int width = view.camera.width, height = view.camera.height;
  Picture picture;
  picture.mask = {width, height, std::vector<uint8_t>(static_cast<size_t>(width) * height, 0)};
  if (vertices.empty()) {
    picture.rgb = expose(plate.lit, width, height, sensor);
    return picture;
  }
  std::vector<Color> linear = shadowed_plate(plate, lighting, actor, vertices);
  const PersonLayer person = render_person(view, lighting, actor, vertices);
  for (size_t i = 0; i < linear.size(); ++i) {
    if (person.covered[i] == 0) continue;
    const float share = static_cast<float>(person.covered[i]) / kSamples;
    linear[i] = (1 - share) * linear[i] + person.color[i] / kSamples;
    picture.mask.pixels[i] = 2 * person.covered[i] >= kSamples ? 255 : 0;
  }
  picture.rgb = expose(linear, width, height, sensor);
  return picture;
}

// Truth of one frame: bones and cloth surface, room frame.
struct Performance {
  BonePose pose;
  std::vector<Vec3> vertices;
  std::vector<Vec3> skinned;
};

class Performer {
 public:
  Performer(const SynthOptions& options, const ActorModel& actor)
      : actor_(actor),
        cloth_(actor),
        use_cloth_(options.cloth),
        fps_(options.fps),
        postures_(make_motion(options.motions, options.fps)) {}

  int n_postures() const { return static_cast<int>(postures_.size()); }
  const std::vector<int>& cloth_vertices() const { return cloth_.vertices(); }

  // Frames in order from 0; the motion starts again when it ends.
  Performance perform(int frame) {
    Performance now;
    now.pose = pose_of(postures_[frame % postures_.size()], actor_.joints, actor_.scale);
    now.skinned = skin_vertices(actor_.surface.vertices, actor_.weights, actor_.joints, now.pose);
    now.vertices = now.skinned;
    if (!use_cloth_) return now;
    if (frame == 0) {
      cloth_.reset(now.skinned, now.pose);
      for (int i = 0; i < 60; ++i) cloth_.step(now.skinned, now.pose, 1 / 30.0);  // let it settle
    }
    now.vertices = cloth_.step(now.skinned, now.pose, 1 / fps_);
    return now;
  }

 private:
  const ActorModel& actor_;
  Cloth cloth_;
  bool use_cloth_;
  double fps_;
  std::vector<Posture> postures_;
};

void require(bool ok, const std::string& message) {
  if (!ok) throw ConfigError("synth: " + message);
}

}  // namespace

void SynthOptions::validate() const {
  outfit_from_name(actor);
  require(height_mm >= 500 && height_mm <= 3000, format("height_mm is %g; it must be within 500..3000", height_mm));
  require(!motions.empty(), "motions is empty; name at least one");
  make_motion(motions, 1);
  for (const auto& [name, value] : {std::pair{"width", width}, {"height", height}})
    require(value >= 64 && value <= 4096 && value % 2 == 0,
            format("%s is %d; it must be even, within 64..4096", name, value));
  require(fps >= 1 && fps <= 240, format("fps is %g; it must be within 1..240", fps));
  require(n_frames >= 0 && n_frames <= 100000, format("n_frames is %d; it must be within 0..100000", n_frames));
  require(empty_frames >= 0 && empty_frames <= 10000,
          format("empty_frames is %d; it must be within 0..10000", empty_frames));
  require(fov_deg >= 10 && fov_deg <= 120, format("fov_deg is %g; it must be within 10..120", fov_deg));
  require(distance_mm >= 1000 && distance_mm <= 20000,
          format("distance_mm is %g; it must be within 1000..20000", distance_mm));
  require(camera_height_mm >= 100 && camera_height_mm <= 5000,
          format("camera_height_mm is %g; it must be within 100..5000", camera_height_mm));
  require(std::abs(camera_roll_deg) <= 45, format("camera_roll_deg is %g; it must be within -45..45", camera_roll_deg));
  require(noise >= 0 && noise <= 50, format("noise is %g; it must be within 0..50", noise));
  require(gain_drift >= 0 && gain_drift <= 0.5, format("gain_drift is %g; it must be within 0..0.5", gain_drift));
  require(blur_px >= 0 && blur_px <= 10, format("blur_px is %g; it must be within 0..10", blur_px));
}

SynthReport write_sequence(const SynthOptions& options, const std::filesystem::path& folder,
                           const SynthProgress& progress) {
  options.validate();
  const auto masks = folder / "truth" / "masks";
  std::error_code error;
  std::filesystem::create_directories(masks, error);
  if (error) throw IoError(masks.string() + ": cannot be created: " + error.message());

  const ActorModel actor = build_actor(options.actor, options.height_mm, 5000);
  write_file_atomically(folder / "actor.glb", actor_glb(actor));
  write_file_atomically(folder / "truth" / "labels.npy", labels_npy(actor.labels));
  const View view = make_view(options);
  save_camera(view.camera, folder / "camera.json");
  const Lighting lighting;
  const Plate plate = render_plate(view, lighting, options.seed);
  write_png(expose(plate.lit, options.width, options.height, {options.blur_px, 0, 1, 0}), folder / "background.png");

  Performer performer(options, actor);
  SynthReport report;
  report.n_frames = options.n_frames > 0 ? options.n_frames : options.empty_frames + performer.n_postures();
  report.n_vertices = static_cast<int>(actor.surface.vertices.size());
  VideoWriter video((folder / "video.mp4").string(), options.width, options.height, options.fps);
  TruthVertices truth(folder / "truth" / "vertices.pc2", report.n_vertices);
  nlohmann::json joints;
  for (const auto& bone : kBones) joints["names"].push_back(bone.name);
  std::vector<float> swing;
  double render_ms = 0;
  int done = 0;
  for (; done < report.n_frames; ++done) {
    if (progress && !progress(done, report.n_frames)) break;
    const bool person = done >= options.empty_frames;
    Performance now;
    if (person) now = performer.perform(done - options.empty_frames);
    const double seconds = done / options.fps;
    const Sensor sensor{options.blur_px, options.noise, 1 + options.gain_drift * std::sin(2 * M_PI * seconds / 4.3),
                        options.seed * 1000003 + done};
    const Timer timer;
    const Picture picture = take_picture(view, lighting, plate, actor, now.vertices, sensor);
    render_ms += timer.elapsed_ms();
    video.write(picture.rgb);
    write_png(picture.mask, masks / format("%06d.png", done));
    truth.append(view, now.vertices);
    joints["frames"].push_back(person ? joints_row(view, now.pose) : nlohmann::json());
    if (person)
      for (int i : performer.cloth_vertices())
        swing.push_back(static_cast<float>((now.vertices[i] - now.skinned[i]).norm()));
  }
  video.close();
  truth.close();
  write_file_atomically(folder / "truth" / "joints.json", joints.dump());

  if (done > 0) report.render_ms_per_frame = render_ms / done;
  if (!swing.empty()) {
    for (float d : swing) report.cloth_mean_mm += d / static_cast<double>(swing.size());
    auto p95 = swing.begin() + static_cast<std::ptrdiff_t>(0.95 * (swing.size() - 1));
    std::nth_element(swing.begin(), p95, swing.end());
    report.cloth_p95_mm = *p95;
  }
  report.n_frames = done;
  return report;
}

}  // namespace livecap

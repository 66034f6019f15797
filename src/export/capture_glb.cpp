#include "export/capture_glb.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/json_text.h"
#include "base/log.h"
#include "base/srgb.h"
#include "base/text.h"
#include "export/export_frame.h"
#include "export/pc2.h"
#include "export/residual_basis.h"
#include "image/image_io.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using nlohmann::json;

enum ComponentType { kUnsignedByte = 5121, kShort = 5122, kUnsignedInt = 5125, kFloat = 5126 };
enum Target { kNoTarget = 0, kVertices = 34962, kIndices = 34963 };
constexpr double kShortOne = 32767;  // what a normalised int16 calls 1
constexpr double kNearM = 0.05, kFarM = 100;

// The growing binary chunk with its views and accessors.
class GlbBuilder {
 public:
  json document = {{"asset", {{"version", "2.0"}, {"generator", "LiveCap-CL"}}}};

  int add_view(const void* data, size_t size, Target target, int stride = 0) {
    bin_.resize((bin_.size() + 3) / 4 * 4, '\0');
    json view = {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", size}};
    if (target != kNoTarget) view["target"] = target;
    if (stride > 0) view["byteStride"] = stride;
    views_.push_back(view);
    bin_.append(static_cast<const char*>(data), size);
    return static_cast<int>(views_.size()) - 1;
  }

  // values_per_element counts what one element occupies in `data`, padding included.
  template <typename T>
  int add(const std::vector<T>& data, ComponentType component, const char* type, int values_per_element, Target target,
          int stride = 0) {
    json accessor = {{"bufferView", add_view(data.data(), data.size() * sizeof(T), target, stride)},
                     {"componentType", component},
                     {"count", data.size() / values_per_element},
                     {"type", type}};
    accessors_.push_back(accessor);
    return static_cast<int>(accessors_.size()) - 1;
  }

  json& accessor(int index) { return accessors_[index]; }

  // min and max of the first n values of each element, as glTF demands for positions and key times.
  template <typename T>
  void set_bounds(int index, const std::vector<T>& data, int values_per_element, int n) {
    std::vector<T> low(data.begin(), data.begin() + n), high = low;
    for (size_t i = 0; i < data.size(); i += values_per_element) {
      for (int k = 0; k < n; ++k) {
        low[k] = std::min(low[k], data[i + k]);
        high[k] = std::max(high[k], data[i + k]);
      }
    }
    accessors_[index]["min"] = low;
    accessors_[index]["max"] = high;
  }

  std::string finish() {
    bin_.resize((bin_.size() + 3) / 4 * 4, '\0');
    document["buffers"] = json::array({{{"byteLength", bin_.size()}}});
    document["bufferViews"] = views_;
    document["accessors"] = accessors_;
    std::string text = json_text(document);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    auto u32 = [](size_t value) {
      const auto v = static_cast<uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&v), 4);
    };
    const size_t total = 12 + 8 + text.size() + 8 + bin_.size();
    if (total > UINT32_MAX) throw IoError("capture.glb: more than 4 GiB; use fewer morph targets or vertices.pc2");
    return "glTF" + u32(2) + u32(total) + u32(text.size()) + "JSON" + text + u32(bin_.size()) +
           std::string("BIN\0", 4) + bin_;
  }

 private:
  std::string bin_;
  json views_ = json::array();
  json accessors_ = json::array();
};

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); });
}

std::vector<double> numbers(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
std::vector<double> numbers(const Eigen::Quaterniond& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

// End points that are no bones of the chain but which riggers (and our own loader) expect.
struct EndPoint {
  const char* name;
  Keypoint keypoint;
};
constexpr EndPoint kEndPoints[] = {{"left_wrist", kLeftWrist}, {"right_wrist", kRightWrist}, {"left_hand", kLeftHand},
                                   {"right_hand", kRightHand}, {"left_toe", kLeftToe},       {"right_toe", kRightToe},
                                   {"head_top", kHeadTop}};

class CaptureGlb {
 public:
  CaptureGlb(const Actor& actor, std::span<const CapturedFrame> frames, const CaptureGlbOptions& options)
      : actor_(actor), frames_(frames), options_(options), skinning_(actor) {
    if (!(options.fps > 0)) throw ConfigError(format("capture.glb: fps is %g, must be positive", options.fps));
    if (!options.times_s.empty() && options.times_s.size() != frames.size())
      throw ConfigError(format("capture.glb: %zu times for %zu frames", options.times_s.size(), frames.size()));
    if (std::ranges::adjacent_find(options.times_s, std::ranges::greater_equal()) != options.times_s.end())
      throw ConfigError("capture.glb: the frames' times do not grow");
    if (options.max_morph_targets < 0 || options.max_morph_targets > 1024)
      throw ConfigError(format("capture.glb: %d morph targets, must be 0 to 1024", options.max_morph_targets));
    for (size_t i = 0; i < frames.size(); ++i) {
      if (frames[i].tracked) keys_.push_back(static_cast<int>(i));
    }
    report_.n_frames = static_cast<int>(frames.size());
    report_.n_keys = static_cast<int>(keys_.size());
  }

  std::string build(const FrameVertices& vertices) {
    if (vertices) find_shapes(vertices);
    add_skeleton();
    add_mesh();
    add_animation();
    if (options_.camera) add_camera(*options_.camera);
    std::string bytes = glb_.finish();
    report_.bytes = bytes.size();
    return bytes;
  }

  const CaptureGlbReport& report() const { return report_; }

 private:
  int n_numbers() const { return 3 * actor_.n_vertices(); }

  void find_shapes(const FrameVertices& vertices) {
    std::vector<float> captured(n_numbers());
    auto residual = [&](int key, Eigen::Ref<Eigen::VectorXd> column) {
      vertices(keys_[key], captured);
      column.setZero();
      if (!all_finite(captured)) return;
      skinning_.set_pose(frames_[keys_[key]].pose);
      for (int v = 0; v < actor_.n_vertices(); ++v)
        column.segment<3>(3 * v) =
            skinning_.inverse(v, Eigen::Map<const Eigen::Vector3f>(captured.data() + 3 * v).cast<double>());
    };
    const Eigen::MatrixXf shapes = residual_basis(n_numbers(), report_.n_keys, options_.max_morph_targets - 1,
                                                  options_.tolerance_mm * kMetresPerMm, residual);
    shapes_ = (shapes * static_cast<float>(kShortOne)).array().round().cast<int16_t>();
    if (shapes_.cols() == 0) return measure(vertices, Eigen::MatrixXd(n_numbers(), 0));

    // Weights by least squares against the shapes as they are stored.
    const Eigen::MatrixXd stored = shapes_.cast<double>() / kShortOne;
    const Eigen::LDLT<Eigen::MatrixXd> normal(Eigen::MatrixXd(stored.transpose() * stored));
    weights_.resize(shapes_.cols() + 1, report_.n_keys);
    Eigen::VectorXd column(n_numbers());
    for (int key = 0; key < report_.n_keys; ++key) {
      residual(key, column);
      weights_.col(key).head(shapes_.cols()) = normal.solve(stored.transpose() * column).cast<float>();
    }
    // Blender cuts weights to [0, 1]. So each is counted from its lowest, and a last shape holds the sum of these.
    const Eigen::VectorXf lowest = weights_.topRows(shapes_.cols()).rowwise().minCoeff();
    weights_.topRows(shapes_.cols()).colwise() -= lowest;
    weights_.bottomRows<1>().setOnes();
    offset_ = (stored * lowest.cast<double>()).cast<float>();
    report_.n_morph_targets = static_cast<int>(weights_.rows());

    Eigen::MatrixXd targets(n_numbers(), weights_.rows());
    targets << stored, offset_.cast<double>();
    measure(vertices, targets);
  }

  // The error that a viewer will show.
  void measure(const FrameVertices& vertices, const Eigen::MatrixXd& targets) {
    std::vector<float> captured(n_numbers());
    double sum = 0;
    size_t n = 0;
    for (int key = 0; key < report_.n_keys; ++key) {
      vertices(keys_[key], captured);
      if (!all_finite(captured)) continue;
      skinning_.set_pose(frames_[keys_[key]].pose);
      Eigen::VectorXd shown = Eigen::VectorXd::Zero(n_numbers());
      if (targets.cols() > 0) shown = targets * weights_.col(key).cast<double>();
      for (int v = 0; v < actor_.n_vertices(); ++v, ++n) {
        const Eigen::Vector3d target = Eigen::Map<const Eigen::Vector3f>(captured.data() + 3 * v).cast<double>();
        const double error = (skinning_.forward(v, shown.segment<3>(3 * v)) - target).norm() / kMetresPerMm;
        sum += error;
        report_.max_error_mm = std::max(report_.max_error_mm, error);
      }
    }
    if (n > 0) report_.mean_error_mm = sum / static_cast<double>(n);
  }

  // Nodes 0..n_bones-1 are the bones in their bind pose, then the end points.
  void add_skeleton() {
    const Skeleton& skeleton = actor_.skeleton;
    const PosedSkeleton rest = forward_kinematics(skeleton, rest_pose(skeleton));
    std::vector<float> inverse_bind;
    std::vector<std::vector<int>> children(skeleton.n_bones());
    std::vector<int> joints;
    json nodes = json::array();
    auto add_node = [&](const std::string& name, int parent, const Eigen::Isometry3d& rest_frame) {
      const Eigen::Isometry3d local = parent < 0 ? rest_frame : rest.camera_from_bone[parent].inverse() * rest_frame;
      if (parent >= 0) children[parent].push_back(static_cast<int>(nodes.size()));
      joints.push_back(static_cast<int>(nodes.size()));
      nodes.push_back({{"name", name},
                       {"translation", numbers(Eigen::Vector3d(kMetresPerMm * local.translation()))},
                       {"rotation", numbers(Eigen::Quaterniond(local.linear()).normalized())}});
      Eigen::Isometry3d bind = rest_frame;
      bind.translation() *= kMetresPerMm;
      Eigen::Matrix4f inverse = bind.inverse().matrix().cast<float>();
      inverse.row(3) << 0, 0, 0, 1;
      inverse_bind.insert(inverse_bind.end(), inverse.data(), inverse.data() + 16);
    };
    for (int b = 0; b < skeleton.n_bones(); ++b)
      add_node(skeleton.bones[b].name, skeleton.bones[b].parent, rest.camera_from_bone[b]);
    for (const EndPoint& end : kEndPoints) {
      const KeypointAnchor& anchor = actor_.keypoints[end.keypoint];
      if (anchor.bone < 0) continue;
      Eigen::Isometry3d frame = rest.camera_from_bone[anchor.bone];
      frame.translation() = anchor.rest_position_mm;
      add_node(end.name, anchor.bone, frame);
    }
    for (int b = 0; b < skeleton.n_bones(); ++b) {
      if (!children[b].empty()) nodes[b]["children"] = children[b];
    }
    mesh_node_ = static_cast<int>(nodes.size());
    nodes.push_back({{"name", actor_.name.empty() ? "actor" : actor_.name}, {"mesh", 0}, {"skin", 0}});
    glb_.document["nodes"] = nodes;
    glb_.document["scenes"] = json::array({{{"name", "capture"}, {"nodes", {0, mesh_node_}}}});
    glb_.document["scene"] = 0;
    glb_.document["skins"] =
        json::array({{{"name", "LiveCap-32"},
                      {"skeleton", 0},
                      {"joints", joints},
                      {"inverseBindMatrices", glb_.add(inverse_bind, kFloat, "MAT4", 16, kNoTarget)}}});
  }

  void add_mesh() {
    const RenderMesh& render = actor_.render;
    const size_t n = render.template_vertex.size();
    const std::vector<float> template_normals = vertex_normals(actor_.mesh.positions, actor_.mesh.triangles);
    std::vector<float> positions, normals, weights, colors;
    std::vector<uint8_t> joints, labels;
    if (actor_.skeleton.n_bones() > 256) throw LogicError("capture.glb: more than 256 bones");
    for (size_t i = 0; i < n; ++i) {
      const int32_t v = render.template_vertex[i];
      const Eigen::Vector3f normal = Eigen::Map<const Eigen::Vector3f>(template_normals.data() + 3 * v);
      const Eigen::Vector3f unit = normal.norm() > 0.5f ? normal : Eigen::Vector3f::UnitY().eval();
      for (int k = 0; k < 3; ++k) {
        positions.push_back(static_cast<float>(kMetresPerMm * actor_.mesh.positions[3 * v + k]));
        normals.push_back(unit[k]);
        const double c = actor_.colors.empty() ? 0.5 : actor_.colors[3 * v + k];
        colors.push_back(static_cast<float>(linear_from_srgb(c)));  // glTF wants linear
      }
      for (int k = 0; k < kMaxInfluences; ++k) {
        const float w = actor_.skin.weights[4 * v + k];
        weights.push_back(w);
        joints.push_back(static_cast<uint8_t>(w > 0 ? actor_.skin.bones[4 * v + k] : 0));
      }
      labels.insert(labels.end(), {actor_.labels.empty() ? uint8_t{0} : actor_.labels[v], 0, 0, 0});
    }
    json attributes;
    attributes["POSITION"] = glb_.add(positions, kFloat, "VEC3", 3, kVertices);
    glb_.set_bounds(attributes["POSITION"], positions, 3, 3);
    attributes["NORMAL"] = glb_.add(normals, kFloat, "VEC3", 3, kVertices);
    attributes["JOINTS_0"] = glb_.add(joints, kUnsignedByte, "VEC4", 4, kVertices);
    attributes["WEIGHTS_0"] = glb_.add(weights, kFloat, "VEC4", 4, kVertices);
    attributes["_LABEL"] = glb_.add(labels, kUnsignedByte, "SCALAR", 4, kVertices, 4);
    json material = {{"name", "actor"},
                     {"doubleSided", true},
                     {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.9}}}};
    if (actor_.texture.empty()) {
      attributes["COLOR_0"] = glb_.add(colors, kFloat, "VEC3", 3, kVertices);
    } else {
      attributes["TEXCOORD_0"] = glb_.add(render.uvs, kFloat, "VEC2", 2, kVertices);
      material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
      add_texture();
    }
    glb_.document["materials"] = json::array({material});
    const std::vector<uint32_t> indices(render.triangles.begin(), render.triangles.end());
    json primitive = {{"attributes", attributes},
                      {"indices", glb_.add(indices, kUnsignedInt, "SCALAR", 1, kIndices)},
                      {"material", 0}};

    // Each element of a vertex buffer starts at a multiple of four bytes: three shorts and one of padding.
    std::vector<int16_t> target(4 * n, 0);
    for (int shape = 0; shape < shapes_.cols(); ++shape) {
      for (size_t i = 0; i < n; ++i) {
        for (int k = 0; k < 3; ++k) target[4 * i + k] = shapes_(3 * render.template_vertex[i] + k, shape);
      }
      const int accessor = glb_.add(target, kShort, "VEC3", 4, kVertices, 8);
      glb_.accessor(accessor)["normalized"] = true;
      glb_.set_bounds(accessor, target, 4, 3);
      primitive["targets"].push_back({{"POSITION", accessor}});
    }
    if (shapes_.cols() > 0) {
      std::vector<float> offset;
      for (int32_t v : render.template_vertex)
        offset.insert(offset.end(), offset_.data() + 3 * v, offset_.data() + 3 * v + 3);
      const int accessor = glb_.add(offset, kFloat, "VEC3", 3, kVertices);
      glb_.set_bounds(accessor, offset, 3, 3);
      primitive["targets"].push_back({{"POSITION", accessor}});
    }
    json mesh = {{"name", "actor"}, {"primitives", json::array({primitive})}, {"extras", {{"livecap", extras()}}}};
    if (shapes_.cols() > 0) {
      mesh["weights"] = std::vector<double>(weights_.rows(), 0.0);
      std::vector<std::string> names;
      for (int k = 0; k < shapes_.cols(); ++k) names.push_back(format("cloth_%02d", k));
      names.push_back("cloth_offset");
      mesh["extras"]["targetNames"] = names;
      for (const char* list : {"extensionsUsed", "extensionsRequired"}) glb_.document[list] = {"KHR_mesh_quantization"};
    }
    glb_.document["meshes"] = json::array({mesh});
  }

  void add_texture() {
    const ImageRgb& image = actor_.texture;
    const std::string png = encode_png(image);
    glb_.document["images"] = json::array({{{"name", "texture"},
                                            {"mimeType", "image/png"},
                                            {"bufferView", glb_.add_view(png.data(), png.size(), kNoTarget)}}});
    glb_.document["samplers"] = json::array({{{"magFilter", 9729}, {"minFilter", 9987}}});
    glb_.document["textures"] = json::array({{{"sampler", 0}, {"source", 0}}});
  }

  // What makes the file an actor again: limits, face markers, whether its weights are guessed or its shape is rough.
  json extras() const {
    json own = json::object();
    if (actor_.guessed_weights) own["weights"] = "guessed";
    if (actor_.rough_shape) own["shape"] = "rough";
    for (const Dof& dof : actor_.skeleton.dofs)
      own["limits"][dof.name] = {dof.min_rad * 180 / std::numbers::pi, dof.max_rad * 180 / std::numbers::pi};
    for (int k = kBodyKeypointCount; k < kKeypointCount; ++k) {
      if (actor_.keypoints[k].bone < 0) continue;
      int nearest = 0;
      double best = 1e300;
      for (int v = 0; v < actor_.n_vertices(); ++v) {
        const Eigen::Vector3d p =
            Eigen::Map<const Eigen::Vector3f>(actor_.mesh.positions.data() + 3 * v).cast<double>();
        if (const double d = (p - actor_.keypoints[k].rest_position_mm).norm(); d < best) {
          best = d;
          nearest = v;
        }
      }
      own["markers"][std::string(kKeypointNames[k])] = nearest;
    }
    return own;
  }

  void add_animation() {
    if (keys_.empty()) return;
    const Skeleton& skeleton = actor_.skeleton;
    std::vector<float> times, root_translation;
    std::vector<std::vector<float>> rotations(skeleton.n_bones());
    std::vector<Eigen::Quaterniond> previous(skeleton.n_bones(), Eigen::Quaterniond::Identity());
    for (int frame : keys_) {
      times.push_back(static_cast<float>(options_.times_s.empty() ? frame / options_.fps : options_.times_s[frame]));
      const PosedSkeleton posed = forward_kinematics(skeleton, frames_[frame].pose);
      const Eigen::Vector3d t = gltf_from_camera(posed.camera_from_bone[0].translation());
      for (int k = 0; k < 3; ++k) root_translation.push_back(static_cast<float>(t[k]));
      for (int b = 0; b < skeleton.n_bones(); ++b) {
        const Eigen::Matrix3d world = posed.camera_from_bone[b].linear();
        const Eigen::Matrix3d local =
            b == 0 ? Eigen::Matrix3d(gltf_axes_from_camera() * world)
                   : Eigen::Matrix3d(posed.camera_from_bone[skeleton.bones[b].parent].linear().transpose() * world);
        Eigen::Quaterniond q = Eigen::Quaterniond(local).normalized();
        if (q.dot(previous[b]) < 0) q.coeffs() *= -1;  // the short way between keys
        previous[b] = q;
        for (double x : numbers(q)) rotations[b].push_back(static_cast<float>(x));
      }
    }
    const int time_accessor = glb_.add(times, kFloat, "SCALAR", 1, kNoTarget);
    glb_.set_bounds(time_accessor, times, 1, 1);
    json samplers = json::array(), channels = json::array();
    auto add_channel = [&](int node, const char* path, int output) {
      channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
      samplers.push_back({{"input", time_accessor}, {"output", output}, {"interpolation", "LINEAR"}});
    };
    add_channel(0, "translation", glb_.add(root_translation, kFloat, "VEC3", 3, kNoTarget));
    for (int b = 0; b < skeleton.n_bones(); ++b)
      add_channel(b, "rotation", glb_.add(rotations[b], kFloat, "VEC4", 4, kNoTarget));
    if (weights_.size() > 0) {
      const std::vector<float> weights(weights_.data(), weights_.data() + weights_.size());
      add_channel(mesh_node_, "weights", glb_.add(weights, kFloat, "SCALAR", 1, kNoTarget));
    }
    glb_.document["animations"] = json::array({{{"name", "capture"}, {"samplers", samplers}, {"channels", channels}}});
  }

  // glTF's cameras look along -z with y up, as ours do once its axes are glTF's.
  void add_camera(const Camera& camera) {
    const Eigen::Isometry3d& frame = options_.frame_from_camera;
    json& nodes = glb_.document["nodes"];
    glb_.document["scenes"][0]["nodes"].push_back(nodes.size());
    nodes.push_back({{"name", "camera"},
                     {"camera", 0},
                     {"translation", numbers(gltf_from_camera(frame.translation()))},
                     {"rotation", numbers(gltf_turn_from_camera(Eigen::Quaterniond(frame.linear()).normalized()))}});
    const double tan_y = camera.height / (2 * camera.fy), tan_x = camera.width / (2 * camera.fx);
    const json own = {{"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
                      {"fy", camera.fy},       {"cx", camera.cx},         {"cy", camera.cy}};
    glb_.document["cameras"] = json::array(
        {{{"name", "camera"},
          {"type", "perspective"},
          {"perspective",
           {{"yfov", 2 * std::atan(tan_y)}, {"aspectRatio", tan_x / tan_y}, {"znear", kNearM}, {"zfar", kFarM}}},
          {"extras", {{"livecap", own}}}}});
  }

  const Actor& actor_;
  std::span<const CapturedFrame> frames_;
  CaptureGlbOptions options_;
  LinearSkinning skinning_;
  std::vector<int> keys_;                                          // tracked frames
  Eigen::Matrix<int16_t, Eigen::Dynamic, Eigen::Dynamic> shapes_;  // [3n x n_morph_targets] of kShortOne metres
  Eigen::VectorXf offset_;                                         // [3n] metres, the last target, always in full
  Eigen::MatrixXf weights_;                                        // [n_morph_targets x n_keys] metres, from 0
  int mesh_node_ = 0;
  GlbBuilder glb_;
  CaptureGlbReport report_;
};

}  // namespace

CaptureGlbReport write_capture_glb(const std::filesystem::path& path, const Actor& actor,
                                   std::span<const CapturedFrame> frames, const FrameVertices& vertices,
                                   const CaptureGlbOptions& options) {
  CaptureGlb glb(actor, frames, options);
  write_file_atomically(path, glb.build(vertices));
  const CaptureGlbReport& r = glb.report();
  log_info(format("%s: %d keys, %d morph targets, vertex error mean %.3f mm, max %.2f mm, %.1f MB", path.c_str(),
                  r.n_keys, r.n_morph_targets, r.mean_error_mm, r.max_error_mm, r.bytes / 1e6));
  return r;
}

CaptureGlbReport write_capture_glb(const std::filesystem::path& path, const Actor& actor,
                                   std::span<const CapturedFrame> frames, const std::filesystem::path& vertices_pc2,
                                   const CaptureGlbOptions& options) {
  Pc2Reader reader(vertices_pc2);
  if (reader.n_points() != actor.n_vertices() || reader.n_samples() < static_cast<int>(frames.size()))
    throw IoError(vertices_pc2.string() +
                  format(": %d points and %d samples, the capture has %d vertices and %zu frames", reader.n_points(),
                         reader.n_samples(), actor.n_vertices(), frames.size()));
  return write_capture_glb(
      path, actor, frames, [&](int frame, std::span<float> out) { reader.read(frame, out); }, options);
}

}  // namespace livecap

#include "actor/gltf_reader.h"

#include <Eigen/Geometry>
#include <array>
#include <cstring>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr char kTextureTransform[] = "KHR_texture_transform";
constexpr size_t kMaxJsonDepth = 64;  // tinygltf walks `extras` recursively

uint32_t little_endian_32(const std::string& bytes, size_t offset) {
  uint32_t value = 0;
  for (int k = 3; k >= 0; --k) value = value << 8 | static_cast<uint8_t>(bytes[offset + k]);
  return value;
}

size_t nesting_depth(const char* text, size_t size) {
  size_t depth = 0, deepest = 0;
  bool in_string = false;
  for (size_t i = 0; i < size; ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return deepest;
}

// Far more than any bone has above it; where a node stands is computed from all of them.
constexpr int kMaxNodeDepth = 1024;

// Images are decoded on demand, after their range was checked.
bool keep_image_encoded(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int,
                        void*) {
  return true;
}

// Width and height from the header of a PNG or JPEG, so that a few bytes cannot ask for gigabytes.
std::pair<int64_t, int64_t> encoded_size(const uint8_t* data, size_t size) {
  const uint8_t png[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  auto big_endian = [&](size_t at, int n) {
    int64_t value = 0;
    for (int k = 0; k < n; ++k) value = value << 8 | data[at + k];
    return value;
  };
  if (size >= 24 && std::memcmp(data, png, sizeof png) == 0) return {big_endian(16, 4), big_endian(20, 4)};
  if (size >= 4 && data[0] == 0xff && data[1] == 0xd8) {
    for (size_t at = 2; at + 9 < size && data[at] == 0xff;) {
      const int marker = data[at + 1];
      if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc)
        return {big_endian(at + 7, 2), big_endian(at + 5, 2)};
      at += 2 + big_endian(at + 2, 2);
    }
  }
  return {0, 0};
}

}  // namespace

GltfReader::GltfReader(const std::string& bytes, std::string name) : name_(std::move(name)) {
  check_container(bytes);
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(keep_image_encoded, nullptr);
  // A GLB from somewhere must not make this program read other files.
  parser.SetFsCallbacks(
      {[](const std::string&, void*) { return false; }, [](const std::string& path, void*) { return path; },
       [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; },
       [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }, nullptr});
  std::string error, warning;
  bool loaded = false;
  try {
    loaded = parser.LoadBinaryFromMemory(&model_, &error, &warning, reinterpret_cast<const uint8_t*>(bytes.data()),
                                         static_cast<unsigned>(bytes.size()));
  } catch (const std::exception& e) {
    error = e.what();
  }
  if (!loaded) {
    error = error.substr(0, error.find('\n'));
    fail("not a valid glTF 2.0 binary: " + (error.empty() ? "malformed JSON" : error));
  }
  for (const std::string& extension : model_.extensionsRequired) {
    if (extension != "KHR_mesh_quantization" && extension != kTextureTransform &&
        extension.rfind("KHR_materials_", 0) != 0)
      fail("needs the glTF extension " + extension + ", which is not supported; export without compression");
  }
  check_nodes();
}

void GltfReader::fail(const std::string& what) const {
  throw IoError(name_ + ": " + what);
}

void GltfReader::check_container(const std::string& bytes) {
  if (bytes.size() < 20 || bytes.compare(0, 4, "glTF") != 0) fail("not a GLB file (glTF 2.0 binary)");
  if (bytes.size() > (size_t{1} << 31)) fail("larger than 2 GiB");
  if (const uint32_t version = little_endian_32(bytes, 4); version != 2)
    fail(format("GLB version %u, only 2 is supported", version));
  const size_t length = little_endian_32(bytes, 8), json_length = little_endian_32(bytes, 12);
  if (length > bytes.size())
    fail(format("truncated: the header says %zu bytes, the file has %zu", length, bytes.size()));
  if (little_endian_32(bytes, 16) != 0x4e4f534a || json_length > bytes.size() - 20)
    fail("the first GLB chunk is not complete JSON");
  const char* json = bytes.data() + 20;
  if (nesting_depth(json, json_length) > kMaxJsonDepth)
    fail(format("JSON nested deeper than %zu levels", kMaxJsonDepth));
  document_ = nlohmann::json::parse(json, json + json_length, nullptr, false);
  if (!document_.is_object()) fail("the JSON chunk is malformed");
}

void GltfReader::check_nodes() {
  const int n = static_cast<int>(model_.nodes.size());
  parents_.assign(n, -1);
  for (int i = 0; i < n; ++i) {
    const tinygltf::Node& node = model_.nodes[i];
    for (int child : node.children) {
      if (child < 0 || child >= n || child == i)
        fail(format("nodes[%d].children holds %d, there are %d nodes", i, child, n));
      if (parents_[child] != -1) fail(format("nodes[%d] has two parents", child));
      parents_[child] = i;
    }
    auto check = [&](const std::vector<double>& values, size_t size, const char* field) {
      if (!values.empty() && values.size() != size)
        fail(format("nodes[%d].%s has %zu numbers, not %zu", i, field, values.size(), size));
      for (double v : values) {
        if (!std::isfinite(v)) fail(format("nodes[%d].%s is not finite", i, field));
      }
    };
    check(node.matrix, 16, "matrix");
    check(node.translation, 3, "translation");
    check(node.rotation, 4, "rotation");
    check(node.scale, 3, "scale");
  }
  for (int i = 0; i < n; ++i) {
    int n_ancestors = 0;
    for (int p = parents_[i]; p >= 0; p = parents_[p]) {
      if (++n_ancestors > kMaxNodeDepth)
        fail(format("nodes[%d] has more than %d ancestors, or is its own", i, kMaxNodeDepth));
    }
  }
}

Eigen::Matrix4d GltfReader::node_world(int index) const {
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();
  for (int i = index; i >= 0; i = parents_[i]) {
    const tinygltf::Node& node = model_.nodes[i];
    Eigen::Affine3d local = Eigen::Affine3d::Identity();
    if (!node.matrix.empty()) {
      local.matrix() = Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
    } else {
      if (!node.translation.empty()) local.translate(Eigen::Map<const Eigen::Vector3d>(node.translation.data()));
      if (!node.rotation.empty()) {
        const auto& r = node.rotation;
        const Eigen::Quaterniond q(r[3], r[0], r[1], r[2]);
        if (q.norm() > 1e-9) local.rotate(q.normalized());
      }
      if (!node.scale.empty()) local.scale(Eigen::Map<const Eigen::Vector3d>(node.scale.data()));
    }
    world = local.matrix() * world;
  }
  return world;
}

std::pair<const uint8_t*, size_t> GltfReader::buffer_view_bytes(int index, const std::string& what) const {
  if (index < 0 || static_cast<size_t>(index) >= model_.bufferViews.size())
    fail(what + format(": bufferView %d, there are %zu", index, model_.bufferViews.size()));
  const tinygltf::BufferView& view = model_.bufferViews[index];
  if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= model_.buffers.size())
    fail(format("bufferViews[%d].buffer is %d, there are %zu buffers", index, view.buffer, model_.buffers.size()));
  const std::vector<unsigned char>& data = model_.buffers[view.buffer].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
    fail(format("bufferViews[%d] reaches beyond its buffer of %zu bytes", index, data.size()));
  return {data.data() + view.byteOffset, view.byteLength};
}

GltfReader::View GltfReader::view(int index, const std::string& what) const {
  if (index < 0 || static_cast<size_t>(index) >= model_.accessors.size())
    fail(what + format(": accessor %d, there are %zu", index, model_.accessors.size()));
  const tinygltf::Accessor& accessor = model_.accessors[index];
  if (accessor.sparse.isSparse) fail(what + ": sparse accessors are not supported");
  const auto [data, size] = buffer_view_bytes(accessor.bufferView, what + format(" (accessors[%d])", index));
  const int component_size = tinygltf::GetComponentSizeInBytes(accessor.componentType);
  const int components = tinygltf::GetNumComponentsInType(accessor.type);
  if (component_size <= 0 || component_size > 4 || components <= 0) fail(what + ": unknown accessor type");
  const size_t element = static_cast<size_t>(component_size) * components;
  const size_t declared = model_.bufferViews[accessor.bufferView].byteStride;
  const size_t stride = declared == 0 ? element : declared;
  if (stride < element || stride > 4096)
    fail(what + format(": byteStride %zu for elements of %zu bytes", stride, element));
  const size_t count = accessor.count;
  if (count > 0) {
    const size_t room = accessor.byteOffset <= size ? size - accessor.byteOffset : 0;
    if (room < element || (count - 1) > (room - element) / stride)
      fail(what + format(": accessors[%d] reaches beyond its bufferView of %zu bytes", index, size));
  }
  return {data + accessor.byteOffset, count, stride, components, accessor.componentType, accessor.normalized};
}

int GltfReader::components_of(int index, const std::string& what) const {
  return view(index, what).components;
}
int64_t GltfReader::count_of(int index, const std::string& what) const {
  return static_cast<int64_t>(view(index, what).count);
}

namespace {

template <typename T>
double load_component(const uint8_t* at, bool normalized) {
  T value;
  std::memcpy(&value, at, sizeof value);
  if constexpr (std::is_floating_point_v<T>) return value;
  if (!normalized) return static_cast<double>(value);
  return std::max(static_cast<double>(value) / std::numeric_limits<T>::max(), -1.0);
}

double load_any(const uint8_t* at, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return load_component<int8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load_component<uint8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return load_component<int16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load_component<uint16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_INT:
      return load_component<int32_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load_component<uint32_t>(at, normalized);
    default:
      return load_component<float>(at, normalized);
  }
}

}  // namespace

std::vector<double> GltfReader::read(int index, int components, int64_t expected_count, const std::string& what) const {
  const View v = view(index, what);
  if (v.components != components) fail(what + format(" has %d components, not %d", v.components, components));
  if (expected_count >= 0 && static_cast<int64_t>(v.count) != expected_count)
    fail(what + format(" has %zu elements, not %lld", v.count, static_cast<long long>(expected_count)));
  const int size = tinygltf::GetComponentSizeInBytes(v.component_type);
  std::vector<double> values(v.count * components);
  for (size_t i = 0; i < v.count; ++i) {
    for (int k = 0; k < components; ++k) {
      const double value =
          load_any(v.data + i * v.stride + static_cast<size_t>(k) * size, v.component_type, v.normalized);
      if (!std::isfinite(value)) fail(what + format(" element %zu is not finite", i));
      values[i * components + k] = value;
    }
  }
  return values;
}

std::vector<uint32_t> GltfReader::read_unsigned(int index, int components, int64_t expected_count,
                                                const std::string& what) const {
  const int type = view(index, what).component_type;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    fail(what + " must be unsigned integers");
  const std::vector<double> values = read(index, components, expected_count, what);
  return {values.begin(), values.end()};
}

std::vector<Eigen::Vector2d> GltfReader::texture_coordinates(const tinygltf::Primitive& primitive, int64_t n,
                                                             const std::string& what) const {
  int set = 0;
  Eigen::Affine2d transform = Eigen::Affine2d::Identity();
  if (primitive.material >= 0 && static_cast<size_t>(primitive.material) < model_.materials.size()) {
    const tinygltf::TextureInfo& info = model_.materials[primitive.material].pbrMetallicRoughness.baseColorTexture;
    set = info.texCoord;
    if (const auto found = info.extensions.find(kTextureTransform); found != info.extensions.end()) {
      const tinygltf::Value& extension = found->second;
      const std::string name = format("materials[%d].%s.", primitive.material, kTextureTransform);
      const auto number = [&](const tinygltf::Value& value, const char* field) {
        if (!value.IsNumber()) fail(name + field + " is not a number");
        return value.GetNumberAsDouble();
      };
      const auto pair = [&](const char* field, const Eigen::Vector2d& otherwise) -> Eigen::Vector2d {
        if (!extension.Has(field)) return otherwise;
        const tinygltf::Value& value = extension.Get(field);
        if (!value.IsArray() || value.ArrayLen() != 2) fail(name + field + " is not two numbers");
        return {number(value.Get(0), field), number(value.Get(1), field)};
      };
      // Counter-clockwise as one sees it; v points down.
      const double turn = extension.Has("rotation") ? number(extension.Get("rotation"), "rotation") : 0;
      transform.translate(pair("offset", {0, 0})).rotate(-turn).scale(pair("scale", {1, 1}));
      if (extension.Has("texCoord")) set = static_cast<int>(number(extension.Get("texCoord"), "texCoord"));
    }
  }
  const std::string name = "TEXCOORD_" + std::to_string(set >= 0 && set < 8 ? set : 0);
  const auto attribute = primitive.attributes.find(name);
  if (attribute == primitive.attributes.end()) return {};
  const std::vector<double> values = read(attribute->second, 2, n, what + "." + name);
  std::vector<Eigen::Vector2d> coordinates;
  for (int64_t i = 0; i < n; ++i) {
    coordinates.push_back(transform * Eigen::Vector2d(values[2 * i], values[2 * i + 1]));
    if (!coordinates.back().allFinite()) fail(what + "." + name + ": its " + kTextureTransform + " is not finite");
  }
  return coordinates;
}

ImageRgb GltfReader::decode_image(int index) const {
  if (index < 0 || static_cast<size_t>(index) >= model_.images.size())
    fail(format("image %d, there are %zu", index, model_.images.size()));
  const std::string what = format("images[%d]", index);
  if (model_.images[index].bufferView < 0) fail(what + " is not embedded; export as GLB with packed textures");
  const auto [data, size] = buffer_view_bytes(model_.images[index].bufferView, what);
  const auto [width, height] = encoded_size(data, size);
  if (width <= 0 || height <= 0) fail(what + " is neither PNG nor JPEG");
  if (width * height > kMaxTexturePixels)
    fail(what +
         format(" is %lld x %lld pixels, too large", static_cast<long long>(width), static_cast<long long>(height)));
  tinygltf::Image decoded;
  std::string error, warning;
  if (!tinygltf::LoadImageData(&decoded, index, &error, &warning, 0, 0, data, static_cast<int>(size), nullptr))
    fail(what + " cannot be decoded: " + error.substr(0, error.find('\n')));
  ImageRgb image{decoded.width, decoded.height, {}};
  const size_t n_pixels = static_cast<size_t>(image.width) * image.height;
  const int bytes_per_channel = decoded.bits / 8, channels = decoded.component;
  if (channels < 1 || bytes_per_channel < 1 || decoded.image.size() < n_pixels * channels * bytes_per_channel)
    fail(what + " was decoded to an unexpected size");
  image.pixels.resize(3 * n_pixels);
  for (size_t p = 0; p < n_pixels; ++p) {
    for (int k = 0; k < 3; ++k) {
      const size_t channel = p * channels + (channels >= 3 ? k : 0);
      image.pixels[3 * p + k] = decoded.image[channel * bytes_per_channel + bytes_per_channel - 1];  // high byte
    }
  }
  return image;
}

}  // namespace livecap

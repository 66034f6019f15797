#include "nn/onnx_import.h"

#include <algorithm>

#include "base/text.h"
#include "livecap/error.h"
#include "nn/onnx_importer.h"

namespace livecap::nn {
namespace {

constexpr int kMaxInputSide = 1 << 14;
constexpr size_t kSmall = 1 << 16;  // numbers of a constant that is looked at one by one

Dims channels_first(const Shape& shape) {
  return {1, shape[3], shape[1], shape[2]};
}

Dims channels_last(const Shape& shape) {
  return {1, shape[1], shape[2], shape[3]};
}

Dims without_ones(const Dims& dims) {
  Dims out;
  for (int64_t n : dims) {
    if (n != 1) out.push_back(n);
  }
  return out;
}

}  // namespace

void OnnxImporter::fail(const std::string& what) const {
  throw IoError(graph_.name + ": " + what);
}

Graph OnnxImporter::run() {
  if (model_.outputs.empty()) fail("the graph has no output");
  count_uses();
  read_constants();
  read_input();
  for (size_t i = 0; i < model_.nodes.size(); ++i) {
    if (needed_[i]) read_node(model_.nodes[i], i);
  }
  read_outputs();
  // What was folded away leaves no tensor that is never computed behind: outputs decide.
  validate(graph_);
  return std::move(graph_);
}

// Nodes that no output needs are not read: training leaves some behind.
void OnnxImporter::count_uses() {
  for (const OnnxValueInfo& output : model_.outputs) ++uses_[output.name];
  needed_.assign(model_.nodes.size(), 0);
  for (size_t i = model_.nodes.size(); i-- > 0;) {
    const OnnxNode& node = model_.nodes[i];
    for (std::string_view name : node.outputs) needed_[i] = needed_[i] || (!name.empty() && uses_.count(name));
    if (!needed_[i]) continue;
    for (std::string_view name : node.inputs) ++uses_[name];
  }
}

void OnnxImporter::read_constants() {
  for (const OnnxTensor& tensor : model_.initializers) {
    OnnxValue constant;
    constant.dims = tensor.dims;
    constant.stored = &tensor;
    values_[tensor.name] = constant;
  }
}

void OnnxImporter::read_input() {
  const OnnxValueInfo* input = nullptr;
  for (const OnnxValueInfo& info : model_.inputs) {
    if (values_.count(info.name)) continue;  // older files list the weights as well
    if (input)
      fail("has several inputs (\"" + printable(input->name) + "\", \"" + printable(info.name) + "\"), must be one");
    input = &info;
  }
  if (!input) fail("the graph has no input");
  const std::string label = "input \"" + printable(input->name) + "\": ";
  if (input->type != 1) fail(label + format("data type %d, must be 1 (float)", input->type));
  const Dims& stated = input->dims;
  // Behind TensorFlow's converter; an image of 3 columns has one to four channels in front.
  const bool last = stated.size() == 4 && stated[3] == 3 && (stated[1] < 1 || stated[1] > 4);
  if (stated.size() != 4 || (stated[0] != 1 && stated[0] != -1) || stated[last ? 3 : 1] < 1 ||
      stated[last ? 3 : 1] > kMaxInputSide)
    fail(label + "shape " + to_string(stated) + " must be [1,channels,height,width], batch 1");
  const auto side = [&](const char* name, int64_t in_file, int given) {
    if (in_file == -1 && given == 0)
      fail(label + "shape " + to_string(stated) + " leaves the " + name + " open; give it");
    const int64_t size = in_file == -1 ? given : in_file;
    if (size < 1 || size > kMaxInputSide)
      fail(label + format("%s %lld must be in 1..%d", name, static_cast<long long>(size), kMaxInputSide));
    return static_cast<int>(size);
  };
  const int height = side("height", stated[last ? 1 : 2], height_);
  const int width = side("width", stated[last ? 2 : 3], width_);
  graph_.tensors.push_back(
      {printable(input->name), {1, height, width, static_cast<int>(stated[last ? 3 : 1])}, false, {}});
  graph_.inputs = {0};
  OnnxValue value;
  value.tensor = 0;
  value.channels_last = last;
  value.dims = last ? channels_last(graph_.tensors[0].shape) : channels_first(graph_.tensors[0].shape);
  values_[input->name] = value;
}

void OnnxImporter::read_outputs() {
  for (const OnnxValueInfo& output : model_.outputs) {
    const auto found = values_.find(output.name);
    if (found == values_.end()) fail("output \"" + printable(output.name) + "\" is computed by no node");
    if (found->second.tensor < 0) fail("output \"" + printable(output.name) + "\" is a constant");
    graph_.outputs.push_back(found->second.tensor);
  }
}

void OnnxImporter::read_node(const OnnxNode& node, size_t index) {
  NodeReader reader(graph_.name, node, index);
  if (!node.domain.empty() && node.domain != "ai.onnx")
    reader.fail("of domain \"" + printable(node.domain) + "\" is not supported");
  if (node.outputs.empty() || node.outputs[0].empty()) reader.fail("has no output");
  for (size_t i = 1; i < node.outputs.size(); ++i) {
    if (!node.outputs[i].empty() && uses_.count(node.outputs[i]))
      reader.fail("output \"" + printable(node.outputs[i]) + "\" is used; only the first is supported");
  }
  if (fold(reader)) return;
  if (!read_layer(reader) && !read_elementwise(reader) && !read_shape_change(reader))
    reader.fail(
        "operator is not supported (supported: Conv, ConvTranspose, Gemm, MatMul, BatchNormalization, Relu, LeakyRelu, "
        "Clip, Sigmoid, "
        "HardSigmoid, HardSwish, Add, Sub, Mul, Div, Sum, Concat, MaxPool, AveragePool, GlobalAveragePool, "
        "GlobalMaxPool, ReduceMean, Resize, Upsample, Pad, Softmax, ArgMax, and where they only rename: Identity, "
        "Dropout, Cast, Transpose, Reshape, Flatten, Squeeze, Unsqueeze)");
  reader.finish();
}

// Constant, Shape, and what is computed from constants alone.
bool OnnxImporter::fold(NodeReader& node) {
  OnnxValue out;
  if (node.type() == "Constant") {
    if (const OnnxTensor* tensor = node.tensor("value")) {
      out.stored = tensor;
      out.dims = tensor->dims;
    } else if (node.has("value_float")) {
      out.numbers = {{}, {node.real("value_float", 0)}, false};
    } else if (node.has("value_int")) {
      out.numbers = {{}, {static_cast<double>(node.integer("value_int", 0))}, true};
    } else if (node.has("value_ints")) {
      const Dims values = node.integers("value_ints", {});
      out.numbers = {{static_cast<int64_t>(values.size())}, {values.begin(), values.end()}, true};
    } else if (node.has("value_floats")) {
      const std::vector<float> values = node.reals("value_floats");
      out.numbers = {{static_cast<int64_t>(values.size())}, {values.begin(), values.end()}, false};
    } else {
      node.fail("attribute \"value\" is missing");
    }
    node.finish();
  } else if (node.type() == "Shape") {
    const Dims dims = value(node, 0).dims;
    const int64_t n = static_cast<int64_t>(dims.size());
    const auto place = [&](int64_t i) { return std::clamp<int64_t>(i < 0 ? i + n : i, 0, n); };
    const int64_t begin = place(node.integer("start", 0)), end = std::max(begin, place(node.integer("end", n)));
    out.numbers = {{end - begin}, {dims.begin() + begin, dims.begin() + end}, true};
    node.finish();
  } else {
    if (node.node().inputs.empty()) node.fail("has no input");
    for (size_t i = 0; i < node.node().inputs.size(); ++i) {
      if (node.has_input(i) && !is_constant(node, i)) return false;
    }
    if (!node.has_input(0)) node.fail("input 0 is missing");
    if (node.type() == "Identity") {
      define(node, value(node, 0));
      return true;
    }
    if (!is_foldable(node.type())) return false;
    std::vector<Numbers> numbers(node.node().inputs.size());
    std::vector<const Numbers*> inputs;
    for (size_t i = 0; i < numbers.size(); ++i) {
      if (node.has_input(i)) {
        const OnnxValue& from = constant(node, i);
        numbers[i] = {from.dims, this->numbers(node, i),
                      from.stored ? from.stored->type == 6 || from.stored->type == 7 : from.numbers.integer};
      }
      inputs.push_back(node.has_input(i) ? &numbers[i] : nullptr);
    }
    out.numbers = fold_constants(node, inputs);
  }
  if (!out.stored) out.dims = out.numbers.dims;
  define(node, std::move(out));
  return true;
}

const OnnxValue& OnnxImporter::value(const NodeReader& node, size_t i) const {
  if (!node.has_input(i)) node.fail(format("input %zu is missing", i));
  const auto found = values_.find(node.node().inputs[i]);
  if (found == values_.end())
    node.fail("input \"" + printable(node.node().inputs[i]) + "\" is computed by no node before it");
  return found->second;
}

const OnnxValue& OnnxImporter::activation(const NodeReader& node, size_t i) const {
  const OnnxValue& x = value(node, i);
  if (x.tensor < 0) node.fail("input \"" + printable(node.node().inputs[i]) + "\" must not be a constant");
  return x;
}

const OnnxValue& OnnxImporter::image(const NodeReader& node, size_t i) const {
  const OnnxValue& x = activation(node, i);
  if (x.channels_last || x.dims != channels_first(shape(x)))
    node.fail("input \"" + printable(node.node().inputs[i]) + "\" of shape " + to_string(x.dims) +
              (x.channels_last ? " is transposed, must be" : " must be") + " an image [1,channels,height,width]");
  return x;
}

const OnnxValue& OnnxImporter::constant(const NodeReader& node, size_t i) const {
  const OnnxValue& x = value(node, i);
  if (x.tensor >= 0) node.fail("input \"" + printable(node.node().inputs[i]) + "\" must be a constant");
  return x;
}

std::vector<double> OnnxImporter::numbers(const NodeReader& node, size_t i) const {
  const OnnxValue& x = constant(node, i);
  if (!x.stored) return x.numbers.values;
  size_t count = 1;
  for (int64_t n : x.dims) count *= static_cast<size_t>(n);
  if (count > kSmall)
    node.fail("constant \"" + printable(node.node().inputs[i]) + "\" of shape " + to_string(x.dims) +
              " is too large here");
  return double_values(*x.stored);
}

std::vector<float> OnnxImporter::weights(const NodeReader& node, size_t i) const {
  const OnnxValue& x = constant(node, i);
  if (x.stored) return float_values(*x.stored);
  return {x.numbers.values.begin(), x.numbers.values.end()};
}

size_t OnnxImporter::channel_axis(const NodeReader& node, const OnnxValue& x) const {
  const int channels = shape(x)[3];
  const size_t axis = x.channels_last ? 3 : 1;
  if (x.dims.size() <= axis || x.dims[axis] != channels)
    node.fail("an input of shape " + to_string(x.dims) + " has no dimension of channels");
  return axis;
}

std::vector<double> OnnxImporter::per_channel(const NodeReader& node, size_t i, const OnnxValue& x) const {
  const Dims& dims = constant(node, i).dims;
  const std::vector<double> given = numbers(node, i);
  const size_t channels = static_cast<size_t>(shape(x)[3]);
  if (given.size() == 1) return std::vector<double>(channels, given[0]);
  // Dimensions are matched from the back.
  const size_t axis = channel_axis(node, x);
  const size_t behind = x.dims.size() - axis;  // from the channels on
  if (given.size() != channels || dims.size() < behind || dims[dims.size() - behind] != x.dims[axis])
    node.fail("constant of shape " + to_string(dims) + " on an input of shape " + to_string(x.dims) +
              " must hold one number, or one per channel");
  return given;
}

void OnnxImporter::define(const NodeReader& node, OnnxValue value) {
  const std::string_view name = node.node().outputs[0];
  count_constant(node, value.numbers.values.size());
  if (!values_.emplace(name, std::move(value)).second)
    node.fail("output \"" + printable(name) + "\" already has a value");
}

void OnnxImporter::count_constant(const NodeReader& node, size_t count) {
  n_constants_ += static_cast<int64_t>(count);
  if (n_constants_ > kMaxElements) node.fail("with it all constants together are more than 2^28 numbers");
}

int OnnxImporter::add_constant(const NodeReader& node, Shape shape, std::vector<float> values) {
  count_constant(node, values.size());
  const std::string name = format("constant %zu", graph_.tensors.size());
  graph_.tensors.push_back({name, std::move(shape), true, std::move(values)});
  return static_cast<int>(graph_.tensors.size()) - 1;
}

OnnxValue OnnxImporter::emit(const NodeReader& node, Attributes attributes, std::vector<int> inputs) {
  Op op{std::move(attributes), std::move(inputs), -1, Activation::kNone, -1};
  op.output = static_cast<int>(graph_.tensors.size());
  graph_.tensors.push_back({printable(node.node().outputs[0]), {}, false, {}});
  try {
    graph_.tensors[op.output].shape = infer_shape(graph_, op);
  } catch (const IoError& error) {
    throw IoError(std::string(error.what()) + " (" + node.label() + ")");
  }
  OnnxValue out;
  out.tensor = op.output;
  out.dims = channels_first(graph_.tensors[op.output].shape);
  if (element_count(graph_.tensors[op.output].shape) > kMaxElements)
    node.fail("output of shape " + to_string(out.dims) + " is larger than 2^28 elements");
  producers_[op.output] = graph_.ops.size();
  graph_.ops.push_back(std::move(op));
  return out;
}

OnnxValue OnnxImporter::emit_like(const NodeReader& node, Attributes attributes, std::vector<int> inputs,
                                  const OnnxValue& like) {
  const Dims dims = like.dims;
  const bool last = like.channels_last;
  OnnxValue out = emit(node, std::move(attributes), std::move(inputs));
  out.dims = dims;
  out.channels_last = last;
  return out;
}

Op* OnnxImporter::open_producer(const NodeReader& node, size_t i) {
  const OnnxValue& x = activation(node, i);
  const auto found = producers_.find(x.tensor);
  if (x.shared || uses_.at(node.node().inputs[i]) != 1 || found == producers_.end()) return nullptr;
  Op& op = graph_.ops[found->second];
  return op.activation == Activation::kNone ? &op : nullptr;
}

void OnnxImporter::rename(const NodeReader& node, Dims dims) {
  OnnxValue x = activation(node, 0);
  if (without_ones(dims) != without_ones(x.dims))
    node.fail("from shape " + to_string(x.dims) + " to " + to_string(dims) +
              " is not supported: only dimensions of 1 may come and go");
  x.shared = x.shared || uses_.at(node.node().inputs[0]) > 1;
  if (dims != x.dims) x.channels_last = dims != channels_first(shape(x)) && dims == channels_last(shape(x));
  x.dims = std::move(dims);
  define(node, std::move(x));
}

Graph load_onnx(const std::filesystem::path& path, int height, int width) {
  return parse_onnx(read_file(path), path.string(), height, width);
}

Graph parse_onnx(const std::string& bytes, const std::string& name, int height, int width) {
  const OnnxModel model = parse_onnx_model(bytes, name);
  return OnnxImporter(model, name, height, width).run();
}

}  // namespace livecap::nn

#include "nn/onnx_node.h"

#include "base/text.h"
#include "livecap/error.h"
#include "nn/graph.h"

namespace livecap::nn {

std::string NodeReader::label() const {
  return format("node #%zu ", index_) + printable(node_->type) +
         (node_->name.empty() ? "" : " \"" + printable(node_->name) + "\"");
}

void NodeReader::fail(const std::string& what) const {
  throw IoError(*file_ + ": " + label() + ": " + what);
}

void NodeReader::fail_attribute(std::string_view name, const std::string& what) const {
  fail("attribute \"" + printable(name) + "\": " + what);
}

const OnnxAttribute* NodeReader::find(std::string_view name, int type) {
  for (size_t i = 0; i < node_->attributes.size(); ++i) {
    const OnnxAttribute& attribute = node_->attributes[i];
    if (attribute.name != name) continue;
    if (attribute.type != type) fail_attribute(name, format("has type %d, must be %d", attribute.type, type));
    read_[i] = 1;
    return &attribute;
  }
  return nullptr;
}

int64_t NodeReader::integer(std::string_view name, int64_t fallback) {
  const OnnxAttribute* attribute = find(name, OnnxAttribute::kInt);
  return attribute ? attribute->integer : fallback;
}

float NodeReader::real(std::string_view name, float fallback) {
  const OnnxAttribute* attribute = find(name, OnnxAttribute::kFloat);
  return attribute ? attribute->real : fallback;
}

std::string NodeReader::text(std::string_view name, const std::string& fallback) {
  const OnnxAttribute* attribute = find(name, OnnxAttribute::kString);
  return attribute ? printable(attribute->text) : fallback;
}

std::vector<int64_t> NodeReader::integers(std::string_view name, const std::vector<int64_t>& fallback) {
  const OnnxAttribute* attribute = find(name, OnnxAttribute::kInts);
  return attribute ? attribute->integers : fallback;
}

std::vector<float> NodeReader::reals(std::string_view name) {
  const OnnxAttribute* attribute = find(name, OnnxAttribute::kFloats);
  return attribute ? attribute->reals : std::vector<float>{};
}

const OnnxTensor* NodeReader::tensor(std::string_view name) {
  const OnnxAttribute* attribute = find(name, OnnxAttribute::kTensor);
  if (!attribute) return nullptr;
  if (attribute->tensor.type == 0) fail_attribute(name, "holds no tensor");
  return &attribute->tensor;
}

bool NodeReader::has(std::string_view name) const {
  for (const OnnxAttribute& attribute : node_->attributes) {
    if (attribute.name == name) return true;
  }
  return false;
}

void NodeReader::require(std::string_view name, int64_t value) {
  const int64_t got = integer(name, value);
  if (got != value)
    fail_attribute(
        name, format("is %lld, only %lld is supported", static_cast<long long>(got), static_cast<long long>(value)));
}

void NodeReader::finish() const {
  for (size_t i = 0; i < read_.size(); ++i) {
    if (!read_[i]) fail_attribute(node_->attributes[i].name, "is not supported");
  }
}

}  // namespace livecap::nn

// One node of an ONNX graph while it is read: its attributes by name, and errors that name it.
#pragma once

#include <string>
#include <vector>

#include "nn/onnx_model.h"

namespace livecap::nn {

class NodeReader {
 public:
  // `file` and `node` must outlive the reader; `index`: of the node in the file.
  NodeReader(const std::string& file, const OnnxNode& node, size_t index) : file_(&file), node_(&node), index_(index) {
    read_.resize(node.attributes.size(), 0);
  }

  const OnnxNode& node() const { return *node_; }
  std::string_view type() const { return node_->type; }
  bool has_input(size_t i) const { return i < node_->inputs.size() && !node_->inputs[i].empty(); }
  std::string label() const;  // node #3 Conv "name"

  // An attribute, or the fallback when it is not there. Throws IoError when it has another type.
  int64_t integer(std::string_view name, int64_t fallback);
  float real(std::string_view name, float fallback);
  std::string text(std::string_view name, const std::string& fallback);
  std::vector<int64_t> integers(std::string_view name, const std::vector<int64_t>& fallback);
  std::vector<float> reals(std::string_view name);
  const OnnxTensor* tensor(std::string_view name);  // or null
  bool has(std::string_view name) const;

  // An attribute that must have this value when it is there.
  void require(std::string_view name, int64_t value);

  // Throws for attributes that nobody asked for: they may change what the node does.
  void finish() const;

  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_attribute(std::string_view name, const std::string& what) const;

 private:
  const OnnxAttribute* find(std::string_view name, int type);

  const std::string* file_;
  const OnnxNode* node_;
  size_t index_;
  std::vector<char> read_;  // per attribute
};

}  // namespace livecap::nn

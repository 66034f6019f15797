#include "nn/onnx_constants.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace livecap::nn {
namespace {

constexpr size_t kMostNumbers = 1 << 16;
constexpr size_t kMaxRank = 8;

const Numbers& required(const NodeReader& node, const std::vector<const Numbers*>& inputs, size_t i) {
  if (i >= inputs.size() || !inputs[i]) node.fail(format("input %zu is missing", i));
  return *inputs[i];
}

double apply(std::string_view type, double a, double b, bool integer) {
  if (type == "Add") return a + b;
  if (type == "Sub") return a - b;
  if (type == "Mul") return a * b;
  return integer ? std::trunc(a / b) : a / b;
}

// As broadcasting sees it.
Dims padded(Dims dims, size_t rank) {
  dims.insert(dims.begin(), rank - dims.size(), 1);
  return dims;
}

Numbers pairwise(NodeReader& node, const Numbers& a, const Numbers& b) {
  const size_t rank = std::max(a.dims.size(), b.dims.size());
  const Dims a_dims = padded(a.dims, rank), b_dims = padded(b.dims, rank);
  const bool as_a = b.values.size() == 1;
  if (!as_a && a.values.size() != 1 && a_dims != b_dims)
    node.fail("constants of shapes " + to_string(a.dims) + " and " + to_string(b.dims) +
              " must be equal or one number");
  Numbers out = as_a ? a : b;
  out.dims = as_a ? a_dims : b_dims;
  out.integer = a.integer && b.integer;
  for (size_t i = 0; i < out.values.size(); ++i) {
    const double x = a.values[a.values.size() == 1 ? 0 : i], y = b.values[b.values.size() == 1 ? 0 : i];
    if (node.type() == "Div" && out.integer && y == 0) node.fail("divides by zero");
    out.values[i] = apply(node.type(), x, y, out.integer);
  }
  return out;
}

Numbers gathered(NodeReader& node, const Numbers& from, const Numbers& indices) {
  node.require("axis", 0);
  if (from.dims.size() != 1) node.fail("constant of shape " + to_string(from.dims) + " must have 1 dimension");
  Numbers out{indices.dims, {}, from.integer};
  for (int64_t i : integers_of(indices.values)) {
    if (i < 0) i += static_cast<int64_t>(from.values.size());
    if (i < 0 || i >= static_cast<int64_t>(from.values.size()))
      node.fail(format("index %lld of %zu", static_cast<long long>(i), from.values.size()));
    out.values.push_back(from.values[i]);
  }
  return out;
}

Numbers sliced(NodeReader& node, const std::vector<const Numbers*>& inputs) {
  const Numbers& from = required(node, inputs, 0);
  std::vector<int64_t> starts, ends, steps{1};
  if (inputs.size() > 1) {
    starts = integers_of(required(node, inputs, 1).values);
    ends = integers_of(required(node, inputs, 2).values);
    if (inputs.size() > 4 && inputs[4]) steps = integers_of(inputs[4]->values);
  } else {
    starts = node.integers("starts", {});
    ends = node.integers("ends", {});
    node.integers("axes", {});
  }
  if (from.dims.size() != 1 || starts.size() != 1 || ends.size() != 1 || steps != std::vector<int64_t>{1})
    node.fail("of constants only slices of one dimension with step 1 are supported");
  const int64_t n = static_cast<int64_t>(from.values.size());
  const auto place = [&](int64_t i) { return std::clamp<int64_t>(i < 0 ? i + n : i, 0, n); };
  const int64_t begin = place(starts[0]), end = std::max(begin, place(ends[0]));
  return {{end - begin}, {from.values.begin() + begin, from.values.begin() + end}, from.integer};
}

// The axes of Squeeze and Unsqueeze: an attribute, since opset 13 an input.
std::vector<int64_t> axes_of(NodeReader& node, const std::vector<const Numbers*>& inputs) {
  return inputs.size() > 1 && inputs[1] ? integers_of(inputs[1]->values) : node.integers("axes", {});
}

}  // namespace

std::vector<int64_t> integers_of(const std::vector<double>& values) {
  std::vector<int64_t> out;
  // Far out of range values (an open end of a Slice) stay far out.
  for (double v : values) out.push_back(std::isnan(v) ? 0 : static_cast<int64_t>(std::clamp(v, -4e18, 4e18)));
  return out;
}

int64_t positive_axis(const NodeReader& node, int64_t axis, size_t rank) {
  const int64_t n = static_cast<int64_t>(rank);
  if (axis < -n || axis >= n) node.fail(format("axis %lld of %zu dimensions", static_cast<long long>(axis), rank));
  return axis < 0 ? axis + n : axis;
}

Dims reshaped(const NodeReader& node, const Dims& from, const std::vector<double>& target) {
  if (target.size() > kMaxRank) node.fail(format("%zu dimensions, at most %zu are supported", target.size(), kMaxRank));
  int64_t total = 1, known = 1;
  for (int64_t n : from) total *= n;
  Dims out;
  int open = -1;
  for (size_t i = 0; i < target.size(); ++i) {
    if (!(target[i] >= -1 && target[i] <= 1e9)) node.fail(format("size %g is out of range", target[i]));
    int64_t n = static_cast<int64_t>(target[i]);
    if (n == 0 && i < from.size()) n = from[i];
    if (n == -1 && open < 0) {
      open = static_cast<int>(i);
    } else if (n < 1 || n > total) {
      node.fail("cannot reshape " + to_string(from) + format(" to a size of %g", target[i]));
    } else {
      known *= n;
    }
    if (known > total) break;
    out.push_back(n);
  }
  if (open >= 0 && known > 0 && known <= total) out[open] = total / known, known *= out[open];
  if (known != total || out.size() != target.size())
    node.fail("shape " + to_string(from) + " cannot become " + to_string(out));
  return out;
}

Dims squeezed(const NodeReader& node, const Dims& from, const std::vector<int64_t>& axes) {
  std::vector<char> drop(from.size(), 0);
  for (int64_t axis : axes) drop[positive_axis(node, axis, from.size())] = 1;
  Dims out;
  for (size_t i = 0; i < from.size(); ++i) {
    if (drop[i] && from[i] != 1) node.fail("squeezes a size that is not 1 of " + to_string(from));
    if (!drop[i] && !(axes.empty() && from[i] == 1)) out.push_back(from[i]);
  }
  return out;
}

Dims unsqueezed(const NodeReader& node, const Dims& from, const std::vector<int64_t>& axes) {
  const size_t rank = from.size() + axes.size();
  if (rank > kMaxRank) node.fail(format("%zu dimensions, at most %zu are supported", rank, kMaxRank));
  std::vector<char> added(rank, 0);
  for (int64_t axis : axes) {
    const int64_t at = positive_axis(node, axis, rank);
    if (added[at]) node.fail("names an axis twice");
    added[at] = 1;
  }
  Dims out;
  size_t next = 0;
  for (size_t i = 0; i < rank; ++i) out.push_back(added[i] ? 1 : from[next++]);
  return out;
}

bool is_foldable(std::string_view type) {
  for (const char* known : {"Add", "Sub", "Mul", "Div", "Floor", "Ceil", "Cast", "Concat", "Gather", "Slice", "Reshape",
                            "Squeeze", "Unsqueeze"}) {
    if (type == known) return true;
  }
  return false;
}

Numbers fold_constants(NodeReader& node, const std::vector<const Numbers*>& inputs) {
  size_t count = 0;
  for (const Numbers* numbers : inputs) count += numbers ? numbers->values.size() : 0;
  if (count > kMostNumbers) node.fail(format("on constants of %zu numbers is not supported", count));
  const std::string_view type = node.type();
  Numbers out = required(node, inputs, 0);
  if (type == "Add" || type == "Sub" || type == "Mul" || type == "Div") {
    out = pairwise(node, out, required(node, inputs, 1));
  } else if (type == "Floor" || type == "Ceil") {
    for (double& v : out.values) v = type == "Floor" ? std::floor(v) : std::ceil(v);
  } else if (type == "Cast") {
    const int64_t to = node.integer("to", 0);
    out.integer = to == 6 || to == 7;
    if (!out.integer && to != 1 && to != 11)
      node.fail_attribute("to", "only float, double, int32 and int64 are supported");
    if (out.integer) {
      for (double& v : out.values) v = std::trunc(v);
    }
  } else if (type == "Concat") {
    if (node.integer("axis", 0) != 0) node.fail_attribute("axis", "must be 0 for constants");
    out.values.clear();
    for (size_t i = 0; i < inputs.size(); ++i) {
      const Numbers& part = required(node, inputs, i);
      if (part.dims.size() != 1) node.fail("constants must have 1 dimension");
      out.values.insert(out.values.end(), part.values.begin(), part.values.end());
    }
    out.dims = {static_cast<int64_t>(out.values.size())};
  } else if (type == "Gather") {
    out = gathered(node, out, required(node, inputs, 1));
  } else if (type == "Slice") {
    out = sliced(node, inputs);
  } else if (type == "Reshape") {
    node.require("allowzero", 0);
    out.dims = reshaped(node, out.dims, required(node, inputs, 1).values);
  } else if (type == "Squeeze") {
    out.dims = squeezed(node, out.dims, axes_of(node, inputs));
  } else {
    out.dims = unsqueezed(node, out.dims, axes_of(node, inputs));
  }
  node.finish();
  return out;
}

}  // namespace livecap::nn

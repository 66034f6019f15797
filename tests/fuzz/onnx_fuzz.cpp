// Networks in .onnx.
#include "fuzz/fuzz.h"
#include "fuzz/run_network.h"
#include "nn/onnx_import.h"
#include "nn/onnx_nets.h"

namespace livecap::fuzz {
namespace {

// The importer's operators on a few pixels.
std::string every_operator() {
  test::Net net(1);
  const std::string stem = net.relu6(net.batch_norm(net.conv("x", 3, 4, 3, 2), 4));
  const std::string up =
      net.op("ConvTranspose", {stem, net.random({4, 2, 2, 2})}, {test::onnx_ints("strides", {2, 2})});
  const std::string padded = net.op("Pad", {up, net.list({0, 0, 1, 1, 0, 0, 1, 1})});
  const std::string pooled =
      net.op("AveragePool", {padded}, {test::onnx_ints("kernel_shape", {3, 3}), test::onnx_ints("strides", {2, 2})});
  const std::string sized = net.op("Resize", {pooled, "", net.numbers({4}, {1, 1, 2, 2})}, {});
  const std::string joined = net.op("Concat", {sized, net.op("Sigmoid", {sized})}, {test::onnx_int("axis", 1)});
  const std::string turned = net.op("Transpose", {joined}, {test::onnx_ints("perm", {0, 2, 3, 1})});
  const std::string back = net.op("Transpose", {turned}, {test::onnx_ints("perm", {0, 3, 1, 2})});
  const std::string scaled = net.op("Mul", {back, net.numbers({1, 4, 1, 1}, {1, 2, 3, 4})});
  const std::string flat = net.op("Flatten", {net.op("GlobalMaxPool", {scaled})});
  net.op("Softmax", {net.op("Gemm", {flat, net.random({3, 4})}, {test::onnx_int("transB", 1)})});
  return net.model({1, 3, 4, 4}, {net.last, scaled});
}

// Sizes that are computed when the network is read.
std::string computed_sizes() {
  test::Net net(2);
  const std::string features = net.conv("x", 2, 3, 1);
  const std::string height =
      net.op("Gather", {net.op("Shape", {features}), net.list({2})}, {test::onnx_int("axis", 0)});
  const std::string twice = net.op("Cast", {net.op("Mul", {height, net.list({2})})}, {test::onnx_int("to", 7)});
  const std::string front = net.op("Slice", {net.op("Shape", {features}), net.list({0}), net.list({2})});
  const std::string sizes = net.op("Concat", {front, twice, net.list({6})}, {test::onnx_int("axis", 0)});
  net.op("ArgMax", {net.op("Resize", {features, "", "", sizes})}, {test::onnx_int("axis", 1)});
  return net.model({1, 2, 3, 3}, {net.last});
}

}  // namespace

std::vector<std::string> seeds() {
  return {every_operator(), computed_sizes(), test::aspp_head(true)};
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  fuzz::accepts("net.onnx", [&] { fuzz::run_network(nn::parse_onnx(bytes, "net.onnx", 4, 4)); });
  return 0;
}

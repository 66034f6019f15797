// Damaged and unsupported ONNX files give one clear line, never anything else.
#include <gtest/gtest.h>

#include "livecap/error.h"
#include "nn/onnx_import.h"
#include "nn/onnx_nets.h"
#include "nn/protobuf_reader.h"

namespace livecap {
namespace {

using test::Net;
using test::onnx_float;
using test::onnx_int;
using test::onnx_ints;
using test::onnx_text;

// The error, one line that begins with the name; empty when it loads.
std::string failure(const std::string& bytes, int height = 0, int width = 0) {
  try {
    nn::validate(nn::parse_onnx(bytes, "net.onnx", height, width));
    return {};
  } catch (const IoError& e) {
    const std::string message = e.what();
    EXPECT_EQ(message.rfind("net.onnx: ", 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
}

void expect_named(const std::string& message, const std::vector<std::string>& words) {
  EXPECT_FALSE(message.empty()) << "loads";
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << message << ": no " << word;
}

TEST(OnnxDamage, EveryTruncationIsRefused) {
  for (const std::string& whole : {test::aspp_head(true), test::mobile_net_block()}) {
    ASSERT_EQ(failure(whole), "");
    for (size_t length = 0; length < whole.size(); ++length) ASSERT_NE(failure(whole.substr(0, length)), "") << length;
  }
  expect_named(failure(""), {"0 bytes", "no graph"});
  expect_named(failure(test::aspp_head(false).substr(0, 400)), {"byte 8", "field 7 of ModelProto", "truncated"});
}

TEST(OnnxDamage, FlippedBytesNeverCrash) {
  const std::string whole = test::aspp_head(true);
  std::mt19937 rng(21);
  int refused = 0;
  for (int i = 0; i < 4000; ++i) {
    std::string bytes = whole;
    for (int flips = 1 + i % 3; flips > 0; --flips) {
      char& byte = bytes[rng() % bytes.size()];
      byte = static_cast<char>(i % 2 ? rng() : byte ^ (1 << rng() % 8));
    }
    refused += !failure(bytes).empty();
  }
  EXPECT_GT(refused, 200);
}

TEST(OnnxDamage, GarbageIsRefused) {
  std::mt19937 rng(22);
  for (int i = 0; i < 300; ++i) {
    std::string bytes(1 + i, '\0');
    for (char& c : bytes) c = static_cast<char>(rng());
    EXPECT_NE(failure(bytes), "");
  }
  EXPECT_NE(failure(std::string(5000, '\0')), "");
  EXPECT_NE(failure(std::string(5000, '\xff')), "");
  expect_named(failure("TFL3 is another format"), {"byte 0", "ModelProto"});
  EXPECT_THROW(nn::load_onnx("/no/such/net.onnx"), IoError);
}

TEST(OnnxDamage, WireReaderKnowsItsLimits) {
  const std::string file = "f";
  const auto error = [&](const std::string& bytes) -> std::string {
    try {
      nn::WireReader reader(file, "M", bytes);
      while (reader.next()) {
      }
    } catch (const IoError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_EQ(error(test::wire_integer(1, -1)), "");
  EXPECT_EQ(error(std::string("\x08") + std::string(11, '\x80')),
            "f: byte 0: field 1 of M: a number of more than 10 bytes: the file is damaged");
  expect_named(error("\x0a\x05zz"), {"byte 0", "field 1", "5 bytes", "2 are left"});
  expect_named(error("\x0b"), {"wire type 3"});
  expect_named(error(std::string("\x0d\0\0", 3)), {"states 4 bytes, 2 are left"});
  std::vector<int64_t> integers;
  const std::string packed = test::wire_bytes(4, test::wire_varint(300) + test::wire_varint(uint64_t(-2)));
  nn::WireReader reader(file, "M", packed);
  ASSERT_TRUE(reader.next());
  reader.append_to(integers);
  EXPECT_EQ(integers, (std::vector<int64_t>{300, -2}));
  EXPECT_THROW(reader.integer(), IoError);
  EXPECT_THROW(reader.real(), IoError);
}

// One node on the input, [1,3,8,8].
std::string one_node(const std::string& type, const std::vector<std::string>& attributes, bool weights = false) {
  Net net(23);
  std::vector<std::string> inputs = {"x"};
  if (weights) inputs.push_back(net.random({4, 3, 3, 3}));
  net.op(type, inputs, attributes);
  return net.model({1, 3, 8, 8}, {net.last});
}

TEST(OnnxDamage, UnsupportedIsNamed) {
  expect_named(failure(one_node("GridSample", {})), {"node #0 GridSample", "not supported", "Conv"});
  expect_named(failure(one_node("Conv", {onnx_int("novelty", 1)}, true)), {"node #0 Conv", "attribute \"novelty\""});
  expect_named(failure(one_node("Conv", {onnx_int("group", 2)}, true)), {"Conv", "attribute \"group\"", "2"});
  expect_named(failure(one_node("Conv", {onnx_int("strides", 2)}, true)), {"Conv", "\"strides\"", "type 2, must be 7"});
  expect_named(failure(one_node("Conv", {onnx_ints("strides", {0, 1})}, true)), {"\"strides\"", "1..4096"});
  expect_named(failure(one_node("Conv", {onnx_ints("pads", {0, 0, -1, 0})}, true)), {"\"pads\"", "-1"});
  expect_named(failure(one_node("Conv", {onnx_ints("dilations", {9, 9})}, true)), {"19 does not fit into 8"});
  expect_named(failure(one_node("Conv", {onnx_text("auto_pad", "SOME")}, true)), {"\"auto_pad\"", "SOME", "VALID"});
  expect_named(failure(one_node("Conv", {})), {"Conv", "input 1 is missing"});
  expect_named(failure(one_node("ConvTranspose", {})), {"ConvTranspose", "input 1 is missing"});
  expect_named(failure(one_node("ConvTranspose", {onnx_int("group", 3)}, true)), {"ConvTranspose"});
  expect_named(failure(one_node("MaxPool", {})), {"MaxPool", "\"kernel_shape\"", "missing"});
  expect_named(failure(one_node("Clip", {onnx_float("min", -1)})), {"Clip", "-1", "0..6"});
  expect_named(failure(one_node("Transpose", {onnx_ints("perm", {0, 1, 3, 2})})), {"Transpose", "\"perm\""});
  expect_named(failure(one_node("Flatten", {})), {"Flatten", "[1,3,8,8]", "[1,192]"});
  expect_named(failure(one_node("ArgMax", {onnx_int("axis", 2)})), {"ArgMax", "\"axis\"", "channels"});
  expect_named(failure(one_node("ArgMax", {onnx_int("axis", 7)})), {"ArgMax", "axis 7 of 4"});
  expect_named(failure(one_node("Resize", {onnx_text("mode", "cubic")})), {"Resize", "scales or sizes"});
  expect_named(failure(one_node("Cast", {onnx_int("to", 10)})), {"Cast", "\"to\"", "10"});
}

TEST(OnnxDamage, InputsAndWeightsThatDoNotFit) {
  Net net(24);
  net.conv("x", 3, 4, 3);
  expect_named(failure(net.model({1, 5, 8, 8}, {net.last})), {"Conv", "[4,3,3,3]", "5 channels"});
  expect_named(failure(net.model({2, 3, 8, 8}, {net.last})), {"input \"x\"", "[2,3,8,8]", "batch 1"});
  expect_named(failure(net.model({1, 3, 0, 0}, {net.last})), {"input \"x\"", "[1,3,?,?]", "height"});
  EXPECT_EQ(failure(net.model({1, 3, 0, 0}, {net.last}), 8, 9), "");
  EXPECT_EQ(failure(net.model({1, 3, 0, 9}, {net.last}), 8), "");
  expect_named(failure(net.model({1, 3, 0, 8}, {net.last}), 1 << 20, 8), {"height 1048576", "16384"});
  expect_named(failure(net.model({1, 3, 8}, {net.last})), {"input \"x\"", "[1,3,8]"});
  expect_named(failure(net.model({1, 3, 8, 8}, {"nothing"})), {"output \"nothing\"", "no node"});
  expect_named(failure(net.model({1, 3, 8, 8}, {net.last}, 5)), {"operator set 5", "7"});

  Net tensors(25);
  tensors.tensor(test::onnx_tensor("short", {2, 2}, 1, std::string(12, '\0')));
  tensors.op("Relu", {"x"});
  expect_named(failure(tensors.model({1, 3, 8, 8}, {tensors.last})), {"byte", "\"short\"", "3 values", "[2,2]"});
  Net texts(26);
  texts.tensor(test::onnx_tensor("words", {1}, 8, "a"));
  texts.op("Relu", {"x"});
  expect_named(failure(texts.model({1, 3, 8, 8}, {texts.last})), {"\"words\"", "data type 8", "float"});
  Net elsewhere(27);
  elsewhere.tensor(test::onnx_tensor("far", {1}, 1, "") + test::wire_integer(14, 1));
  elsewhere.op("Relu", {"x"});
  expect_named(failure(elsewhere.model({1, 3, 8, 8}, {elsewhere.last})), {"\"far\"", "another file"});
}

// Sizes that are computed from constants of which one is repeated, also where there is nothing to repeat it for.
TEST(OnnxDamage, ConstantsOfDifferentShapes) {
  const auto resized_to = [](Net& net, const std::string& sizes) {
    net.op("Resize", {"x", "", "", sizes});
    return failure(net.model({1, 3, 8, 8}, {net.last}));
  };
  Net other_rank(30);
  EXPECT_EQ(
      resized_to(other_rank, other_rank.op("Mul", {other_rank.list({1, 3, 4, 4}), other_rank.numbers({1, 1}, {1})})),
      "");
  Net nothing(31);
  const std::string empty = nothing.op("Slice", {nothing.list({1, 2}), nothing.list({0}), nothing.list({0})});
  expect_named(resized_to(nothing, nothing.op("Mul", {nothing.list({2}), empty})), {"Resize", "4 constant scales"});
  // As many numbers, but of a column and a row: each of the one with each of the other, which is not supported.
  Net crossed(33);
  expect_named(resized_to(crossed, crossed.op("Mul", {crossed.numbers({4, 1}, {1, 3, 4, 4}),
                                                      crossed.numbers({1, 4}, {1, 1, 1, 1})})),
               {"Mul", "[4,1] and [1,4]", "must be equal or one number"});
  Net leading(34);
  EXPECT_EQ(resized_to(leading, leading.op("Mul", {leading.list({1, 3, 4, 4}), leading.numbers({1, 4}, {1, 1, 1, 1})})),
            "");
  Net far(32);
  far.op("Squeeze", {"x", far.numbers({1}, {1e30f})});
  expect_named(failure(far.model({1, 3, 8, 8}, {far.last})), {"Squeeze", "axis 4000000000000000000 of 4"});
}

// Nodes may name the same weights again and again: the file stays small, the graph does not.
TEST(OnnxDamage, AllConstantsTogetherHaveALimit) {
  Net shared(29);
  const std::string weights = shared.random({1024, 1024, 1, 1}, 0, 0);
  for (int i = 0; i < 300; ++i) shared.op("Conv", {"x", weights});
  std::vector<std::string> all;
  for (int i = 0; i < 300; ++i) all.push_back("v" + std::to_string(1 + i));
  shared.op("Concat", all);
  expect_named(failure(shared.model({1, 1024, 1, 1}, {shared.last})), {"node #", "Conv", "2^28"});
}

// Half precision weights are the same numbers.
TEST(OnnxDamage, HalfPrecisionWeights) {
  Net net(28);
  net.tensor(test::onnx_tensor("half", {1, 1, 1, 1}, 10, test::raw_bytes(std::vector<uint16_t>{0xc000})));
  net.op("Conv", {"x", "half"});
  const nn::Graph graph = nn::parse_onnx(net.model({1, 1, 2, 2}, {net.last}), "net.onnx");
  EXPECT_EQ(graph.tensors[graph.ops[0].inputs[1]].values, std::vector<float>{-2});
}

}  // namespace
}  // namespace livecap

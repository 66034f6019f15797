// Damaged model files give IoError or a graph that still runs, never anything else.
#include "nn/tflite_import.h"

#include <gtest/gtest.h>

#include <random>

#include "base/text.h"
#include "livecap/error.h"
#include "nn/half.h"
#include "nn/models.h"
#include "support/tflite_writer.h"

namespace livecap {
namespace {

// True when it loads; an error must be one line that begins with the name.
bool loads(const std::string& bytes) {
  try {
    const nn::Graph graph = nn::parse_tflite(bytes, "model.tflite");
    nn::validate(graph);
    return true;
  } catch (const IoError& e) {
    const std::string message = e.what();
    EXPECT_EQ(message.rfind("model.tflite", 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return false;
  }
}

TEST(TfliteImport, HalfPrecision) {
  EXPECT_EQ(nn::float_from_half(0x0000), 0.0f);
  EXPECT_EQ(nn::float_from_half(0x3c00), 1.0f);
  EXPECT_EQ(nn::float_from_half(0xc000), -2.0f);
  EXPECT_EQ(nn::float_from_half(0x7bff), 65504.0f);
  EXPECT_EQ(nn::float_from_half(0x0001), 0x1p-24f);
  EXPECT_EQ(nn::float_from_half(0x03ff), 1023 * 0x1p-24f);
  EXPECT_EQ(nn::float_from_half(0xfc00), -std::numeric_limits<float>::infinity());
  EXPECT_NE(nn::float_from_half(0x7e00), nn::float_from_half(0x7e00));
}

TEST(TfliteImport, GarbageIsRefused) {
  EXPECT_FALSE(loads(""));
  EXPECT_FALSE(loads("TFL3"));
  EXPECT_FALSE(loads(std::string(1000, 'x')));
  EXPECT_FALSE(loads(std::string("\x10\0\0\0TFL3", 8).append(100, '\xff')));
  std::mt19937 rng(5);
  for (int i = 0; i < 100; ++i) {
    std::string bytes(200 + i, '\0');
    for (char& c : bytes) c = static_cast<char>(rng());
    bytes.replace(4, 4, "TFL3");
    EXPECT_FALSE(loads(bytes));
  }
  EXPECT_THROW(nn::load_tflite("/no/such/model.tflite"), IoError);
}

TEST(TfliteImport, ReadsTheLiteModel) {
  LIVECAP_MODEL_OR_SKIP(path, "lite");
  const nn::Graph graph = nn::load_tflite(path);
  EXPECT_EQ(graph.outputs.size(), 5u);
  EXPECT_EQ(nn::multiply_add_count(graph) / 1000000, 197);
  EXPECT_EQ(graph.ops.size(), 129u);
}

TEST(TfliteImport, TruncatedFilesAreRefused) {
  LIVECAP_MODEL_OR_SKIP(path, "lite");
  const std::string whole = read_file(path);
  ASSERT_TRUE(loads(whole));
  std::mt19937 rng(6);
  for (size_t length = 0; length < 400; length += 7) EXPECT_FALSE(loads(whole.substr(0, length))) << length;
  for (int i = 0; i < 60; ++i) {
    const size_t length = rng() % (whole.size() - 64);
    EXPECT_FALSE(loads(whole.substr(0, length))) << length;
  }
}

TEST(TfliteImport, FlippedBytesNeverCrash) {
  LIVECAP_MODEL_OR_SKIP(path, "lite");
  const std::string whole = read_file(path);
  // The tables are at both ends of the file; the weights between them are just numbers.
  const size_t tables = 64 * 1024;
  std::mt19937 rng(8);
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string bytes = whole;
    for (int flips = 1 + i % 4; flips > 0; --flips) {
      size_t at = rng() % tables;
      if (i % 2) at = whole.size() - 1 - at;
      bytes[at] = static_cast<char>(i % 3 ? rng() : bytes[at] ^ (1 << rng() % 8));
    }
    refused += !loads(bytes);
  }
  EXPECT_GT(refused, 20);  // the damage reached the tables
}

// Tensors may name the same bytes again and again: the file stays small, the graph does not.
TEST(TfliteImport, AllConstantsTogetherHaveALimit) {
  test::TfliteWriter net;
  const uint32_t weights = net.buffer_of(std::vector<float>(1 << 20));
  for (int i = 0; i < 300; ++i) net.tensor({1 << 20}, weights);
  const int x = net.tensor({1, 4});
  const std::string bytes = net.model({x}, {net.op(14, {x}, {1, 4})});
  EXPECT_LT(bytes.size(), size_t{5} << 20);
  try {
    nn::parse_tflite(bytes, "model.tflite");
    ADD_FAILURE() << "loads";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("2^28 numbers"), std::string::npos) << e.what();
  }
}

TEST(TfliteImport, EveryOperatorIsRead) {
  const nn::Graph graph = nn::parse_tflite(test::small_tflite(), "model.tflite");
  EXPECT_EQ(graph.ops.size(), 8u);
  EXPECT_EQ(graph.outputs.size(), 2u);
}

TEST(TfliteImport, UnsupportedOperatorIsNamed) {
  LIVECAP_MODEL_OR_SKIP(path, "lite");
  const std::string whole = read_file(path);
  // Find an operator code table of LOGISTIC (14) by trying to change single bytes of that value into SOFTMAX (25).
  bool named = false;
  for (size_t at = 0; at < whole.size() && !named; ++at) {
    if (at == 16 * 1024) at = whole.size() - 16 * 1024;
    if (whole[at] != 14) continue;
    std::string bytes = whole;
    bytes[at] = 25;
    try {
      nn::parse_tflite(bytes, "model.tflite");
    } catch (const IoError& e) {
      named = std::string(e.what()).find("operator SOFTMAX") != std::string::npos &&
              std::string(e.what()).find("not supported") != std::string::npos;
    }
  }
  EXPECT_TRUE(named);
}

}  // namespace
}  // namespace livecap

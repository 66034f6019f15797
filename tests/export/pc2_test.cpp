#include "export/pc2.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/text.h"
#include "livecap/error.h"
#include "support/data_dir.h"

namespace livecap {
namespace {

std::filesystem::path pc2_scratch(const char* name) {
  return std::filesystem::path(testing::TempDir()) / name;
}

std::string message_of(const std::filesystem::path& path) {
  try {
    read_pc2(path);
  } catch (const IoError& e) {
    return e.what();
  }
  return "";
}

TEST(Pc2, TheFileIsValidAfterEveryFrame) {
  const auto path = pc2_scratch("valid.pc2");
  Pc2Writer writer(path, 2, 3.f, 1.f);
  EXPECT_EQ(read_pc2(path).n_samples, 0);
  std::vector<float> all;
  for (int frame = 0; frame < 5; ++frame) {
    std::vector<float> xyz = {frame + .25f, 1, 2, -3, 4, frame * 1e-3f};
    if (frame == 2) xyz.assign(6, NAN);
    writer.append(xyz);
    all.insert(all.end(), xyz.begin(), xyz.end());
    const Pc2 cache = read_pc2(path);
    ASSERT_EQ(cache.n_samples, frame + 1);
    EXPECT_EQ(cache.n_points, 2);
    EXPECT_EQ(cache.start, 3.f);
    EXPECT_EQ(std::memcmp(cache.samples.data(), all.data(), all.size() * 4), 0);
  }
  EXPECT_EQ(std::filesystem::file_size(path), 32u + 5 * 24);
}

// The layout spelled out byte by byte.
TEST(Pc2, HasTheDocumentedBytes) {
  const auto path = pc2_scratch("bytes.pc2");
  Pc2Writer(path, 1).append(std::vector<float>{1, 2, 3});
  const std::string bytes = read_file(path);
  const unsigned char expected[] = {'P', 'O', 'I', 'N', 'T',  'C',  'A', 'C', 'H', 'E',  '2', 0,    1,    0,   0,
                                    0,   1,   0,   0,   0,    0,    0,   0,   0,   0,    0,   0x80, 0x3f, 1,   0,
                                    0,   0,   0,   0,   0x80, 0x3f, 0,   0,   0,   0x40, 0,   0,    0x40, 0x40};
  ASSERT_EQ(bytes.size(), sizeof expected);
  EXPECT_EQ(std::memcmp(bytes.data(), expected, sizeof expected), 0);
}

TEST(Pc2, BrokenFilesAreRefusedByName) {
  const auto path = pc2_scratch("broken.pc2");
  EXPECT_NE(message_of(pc2_scratch("absent.pc2")).find("absent.pc2"), std::string::npos);
  Pc2Writer(path, 3).append(std::vector<float>(9, 1.f));
  const std::string good = read_file(path);
  for (size_t size = 0; size < good.size(); ++size) {
    write_file_atomically(path, good.substr(0, size));
    EXPECT_NE(message_of(path).find("broken.pc2"), std::string::npos) << size;
  }
  EXPECT_NE(message_of(path).find("truncated"), std::string::npos);
  std::string wrong = good;
  wrong[12] = 2;
  write_file_atomically(path, wrong);
  EXPECT_NE(message_of(path).find("version 2"), std::string::npos);
  wrong = good;
  std::memset(wrong.data() + 16, 0x7f, 4);  // two billion points
  std::memset(wrong.data() + 28, 0x7f, 4);
  write_file_atomically(path, wrong);
  EXPECT_NE(message_of(path).find("truncated"), std::string::npos);
  // So many that the bytes they need are 32 modulo 2^64.
  for (const auto& [at, count] : {std::pair{16, 842443544}, std::pair{28, 1824726041}})
    std::memcpy(wrong.data() + at, &count, 4);
  write_file_atomically(path, wrong);
  EXPECT_NE(message_of(path).find("truncated"), std::string::npos);
  EXPECT_THROW(Pc2Writer("/nonexistent/folder/x.pc2", 3), IoError);
  Pc2Writer writer(path, 3);
  EXPECT_THROW(writer.append(std::vector<float>(8, 1.f)), LogicError);
}

TEST(Pc2, ReadsAForeignCache) {
  LIVECAP_DATA_OR_SKIP(path, "skirt_dance/truth/vertices.pc2");
  Pc2Reader reader(path);
  EXPECT_EQ(reader.n_points(), 5003);
  EXPECT_EQ(reader.n_samples(), 160);
  std::vector<float> xyz(3 * 5003);
  reader.read(100, xyz);
  for (float x : xyz) ASSERT_TRUE(std::abs(x) < 20);
  reader.read(0, xyz);  // the empty room
  EXPECT_TRUE(std::isnan(xyz[0]));
}

}  // namespace
}  // namespace livecap

// Numbers with tags (kernels/shared/tagged.h), asked for by a kernel of this test's own.
#include <CL/cl.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "ocl/buffer.h"
#include "ocl/groups_together.h"
#include "ocl/kernel_source.h"
#include "support/test_device.h"

namespace livecap {
namespace {

constexpr uint32_t kTag = 7;
constexpr int kItems = 4, kAtOnce = 3;

// take: every work-item of one group takes three words, four apart. pass_on: a group a word, from group to group.
constexpr char kTaggedSource[] = R"(
kernel void take(int end, global const ulong* words, uint tag, global int* state, global float* values,
                 global int* had) {
  const int id = get_local_id(0);
  float taken[TAGGED_AT_ONCE];
  had[id] = take_tagged(3, id, 4, end, words, tag, state, taken);
  for (int k = 0; k < 3; ++k) values[id * 3 + k] = taken[k];
}
kernel void pass_on(global ulong* words, uint tag, global int* state, global int* had) {
  const int group = get_group_id(0);
  if (get_local_id(0) != 0) return;
#ifdef FENCE_OF_DEVICE
  state[0] = 1;
#endif
  float taken[TAGGED_AT_ONCE];
  had[group] = take_tagged(1, group, 1, group + 1, words, tag, state, taken);
  if (had[group]) ((volatile global ulong*)words)[group + 1] = tagged(taken[0] + 1.0f, tag);
})";

uint64_t word(float value, uint32_t tag) {
  return uint64_t(tag) << 32 | std::bit_cast<uint32_t>(value);
}

class TaggedKernel {
 public:
  TaggedKernel(ocl::DeviceContext& device, const char* name) : queue_(device.queue()) {
    const std::string source = ocl::resolve_kernel_source("shared/tagged.h") + kTaggedSource;
    const char* text = source.c_str();
    const size_t size = source.size();
    const cl_device_id id = device.info().device;
    program_ = clCreateProgramWithSource(device.context(), 1, &text, &size, nullptr);
    EXPECT_EQ(clBuildProgram(program_, 1, &id, "-cl-std=CL1.2 -w", nullptr, nullptr), CL_SUCCESS);
    kernel_ = clCreateKernel(program_, name, nullptr);
  }
  ~TaggedKernel() {
    clReleaseKernel(kernel_);
    clReleaseProgram(program_);
  }
  TaggedKernel(const TaggedKernel&) = delete;
  TaggedKernel& operator=(const TaggedKernel&) = delete;

  template <typename... Args>
  void launch(size_t n, size_t local, const Args&... args) {
    cl_uint index = 0;
    (set(index++, args), ...);
    EXPECT_EQ(clEnqueueNDRangeKernel(queue_, kernel_, 1, nullptr, &n, &local, 0, nullptr, nullptr), CL_SUCCESS);
    clFinish(queue_);
  }

 private:
  template <typename T>
  void set(cl_uint index, const ocl::Buffer<T>& buffer) {
    const cl_mem memory = buffer.memory();
    EXPECT_EQ(clSetKernelArg(kernel_, index, sizeof(memory), &memory), CL_SUCCESS);
  }
  template <typename T>
  requires std::is_arithmetic_v<T>
  void set(cl_uint index, T value) { EXPECT_EQ(clSetKernelArg(kernel_, index, sizeof(value), &value), CL_SUCCESS); }

  cl_command_queue queue_;
  cl_program program_ = nullptr;
  cl_kernel kernel_ = nullptr;
};

struct Taken {
  std::vector<float> values;
  std::vector<int32_t> had, state;
};

Taken take(ocl::DeviceContext& device, const std::vector<uint64_t>& words, int end) {
  TaggedKernel kernel(device, "take");
  ocl::Buffer<uint64_t> given(device, words);
  ocl::Buffer<int32_t> state(device, std::vector<int32_t>{0, 0}), had(device, kItems);
  ocl::Buffer<float> values(device, kItems * kAtOnce);
  kernel.launch(kItems, kItems, end, given, kTag, state, values, had);
  return {values.read_all(), had.read_all(), state.read_all()};
}

std::vector<uint64_t> words_from(float first) {
  std::vector<uint64_t> words;
  for (int i = 0; i < kItems * kAtOnce; ++i) words.push_back(word(first + float(i), kTag));
  return words;
}

TEST(Tagged, AreTakenWhereTheTagIsThere) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Taken taken = take(device, words_from(0.5f), kItems * kAtOnce);
    for (int id = 0; id < kItems; ++id) {
      EXPECT_EQ(taken.had[id], 1);
      for (int k = 0; k < kAtOnce; ++k) EXPECT_EQ(taken.values[id * kAtOnce + k], 0.5f + float(id + k * kItems));
    }
    EXPECT_EQ(taken.state[1], 0);
  });
}

// Whatever tag is behind the end.
TEST(Tagged, ThereIsNothingBehindTheEnd) {
  test::on_every_device([](ocl::DeviceContext& device) {
    constexpr int kEnd = 6;
    std::vector<uint64_t> words = words_from(0.5f);
    for (size_t i = kEnd; i < words.size(); ++i) words[i] = word(1e9f, kTag - 1);
    const Taken taken = take(device, words, kEnd);
    for (int id = 0; id < kItems; ++id) {
      EXPECT_EQ(taken.had[id], 1);
      for (int k = 0; k < kAtOnce; ++k) {
        const int i = id + k * kItems;
        EXPECT_EQ(taken.values[id * kAtOnce + k], i < kEnd ? 0.5f + float(i) : 0.0f) << i;
      }
    }
    EXPECT_EQ(taken.state[1], 0);
  });
}

// Of the step before: the wait is given up, and the other groups are told.
TEST(Tagged, AnotherTagIsNeverTaken) {
  test::on_every_device([](ocl::DeviceContext& device) {
    std::vector<uint64_t> words = words_from(0.5f);
    words[9] = word(9.5f, kTag - 1);
    const Taken taken = take(device, words, kItems * kAtOnce);
    for (int id = 0; id < kItems; ++id) EXPECT_EQ(taken.had[id], id == 1 ? 0 : 1) << id;
    EXPECT_EQ(taken.state[1], 1);
  });
}

// Group by group through the device; where groups cannot wait for each other every one says so.
TEST(Tagged, GroupsHandThemOn) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const int n = int(ocl::GroupsTogether(device, 8).n());
    TaggedKernel kernel(device, "pass_on");
    std::vector<uint64_t> words(n + 1, 0);
    words[0] = word(10, kTag);
    ocl::Buffer<uint64_t> given(device, words);
    ocl::Buffer<int32_t> state(device, std::vector<int32_t>{0, 0}), had(device, n);
    kernel.launch(size_t(n) * 32, 32, given, kTag, state, had);
    const std::vector<uint64_t> found = given.read_all();
    const std::vector<int32_t> all_had = had.read_all(), told = state.read_all();
    const bool has_fence = told[0] == 1;
    if (n == 1 || has_fence) {
      for (int i = 0; i < n; ++i) EXPECT_EQ(all_had[i], 1) << i;
      for (int i = 0; i <= n; ++i) EXPECT_EQ(found[i], word(10 + float(i), kTag)) << i;
    } else {
      for (int i = 0; i < n; ++i) EXPECT_EQ(all_had[i], 0) << i;
      for (int i = 1; i <= n; ++i) EXPECT_EQ(found[i], 0u) << i;
      EXPECT_EQ(told[1], 1);
    }
  });
}

}  // namespace
}  // namespace livecap

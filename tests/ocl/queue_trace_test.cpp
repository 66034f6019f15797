// Times of commands against the host's clock around them.
#include "ocl/queue_trace.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "base/text.h"
#include "base/trace.h"
#include "livecap/error.h"
#include "ocl/buffer.h"
#include "support/test_device.h"

namespace livecap {
namespace {

bool has_times(const ocl::DeviceContext& device) {
  cl_command_queue_properties properties = 0;
  EXPECT_EQ(clGetCommandQueueInfo(device.queue(), CL_QUEUE_PROPERTIES, sizeof(properties), &properties, nullptr),
            CL_SUCCESS);
  return (properties & CL_QUEUE_PROFILING_ENABLE) != 0;
}

TEST(QueueTrace, CommandsLieBetweenTheHostsTimesAroundThem) {
  const auto path = std::filesystem::temp_directory_path() / format("livecap_queue_trace_%d.json", int(::getpid()));
  for (const std::string& selector : test::device_selectors()) {
    const ocl::DeviceInfo info = ocl::select_device(selector);
    start_trace();
    std::optional<ocl::DeviceContext> device(std::in_place, info, "the queue");
    ASSERT_TRUE(has_times(*device));
    constexpr size_t kCount = 1 << 24;
    double begin = 0, end = 0;
    {
      ocl::Buffer<float> from(*device, kCount), to(*device, kCount);
      from.fill(1.0f);
      to.fill(2.0f);
      device->finish();
      begin = trace_clock_us();
      to.copy_from(from);
      device->finish();
      end = trace_clock_us();
    }
    device.reset();
    EXPECT_EQ(ocl::traced_queues, 0);
    add_trace_span("host", "around", begin, end);
    write_trace(path);

    nlohmann::json around, copy;
    int fills = 0;
    const auto json = nlohmann::json::parse(read_file(path));
    for (const auto& event : json.at("traceEvents")) {
      if (event.at("name") == "around") around = event;
      if (event.at("name") == "copy") copy = event;
      fills += event.at("name") == "fill";
    }
    EXPECT_EQ(fills, 2);
    ASSERT_FALSE(copy.is_null());
    // The two clocks are set to within what a small write takes.
    constexpr double kSlackUs = 200;
    EXPECT_GE(copy.at("ts"), double(around.at("ts")) - kSlackUs);
    EXPECT_LE(double(copy.at("ts")) + double(copy.at("dur")),
              double(around.at("ts")) + double(around.at("dur")) + kSlackUs);
    EXPECT_GT(copy.at("dur"), 0.0);
  }
  std::filesystem::remove(path);
}

TEST(QueueTrace, QueuesWithoutATraceHaveNoTimes) {
  stop_trace();
  ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
  EXPECT_FALSE(has_times(device));
  ocl::Buffer<float> buffer(device, 64);
  ocl::QueueSpan span(device.queue(), "fill");
  EXPECT_EQ(span.event(), nullptr);
  // Nor do they take part in one that begins later.
  start_trace();
  buffer.fill(1.0f);
  EXPECT_EQ(ocl::traced_queues, 0);
  stop_trace();
}

cl_uint references(cl_context context) {
  cl_uint count = 0;
  EXPECT_EQ(clGetContextInfo(context, CL_CONTEXT_REFERENCE_COUNT, sizeof(count), &count, nullptr), CL_SUCCESS);
  return count;
}

// Its buffer and its event hold the context.
TEST(QueueTrace, AQueueWithoutTimesIsRefusedAndLeavesNothingBehind) {
  stop_trace();
  ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
  ASSERT_FALSE(has_times(device));
  const cl_uint before = references(device.context());
  EXPECT_THROW(ocl::trace_queue(device.context(), device.queue(), "no times"), OclError);
  EXPECT_EQ(references(device.context()), before);
  EXPECT_EQ(ocl::traced_queues, 0);
}

TEST(QueueTrace, ACommandWithoutTimesDoesNotReleaseTheOnesBeforeItTwice) {
  const ocl::DeviceInfo info = ocl::select_device(test::device_selectors().front());
  stop_trace();
  ocl::DeviceContext untimed(info);
  start_trace();
  std::optional<ocl::DeviceContext> timed(std::in_place, info, "the queue");
  // A marker of each queue; kept, so that releasing one too often is seen and not a crash.
  std::vector<cl_event> events;
  for (const ocl::DeviceContext* of : {&*timed, &untimed}) {
    ocl::QueueSpan span(timed->queue(), "marker");
    ASSERT_NE(span.event(), nullptr);
    ASSERT_EQ(clEnqueueMarkerWithWaitList(of->queue(), 0, nullptr, span.event()), CL_SUCCESS);
    ASSERT_EQ(clFinish(of->queue()), CL_SUCCESS);
    for (int kept = 0; kept < 2; ++kept) ASSERT_EQ(clRetainEvent(*span.event()), CL_SUCCESS);
    events.push_back(*span.event());
  }
  timed.reset();
  for (cl_event event : events) {
    cl_uint count = 0;
    EXPECT_EQ(clGetEventInfo(event, CL_EVENT_REFERENCE_COUNT, sizeof(count), &count, nullptr), CL_SUCCESS);
    EXPECT_EQ(count, 2u);
    for (cl_uint kept = 0; kept < count; ++kept) clReleaseEvent(event);
  }
  EXPECT_EQ(ocl::traced_queues, 0);
  stop_trace();
}

}  // namespace
}  // namespace livecap

// The timeline's file as another JSON reader sees it.
#include "base/trace.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

std::filesystem::path scratch_file() {
  return std::filesystem::temp_directory_path() / format("livecap_trace_test_%d.json", int(::getpid()));
}

TEST(Trace, SpansOfAllThreadsAreInTheFile) {
  start_trace();
  const double begin = trace_clock_us();
  add_trace_span("device", "kernel", begin + 100, begin + 350.5);
  std::thread([&] {
    const TraceSpan span("solve", "pose", 7);
    const double until = trace_clock_us() + 2000;
    while (trace_clock_us() < until) {
    }
  }).join();
  const double after = trace_clock_us();
  write_trace(scratch_file());
  EXPECT_FALSE(tracing());

  const auto json = nlohmann::json::parse(read_file(scratch_file()));
  std::filesystem::remove(scratch_file());
  std::map<int, std::string> tracks;
  std::map<std::string, nlohmann::json> spans;
  for (const auto& event : json.at("traceEvents")) {
    if (event.at("ph") == "M") {
      EXPECT_EQ(event.at("name"), "thread_name");
      tracks[event.at("tid")] = event.at("args").at("name");
    } else {
      EXPECT_EQ(event.at("ph"), "X");
      spans[event.at("name")] = event;
    }
  }
  ASSERT_EQ(spans.size(), 2u);
  EXPECT_EQ(tracks.at(spans.at("kernel").at("tid")), "device");
  EXPECT_EQ(tracks.at(spans.at("pose").at("tid")), "solve");
  EXPECT_EQ(spans.at("pose").at("args").at("frame"), 7);
  EXPECT_FALSE(spans.at("kernel").contains("args"));
  EXPECT_NEAR(spans.at("kernel").at("dur"), 250.5, 1e-3);
  EXPECT_GE(spans.at("pose").at("dur"), 2000.0);
  const double started = double(spans.at("kernel").at("ts")) - 100;  // `begin` on the file's clock
  EXPECT_GE(started, 0.0);
  EXPECT_GE(spans.at("pose").at("ts"), started);
  EXPECT_LE(double(spans.at("pose").at("ts")) + double(spans.at("pose").at("dur")), started + after - begin);
}

TEST(Trace, NothingIsRecordedUnlessItIsAskedFor) {
  stop_trace();
  add_trace_span("device", "before", 0, 1);
  start_trace();
  stop_trace();
  add_trace_span("device", "after", 0, 1);
  write_trace(scratch_file());
  const auto json = nlohmann::json::parse(read_file(scratch_file()));
  std::filesystem::remove(scratch_file());
  EXPECT_TRUE(json.at("traceEvents").empty());
}

TEST(Trace, AFolderThatIsNotThereIsNamed) {
  start_trace();
  try {
    write_trace("/nowhere/trace.json");
    FAIL();
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/trace.json"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(tracing());
}

}  // namespace
}  // namespace livecap

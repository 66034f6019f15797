#include "base/trace.h"

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/text.h"

namespace livecap {
namespace {

struct Span {
  int track;
  std::string name;
  double begin_us, end_us;
  int64_t frame;
};

std::atomic<bool> recording{false};
std::mutex mutex;
std::map<std::string, int> tracks;  // to the number by which the file knows them
std::vector<Span> spans;
double start_us = 0;

}  // namespace

void start_trace() {
  std::lock_guard lock(mutex);
  tracks.clear();
  spans.clear();
  start_us = trace_clock_us();
  recording = true;
}

bool tracing() {
  return recording.load(std::memory_order_relaxed);
}

double trace_clock_us() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void add_trace_span(const std::string& track, const std::string& name, double begin_us, double end_us, int64_t frame) {
  if (!tracing()) return;
  std::lock_guard lock(mutex);
  const int number = tracks.emplace(track, static_cast<int>(tracks.size()) + 1).first->second;
  spans.push_back({number, name, begin_us - start_us, end_us - start_us, frame});
}

void stop_trace() {
  recording = false;
}

void write_trace(const std::filesystem::path& file) {
  using Json = nlohmann::ordered_json;
  stop_trace();
  std::lock_guard lock(mutex);
  Json events = Json::array();
  for (const auto& [name, number] : tracks)
    events.push_back({{"name", "thread_name"}, {"ph", "M"}, {"pid", 1}, {"tid", number}, {"args", {{"name", name}}}});
  for (const Span& span : spans) {
    Json event = {{"name", span.name}, {"ph", "X"},           {"pid", 1},
                  {"tid", span.track}, {"ts", span.begin_us}, {"dur", span.end_us - span.begin_us}};
    if (span.frame >= 0) event["args"] = {{"frame", span.frame}};
    events.push_back(std::move(event));
  }
  write_file_atomically(file, Json{{"displayTimeUnit", "ms"}, {"traceEvents", std::move(events)}}.dump() + "\n");
}

}  // namespace livecap

// A timeline of this process in the format that chrome://tracing and Perfetto read: spans of work on named tracks.
// Nothing is recorded, and next to nothing costs, until start_trace().
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace livecap {

// Forgets earlier spans and records from now on.
void start_trace();
bool tracing();

// Steady clock, microseconds.
double trace_clock_us();

// track: "network", "solver device", ... frame: of the input, -1 = none. Ignored unless tracing. Any thread.
void add_trace_span(const std::string& track, const std::string& name, double begin_us, double end_us,
                    int64_t frame = -1);

// Ends the recording.
void stop_trace();
// The same, and writes what was recorded. Throws IoError naming the file.
void write_trace(const std::filesystem::path& file);

// From here to the end of its life.
class TraceSpan {
 public:
  TraceSpan(const char* track, const char* name, int64_t frame)
      : track_(track), name_(name), frame_(frame), begin_us_(tracing() ? trace_clock_us() : 0) {}
  ~TraceSpan() {
    if (tracing()) add_trace_span(track_, name_, begin_us_, trace_clock_us(), frame_);
  }
  TraceSpan(const TraceSpan&) = delete;
  TraceSpan& operator=(const TraceSpan&) = delete;

 private:
  const char* track_;
  const char* name_;
  int64_t frame_;
  double begin_us_;
};

}  // namespace livecap

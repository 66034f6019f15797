// Captures whose times `livecap bench` reports.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "livecap/capture.h"
#include "synth/synth.h"

namespace livecap::tools {

struct BenchOptions {
  std::string sequence;  // empty: made
  std::string model = "full";
  std::string cnn_device;
  std::string solver_device;
  int frames = 90;
  bool json = false;
  bool growth = false;
  bool decoded = false;
  std::string trace;
};

struct BenchRun {
  CaptureReport report;
  nlohmann::ordered_json file;       // report.json
  std::vector<double> intervals_ms;  // between tracked frames that follow each other
};

// The built-in sequence, or one like it. Throws Error when interrupted.
void make_bench_sequence(const SynthOptions& synth, const std::filesystem::path& folder);

// What a capture of the sequence is asked for.
CaptureOptions bench_capture_options(const BenchOptions& options, const std::filesystem::path& sequence,
                                     const std::filesystem::path& out);

// name: what the progress says. Throws Error when interrupted or when nobody is tracked in two frames on end.
BenchRun bench_capture(const CaptureOptions& capture, const std::string& name);

nlohmann::ordered_json stages_json(const CaptureReport& report);
nlohmann::ordered_json run_json(const BenchRun& run);

}  // namespace livecap::tools

#include "bench_growth.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "actor/actor.h"
#include "base/power_law.h"
#include "base/text.h"

namespace livecap::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kFrames = 30;
constexpr int kRounds = 2;  // in turns; the lower median counts, other work only adds
constexpr int kVertices[] = {1000, 5000, 20000, 50000};
struct Size {
  int width, height;
};
constexpr Size kSizes[] = {{270, 480}, {406, 720}, {540, 960}, {810, 1440}, {1080, 1920}};

// The exponent of every stage over the rows' `field`.
Json exponents(const Json& rows, const char* field) {
  std::vector<double> x;
  for (const Json& row : rows) x.push_back(row[field]);
  Json result;
  for (const auto& [stage, unused] : rows[0]["stage_median_ms"].items()) {
    std::vector<double> y;
    for (const Json& row : rows) y.push_back(row["stage_median_ms"][stage]);
    result[stage] = power_law_exponent(x, y);
  }
  return result;
}

struct Case {
  fs::path sequence, actor;
  std::string name;
};

// Captures the case. row: each stage's median, or the lower one when there is one already.
void measure(const BenchOptions& options, const Case& what, const fs::path& scratch, Json& row) {
  CaptureOptions capture = bench_capture_options(options, what.sequence, scratch / "growth");
  capture.actor = what.actor.string();
  capture.sequential = true;
  const BenchRun run = bench_capture(capture, what.name);
  row["tracked"] = run.report.tracked;
  Json& lowest = row["stage_median_ms"];
  const Json stages = stages_json(run.report);
  for (const auto& [stage, ms] : stages.items())
    lowest[stage] = lowest.contains(stage) ? std::min(lowest[stage].get<double>(), ms.get<double>()) : ms.get<double>();
}

}  // namespace

Json measure_growth(const BenchOptions& options, const fs::path& scratch) {
  Json growth;
  std::vector<Case> pictures, actors;
  for (const Size& size : kSizes) {
    const fs::path sequence = scratch / format("%dx%d", size.width, size.height);
    SynthOptions synth;
    synth.n_frames = kFrames;
    synth.empty_frames = 0;
    synth.width = size.width;
    synth.height = size.height;
    make_bench_sequence(synth, sequence);
    growth["pictures"].push_back(
        {{"width", size.width}, {"height", size.height}, {"pixels", size.width * size.height}});
    pictures.push_back({sequence, sequence / "actor.glb", format("%d x %d", size.width, size.height)});
  }
  for (int wanted : kVertices) {
    const fs::path file = scratch / format("%d.glb", wanted);
    write_file_atomically(file, make_builtin_actor_glb(SynthOptions{}.actor, kBuiltinHeightMm, wanted));
    const int n = load_actor(file).n_vertices();
    growth["actors"].push_back({{"vertices", n}});
    actors.push_back({scratch / "540x960", file, format("%d vertices", n)});
  }
  for (int round = 0; round < kRounds; ++round) {
    for (size_t i = 0; i < pictures.size(); ++i) measure(options, pictures[i], scratch, growth["pictures"][i]);
    for (size_t i = 0; i < actors.size(); ++i) measure(options, actors[i], scratch, growth["actors"][i]);
  }
  growth["exponents"] = {{"pixels", exponents(growth["pictures"], "pixels")},
                         {"vertices", exponents(growth["actors"], "vertices")}};
  return growth;
}

void print_growth(const Json& growth) {
  const auto print = [](const std::string& name, const Json& values, const char* pattern) {
    std::printf("  %-16s", name.c_str());
    for (const auto& [stage, value] : values.items())
      std::printf(pattern, stage.c_str(), value.is_null() ? NAN : value.get<double>());
    std::printf("\n");
  };
  std::printf(
      "growth     medians of the stages in one thread, the lower of two runs, ms; then the power with which each "
      "grows\n");
  for (const Json& row : growth["pictures"])
    print(format("%d x %d", row["width"].get<int>(), row["height"].get<int>()), row["stage_median_ms"], " %s %.2f");
  print("~ pixels^", growth["exponents"]["pixels"], " %s %.2f");
  for (const Json& row : growth["actors"])
    print(format("%d vertices", row["vertices"].get<int>()), row["stage_median_ms"], " %s %.2f");
  print("~ vertices^", growth["exponents"]["vertices"], " %s %.2f");
}

}  // namespace livecap::tools

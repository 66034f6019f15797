#include "bench_growth.h"

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

}  // namespace

Json measure_growth(const BenchOptions& options, const fs::path& scratch) {
  Json growth;
  const auto measure = [&](const fs::path& sequence, const fs::path& actor, const std::string& name) {
    CaptureOptions capture = bench_capture_options(options, sequence, scratch / "growth");
    capture.actor = actor.string();
    capture.sequential = true;
    return bench_capture(capture, name);
  };
  for (const Size& size : kSizes) {
    const fs::path sequence = scratch / format("%dx%d", size.width, size.height);
    SynthOptions synth;
    synth.n_frames = kFrames;
    synth.empty_frames = 0;
    synth.width = size.width;
    synth.height = size.height;
    make_bench_sequence(synth, sequence);
    const BenchRun run = measure(sequence, sequence / "actor.glb", format("%d x %d", size.width, size.height));
    growth["pictures"].push_back({{"width", size.width},
                                  {"height", size.height},
                                  {"pixels", size.width * size.height},
                                  {"tracked", run.report.tracked},
                                  {"stage_median_ms", stages_json(run.report)}});
  }
  const fs::path sequence = scratch / "540x960";
  for (int wanted : kVertices) {
    const fs::path file = scratch / format("%d.glb", wanted);
    write_file_atomically(file, make_builtin_actor_glb(SynthOptions{}.actor, kBuiltinHeightMm, wanted));
    const int n = load_actor(file).n_vertices();
    const BenchRun run = measure(sequence, file, format("%d vertices", n));
    growth["actors"].push_back(
        {{"vertices", n}, {"tracked", run.report.tracked}, {"stage_median_ms", stages_json(run.report)}});
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
  std::printf("growth     medians of the stages in one thread, ms; then the power with which each grows\n");
  for (const Json& row : growth["pictures"])
    print(format("%d x %d", row["width"].get<int>(), row["height"].get<int>()), row["stage_median_ms"], " %s %.2f");
  print("~ pixels^", growth["exponents"]["pixels"], " %s %.2f");
  for (const Json& row : growth["actors"])
    print(format("%d vertices", row["vertices"].get<int>()), row["stage_median_ms"], " %s %.2f");
  print("~ vertices^", growth["exponents"]["vertices"], " %s %.2f");
}

}  // namespace livecap::tools

// livecap bench: how fast this machine captures. The same short sequence is captured pipelined and sequentially,
// without overlay; beside it, in the same run, what widely used libraries take for work of the same kind and size.
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "actor/actor.h"
#include "base/json_text.h"
#include "base/require_apart.h"
#include "base/require_writable.h"
#include "base/scratch_folder.h"
#include "base/text.h"
#include "base/timer.h"
#include "bench_capture.h"
#include "bench_growth.h"
#include "bench_peers.h"
#include "bench_roofline.h"
#include "command.h"
#include "livecap/camera.h"
#include "livecap/capture.h"
#include "livecap/error.h"
#include "method_options.h"
#include "ocl/device.h"
#include "progress.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kTracedFrames = 30;

// "model name" of /proc/cpuinfo, or the machine's architecture.
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos)
      return line.substr(line.find(": ") + 2);
  }
  utsname name{};
  ::uname(&name);
  return name.machine;
}

Json machine_json() {
  utsname name{};
  ::uname(&name);
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  char date[32];
  std::strftime(date, sizeof(date), "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  double load[3] = {-1, -1, -1};
  ::getloadavg(load, 3);
  Json json;
  json["program"] = "livecap " LIVECAP_VERSION;
  json["date"] = date;
  json["processor"] = processor_name();
  json["processors_online"] = std::thread::hardware_concurrency();
  json["system"] = std::string(name.sysname) + " " + name.release;
  json["load_average_at_start"] = load[0];
  return json;
}

void print_run(const char* name, const Json& run) {
  std::printf("%-10s %7.1f ms a frame (95 %%: %.1f), %.1f fps, latency %.0f ms\n", name,
              run["frame_median_ms"].get<double>(), run["frame_p95_ms"].get<double>(), run["fps"].get<double>(),
              run["latency_median_ms"].get<double>());
  std::printf("  stages  ");
  for (const auto& [stage, ms] : run["stage_median_ms"].items())
    std::printf(" %s %.1f", stage.c_str(), ms.get<double>());
  std::printf(" ms\n");
}

void print_report(const Json& json) {
  std::printf("machine    %s, %u processors, load %.2f, %s\n", json["processor"].get<std::string>().c_str(),
              json["processors_online"].get<unsigned>(), json["load_average_at_start"].get<double>(),
              json["date"].get<std::string>().c_str());
  for (const auto& [role, device] : json["devices"].items())
    std::printf("%-10s %s [%s]\n", role.c_str(), device["device"].get<std::string>().c_str(),
                device["platform_version"].get<std::string>().c_str());
  std::printf("model      %s, %dx%d px, %d vertices\n", json["model"].get<std::string>().c_str(),
              json["sequence"]["width"].get<int>(), json["sequence"]["height"].get<int>(),
              json["sequence"]["vertices"].get<int>());
  std::printf("input      %s\n", json["sequence"]["decoded"].get<bool>()
                                     ? "decoded before the clock starts: decoding is not in these times"
                                     : "decoded while it is captured");
  print_run("pipelined", json["pipelined"]);
  print_run("sequential", json["sequential"]);
  std::printf("memory     %.0f MiB resident, %.0f MiB of it or beside it in device buffers\n",
              json["memory_mib"]["peak_resident"].get<double>(),
              json["memory_mib"]["peak_device_buffers"].get<double>());
  std::printf("allocated  %lld device buffers while frames were processed\n",
              json["device_allocations_while_running"].get<long long>());
  for (const auto& [role, roofline] : json["roofline"].items())
    std::printf("roofline   %s: copies %.1f GB/s, multiplies matrices at %.0f GFLOP/s\n", role.c_str(),
                roofline["copy_gb_per_s"].get<double>(), roofline["gemm_gflop_per_s"].get<double>());
  const Json& network = json["network_arithmetic"];
  std::printf("           the network stage: %.2f GFLOP a frame at %.0f GFLOP/s, %.2f of that rate\n",
              network["gflop_per_frame"].get<double>(), network["gflop_per_s"].get<double>(),
              network["share_of_gemm_rate"].get<double>());
  std::printf("vertices   of both runs are %s\n", json["runs_are_identical"].get<bool>() ? "identical" : "DIFFERENT");
  std::printf("beside it ");
  for (const auto& [peer, ms] : json["peers_ms"].items()) std::printf(" %s %.1f", peer.c_str(), ms.get<double>());
  std::printf(" ms\n");
  for (const auto& [ratio, value] : json["ratios"].items())
    std::printf("  ratio    %s %.2f\n", ratio.c_str(), value.get<double>());
}

// A run of its own, since profiled queues are slower.
CaptureOptions traced_capture(const BenchOptions& options, const fs::path& sequence, const fs::path& out) {
  CaptureOptions capture = bench_capture_options(options, sequence, out);
  capture.frames = std::min(options.frames, kTracedFrames);
  capture.trace = options.trace;
  return capture;
}

int run(const BenchOptions& options) {
  catch_interrupt();
  Json json = machine_json();
  const ScratchFolder scratch;
  const fs::path sequence = options.sequence.empty() ? scratch / "sequence" : fs::path(options.sequence);
  const CaptureOptions traced = traced_capture(options, sequence, scratch / "trace");
  traced.validate();
  if (!options.trace.empty()) require_writable(options.trace);
  require_apart({{"--video", traced.video},
                 {"--camera", traced.camera},
                 {"--background", traced.background},
                 {"--actor", traced.actor}},
                {options.trace}, "--trace");
  ocl::select_device_pair(options.cnn_device, options.solver_device);  // complain before a sequence is made
  if (options.sequence.empty()) {
    SynthOptions synth;
    synth.n_frames = options.frames;
    synth.empty_frames = 0;
    make_bench_sequence(synth, sequence);
  }
  const BenchRun pipelined =
      bench_capture(bench_capture_options(options, sequence, scratch / "pipelined"), "pipelined");
  CaptureOptions one_thread = bench_capture_options(options, sequence, scratch / "sequential");
  one_thread.sequential = true;
  const BenchRun sequential = bench_capture(one_thread, "sequential");
  if (!options.trace.empty()) bench_capture(traced, "trace");

  const Actor actor = load_actor(sequence / "actor.glb");
  const Camera camera = load_camera(sequence / "camera.json");
  json["devices"] = pipelined.file["devices"];
  json["model"] = options.model;
  json["network"] = pipelined.file["network"];
  json["sequence"] = {{"source", options.sequence.empty() ? "built-in demo" : options.sequence},
                      {"width", camera.width},
                      {"height", camera.height},
                      {"vertices", actor.n_vertices()},
                      {"decoded", options.decoded}};
  json["pipelined"] = run_json(pipelined);
  json["sequential"] = run_json(sequential);
  json["memory_mib"] = pipelined.file["memory_mib"];
  json["device_allocations_while_running"] = pipelined.report.device_allocations;
  json["runs_are_identical"] = read_file(pipelined.report.pc2) == read_file(sequential.report.pc2);

  const PeerTimes peers = time_peers(actor, camera.width, camera.height);
  json["peers_ms"] = {{"opencv_distance_transform", peers.distance_transform_ms},
                      {"opencv_gaussian_blur_15_9_3", peers.gaussian_blur_ms},
                      {"eigen_cg_12_iterations", peers.conjugate_gradient_ms}};
  const Json stages = json["sequential"]["stage_median_ms"];
  json["ratios"] = {
      {"segment / opencv_distance_transform", stages["segment"].get<double>() / peers.distance_transform_ms},
      {"surface / (opencv_gaussian_blur_15_9_3 + eigen_cg_12_iterations)",
       stages["surface"].get<double>() / (peers.gaussian_blur_ms + peers.conjugate_gradient_ms)}};
  const Roofline network_roofline = measure_roofline(options.cnn_device, options.solver_device, true);
  json["roofline"] = {{"network", roofline_json(network_roofline)},
                      {"solver", roofline_json(measure_roofline(options.cnn_device, options.solver_device, false))}};
  json["network_arithmetic"] = network_share_json(options.model, stages["network"], network_roofline);
  if (options.growth) json["growth"] = measure_growth(options, scratch.path());
  if (options.json) {
    std::printf("%s\n", json_text(json, 2).c_str());
  } else {
    print_report(json);
    if (options.growth) print_growth(json["growth"]);
  }
  return kExitOk;
}

}  // namespace

void add_bench_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand("bench", "measure how fast this machine captures");
  command->add_flag("--json", options->json, "print the result as JSON");
  command->add_option("--frames", options->frames, "capture at most this many")
      ->check(between({3, 100000}))
      ->capture_default_str();
  command->add_flag("--decoded", options->decoded,
                    "decode all frames before the clock starts: what is measured begins with decoded frames, which "
                    "stay in memory (3 bytes a pixel and frame)");
  add_model_option(*command, options->model);
  command->add_option("--sequence", options->sequence,
                      "folder with video.mp4, camera.json, background.png, actor.glb instead of the built-in sequence");
  command->add_flag("--growth", options->growth, "also measure how the times grow with vertices and pixels");
  command->add_option("--trace", options->trace,
                      "also write a timeline of threads and devices (30 frames), for chrome://tracing or Perfetto");
  add_device_options(*command, options->cnn_device, options->solver_device);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools

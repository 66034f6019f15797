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
#include "base/text.h"
#include "base/timer.h"
#include "bench_peers.h"
#include "command.h"
#include "livecap/camera.h"
#include "livecap/capture.h"
#include "livecap/error.h"
#include "progress.h"
#include "synth/synth.h"

namespace livecap::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Options {
  std::string sequence;  // empty: made
  std::string model = "full";
  std::string cnn_device;
  std::string solver_device;
  int frames = 90;
  bool json = false;
};

// A folder below the system's temporary one that goes away with its owner.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "livecap-bench-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw IoError(pattern + ": cannot be made");
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct Run {
  CaptureReport report;
  Json file;                         // report.json
  std::vector<double> intervals_ms;  // between tracked frames that follow each other
};

Run capture_once(const Options& options, const fs::path& sequence, const fs::path& out, bool sequential) {
  CaptureOptions capture;
  capture.video = (sequence / "video.mp4").string();
  capture.camera = (sequence / "camera.json").string();
  capture.background = (sequence / "background.png").string();
  capture.actor = (sequence / "actor.glb").string();
  capture.model = options.model;
  capture.cnn_device = options.cnn_device;
  capture.solver_device = options.solver_device;
  capture.frames = options.frames;
  capture.sequential = sequential;
  capture.out = out.string();

  Run run;
  Progress progress(sequential ? "sequential" : "pipelined");
  int64_t done = 0;
  bool after_tracked = false;
  Timer since_last;
  run.report = run_capture(capture, [&](const FrameReport& frame, int64_t n_frames) {
    const bool tracked = is_tracked(frame.status);
    if (tracked && after_tracked) run.intervals_ms.push_back(since_last.elapsed_ms());
    since_last.restart();
    after_tracked = tracked;
    progress.update(++done, n_frames);
    return !interrupted();
  });
  progress.finish();
  if (interrupted()) throw Error("interrupted");
  if (run.intervals_ms.empty()) throw Error(capture.video + ": nobody was tracked, there is nothing to measure");
  run.file = Json::parse(read_file(out / "report.json"));
  return run;
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

Json run_json(const Run& run) {
  Json json;
  json["frames"] = run.report.frames;
  json["tracked"] = run.report.tracked;
  json["frame_median_ms"] = median(run.intervals_ms);
  json["frame_p95_ms"] = percentile(run.intervals_ms, 0.95);
  json["fps"] = 1000 / median(run.intervals_ms);
  json["latency_median_ms"] = run.report.latency_ms;
  for (int i = 0; i < kStageCount; ++i)
    json["stage_median_ms"][stage_name(static_cast<CaptureStage>(i))] = run.report.stage_median_ms[i];
  return json;
}

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
  print_run("pipelined", json["pipelined"]);
  print_run("sequential", json["sequential"]);
  std::printf("memory     %.0f MiB resident, %.0f MiB of it or beside it in device buffers\n",
              json["memory_mib"]["peak_resident"].get<double>(),
              json["memory_mib"]["peak_device_buffers"].get<double>());
  std::printf("vertices   of both runs are %s\n", json["runs_are_identical"].get<bool>() ? "identical" : "DIFFERENT");
  std::printf("beside it ");
  for (const auto& [peer, ms] : json["peers_ms"].items()) std::printf(" %s %.1f", peer.c_str(), ms.get<double>());
  std::printf(" ms\n");
  for (const auto& [ratio, value] : json["ratios"].items())
    std::printf("  ratio    %s %.2f\n", ratio.c_str(), value.get<double>());
}

int run(const Options& options) {
  catch_interrupt();
  Json json = machine_json();
  const ScratchFolder scratch;
  fs::path sequence = options.sequence;
  if (sequence.empty()) {
    sequence = scratch.path() / "sequence";
    SynthOptions synth;
    synth.n_frames = options.frames;
    synth.empty_frames = 0;
    Progress progress("synth");
    write_sequence(synth, sequence, [&](int frame, int n_frames) {
      progress.update(frame, n_frames);
      return !interrupted();
    });
    progress.finish();
    if (interrupted()) throw Error("interrupted");
  }
  const Run pipelined = capture_once(options, sequence, scratch.path() / "pipelined", false);
  const Run sequential = capture_once(options, sequence, scratch.path() / "sequential", true);

  const Actor actor = load_actor(sequence / "actor.glb");
  const Camera camera = load_camera(sequence / "camera.json");
  json["devices"] = pipelined.file["devices"];
  json["model"] = options.model;
  json["network"] = pipelined.file["network"];
  json["sequence"] = {{"source", options.sequence.empty() ? "built-in demo" : options.sequence},
                      {"width", camera.width},
                      {"height", camera.height},
                      {"vertices", actor.n_vertices()}};
  json["pipelined"] = run_json(pipelined);
  json["sequential"] = run_json(sequential);
  json["memory_mib"] = pipelined.file["memory_mib"];
  json["runs_are_identical"] = read_file(pipelined.report.pc2) == read_file(sequential.report.pc2);

  const PeerTimes peers = time_peers(actor, camera.width, camera.height);
  json["peers_ms"] = {{"opencv_distance_transform", peers.distance_transform_ms},
                      {"opencv_gaussian_blur_15_9_3", peers.gaussian_blur_ms},
                      {"eigen_cg_12_iterations", peers.conjugate_gradient_ms}};
  const auto& stages = json["sequential"]["stage_median_ms"];
  json["ratios"] = {
      {"segment / opencv_distance_transform", stages["segment"].get<double>() / peers.distance_transform_ms},
      {"surface / (opencv_gaussian_blur_15_9_3 + eigen_cg_12_iterations)",
       stages["surface"].get<double>() / (peers.gaussian_blur_ms + peers.conjugate_gradient_ms)}};
  if (options.json) {
    std::printf("%s\n", json.dump(2).c_str());
  } else {
    print_report(json);
  }
  return kExitOk;
}

}  // namespace

void add_bench_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("bench", "measure how fast this machine captures");
  command->add_flag("--json", options->json, "print the result as JSON");
  command->add_option("--frames", options->frames, "capture at most this many")
      ->check(CLI::Range(3, 100000))
      ->capture_default_str();
  command->add_option("--model", options->model, "lite, full, heavy or a .tflite file")->capture_default_str();
  command->add_option("--sequence", options->sequence,
                      "folder with video.mp4, camera.json, background.png, actor.glb instead of the built-in sequence");
  command->add_option("--cnn-device", options->cnn_device, "device of the network, see `livecap devices`");
  command->add_option("--solver-device", options->solver_device, "device of the solvers");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools

// How the 1x1 convolutions of the pose network (kernels/nn/conv2d.cl) compare with a tuned BLAS: each of the network's
// layers against CLBlast's SGEMM of the same product on the same device, in turns. Ours adds the bias and clamps as
// well; CLBlast does the product alone. Only this file uses CLBlast.
//
//   bench_pointwise [--device=SELECTOR] [--model=lite|full|heavy|FILE] [Google Benchmark's options]
//
// Time is ours; the counter `ours/CLBlast` is below 1 where ours is faster. The last row is all layers together.
#include <benchmark/benchmark.h>
#include <clblast.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <tuple>

#include "base/text.h"
#include "base/timer.h"
#include "detect/find_model.h"
#include "nn/executor.h"
#include "nn/tflite_import.h"
#include "ocl/context.h"
#include "race.h"

namespace livecap {
namespace {

// pixels x in times in x out.
struct Layer {
  int height, width, in, out;
  auto operator<=>(const Layer&) const = default;
  std::string name() const { return format("%dx%d, %d to %d channels", width, height, in, out); }
};

// The network's 1x1 layers of stride 1 and how often each occurs.
std::map<Layer, int> pointwise_layers(const nn::Graph& graph) {
  std::map<Layer, int> layers;
  for (const nn::Op& op : graph.ops) {
    const auto* conv = std::get_if<nn::Conv2d>(&op.attributes);
    if (!conv || conv->window.stride_h != 1 || conv->window.stride_w != 1) continue;
    const nn::Shape& weights = graph.tensors[op.inputs[1]].shape;
    const nn::Shape& out = graph.tensors[op.output].shape;
    if (weights[1] == 1 && weights[2] == 1) ++layers[{out[1], out[2], weights[3], weights[0]}];
  }
  return layers;
}

std::vector<float> noise(size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> values(n);
  for (float& v : values) v = uniform(random);
  return values;
}

nn::Graph graph_of(const Layer& layer, const std::vector<float>& weights) {
  nn::Graph graph;
  graph.name = layer.name();
  graph.tensors = {{"x", {1, layer.height, layer.width, layer.in}, false, {}},
                   {"w", {layer.out, 1, 1, layer.in}, true, weights},
                   {"b", {layer.out}, true, std::vector<float>(layer.out, 0.0f)},
                   {"y", {1, layer.height, layer.width, layer.out}, false, {}}};
  graph.ops = {{nn::Conv2d{}, {0, 1, 2}, 3, nn::Activation::kNone, -1}};
  graph.inputs = {0};
  graph.outputs = {3};
  return graph;
}

class Contest {
 public:
  Contest(ocl::DeviceContext& device, const Layer& layer)
      : device_(device),
        layer_(layer),
        pixels_(size_t(layer.height) * layer.width),
        weights_host_(noise(size_t(layer.in) * layer.out, 1)),
        ours_(device, graph_of(layer, weights_host_), {0}),
        product_(device, pixels_ * layer.out) {
    const std::vector<float> x = noise(pixels_ * layer.in, 2);
    ours_.set_input(x);
    x_ = {device, x};
    weights_ = {device, weights_host_};
    run_ours();
    run_peer();  // compiles
    std::vector<float> mine(pixels_ * layer.out);
    ours_.read_output(0, mine);
    const std::vector<float> other = product_.read_all();
    for (size_t i = 0; i < mine.size(); ++i) {
      if (!(std::abs(mine[i] - other[i]) < 1e-4f * static_cast<float>(layer.in)))
        throw std::runtime_error(layer.name() + ": the two products differ");
    }
  }

  double run_ours() {
    return timed([&] { ours_.run(); });
  }

  // [pixels, in] times the transpose of [out, in].
  double run_peer() {
    return timed([&] {
      cl_command_queue queue = device_.queue();
      const auto status =
          clblast::Gemm<float>(clblast::Layout::kRowMajor, clblast::Transpose::kNo, clblast::Transpose::kYes, pixels_,
                               layer_.out, layer_.in, 1.0f, x_.memory(), 0, layer_.in, weights_.memory(), 0, layer_.in,
                               0.0f, product_.memory(), 0, layer_.out, &queue);
      if (status != clblast::StatusCode::kSuccess)
        throw std::runtime_error(format("CLBlast: status %d", static_cast<int>(status)));
    });
  }

 private:
  template <typename Work>
  double timed(Work&& work) {
    const Timer timer;
    work();
    device_.finish();
    return timer.elapsed_ms() * 1e-3;
  }

  ocl::DeviceContext& device_;
  Layer layer_;
  size_t pixels_;
  std::vector<float> weights_host_;
  nn::Executor ours_;
  ocl::Buffer<float> x_, weights_, product_;
};

void race(benchmark::State& state, ocl::DeviceContext& device, const std::map<Layer, int>& layers) {
  std::vector<std::pair<std::unique_ptr<Contest>, int>> contests;
  for (const auto& [layer, count] : layers) contests.emplace_back(std::make_unique<Contest>(device, layer), count);
  double ours = 0, peer = 0;
  for (auto _ : state) {
    double once = 0;
    for (auto& [contest, count] : contests) {
      once += count * contest->run_ours();
      peer += count * contest->run_peer();
    }
    ours += once;
    state.SetIterationTime(once);
  }
  state.counters["ours/CLBlast"] = ours / peer;
}

int run(int argc, char** argv) {
  const std::string selector = bench::take_option(argc, argv, "device", "pocl");
  const std::string model = bench::take_option(argc, argv, "model", "full");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  ocl::DeviceContext device(ocl::select_device(selector));
  const std::map<Layer, int> layers = pointwise_layers(nn::load_tflite(detect::find_model(model)));
  std::printf("%s\n", device.info().device_name.c_str());
  for (const auto& [layer, count] : layers) {
    benchmark::RegisterBenchmark((layer.name() + format(" (%d times)", count)).c_str(),
                                 [&device, layer = layer](benchmark::State& state) {
                                   race(state, device, {{layer, 1}});
                                 })
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
  }
  benchmark::RegisterBenchmark("all", [&](benchmark::State& state) { race(state, device, layers); })
      ->UseManualTime()
      ->Unit(benchmark::kMicrosecond);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace livecap

int main(int argc, char** argv) {
  try {
    return livecap::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_pointwise: %s\n", error.what());
    return 1;
  }
}

#include "bench_roofline.h"

#include <vector>

#include "base/timer.h"
#include "detect/find_model.h"
#include "nn/executor.h"
#include "nn/tflite_import.h"
#include "ocl/buffer.h"
#include "ocl/context.h"

namespace livecap::tools {
namespace {

constexpr int kRepeats = 9;
constexpr int kSide = 64, kChannels = 512;         // 4096 pixels
constexpr size_t kCopied = 64 * 1024 * 1024;       // floats of a GPU's copy
constexpr size_t kCopiedOnCpu = 16 * 1024 * 1024;  // floats, more than any cache a core has to itself

// Median of the time in which the device does it, seconds. The first one warms up.
template <typename Work>
double median_s(ocl::DeviceContext& device, Work&& work) {
  work();
  device.finish();
  std::vector<double> times;
  for (int i = 0; i < kRepeats; ++i) {
    const Timer timer;
    work();
    device.finish();
    times.push_back(timer.elapsed_ms() * 1e-3);
  }
  return median(times);
}

nn::Graph product_graph() {
  nn::Graph graph;
  graph.name = "matrix product";
  graph.tensors = {{"x", {1, kSide, kSide, kChannels}, false, {}},
                   {"w", {kChannels, 1, 1, kChannels}, true, std::vector<float>(size_t(kChannels) * kChannels, 0.5f)},
                   {"b", {kChannels}, true, std::vector<float>(kChannels, 0.0f)},
                   {"y", {1, kSide, kSide, kChannels}, false, {}}};
  graph.ops = {{nn::Conv2d{}, {0, 1, 2}, 3, nn::Activation::kNone, -1}};
  graph.inputs = {0};
  graph.outputs = {3};
  return graph;
}

}  // namespace

Roofline measure_roofline(const std::string& cnn_device, const std::string& solver_device, bool network) {
  const ocl::DevicePair pair = ocl::select_device_pair(cnn_device, solver_device);
  ocl::DeviceContext device(network ? pair.cnn : pair.solver);
  Roofline roofline;
  {
    const size_t count = device.is_cpu() ? kCopiedOnCpu : kCopied;
    ocl::Buffer<float> from(device, count), to(device, count);
    from.fill(1.0f);
    to.fill(2.0f);
    const double seconds = median_s(device, [&] { to.copy_from(from); });
    roofline.copy_gb_per_s = 2e-9 * double(count * sizeof(float)) / seconds;
  }
  nn::Executor product(device, product_graph(), {0});
  product.set_input(std::vector<float>(size_t(kSide) * kSide * kChannels, 0.25f));
  const double seconds = median_s(device, [&] { product.run(); });
  roofline.gemm_gflop_per_s = 2e-9 * kSide * kSide * double(kChannels) * kChannels / seconds;
  return roofline;
}

nlohmann::ordered_json roofline_json(const Roofline& roofline) {
  return {{"copy_gb_per_s", roofline.copy_gb_per_s}, {"gemm_gflop_per_s", roofline.gemm_gflop_per_s}};
}

nlohmann::ordered_json network_share_json(const std::string& model, double network_ms, const Roofline& roofline) {
  const double gflop = 2e-9 * double(nn::multiply_add_count(nn::load_tflite(detect::find_model(model))));
  const double rate = gflop / (network_ms * 1e-3);
  return {{"gflop_per_frame", gflop}, {"gflop_per_s", rate}, {"share_of_gemm_rate", rate / roofline.gemm_gflop_per_s}};
}

}  // namespace livecap::tools

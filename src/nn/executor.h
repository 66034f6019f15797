// Runs a graph on one device: constants packed and uploaded once, activations in one arena. CPUs launch each operator;
// GPUs launch runs of layers at once (kernels/nn/layers.cl).
//   Executor net(device, graph, {0, 2});
//   net.set_input(pixels);
//   net.run();
//   net.read_output(0, landmarks);
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "nn/graph.h"
#include "nn/op_params.h"
#include "ocl/buffer.h"
#include "ocl/groups_together.h"
#include "ocl/kernel.h"

namespace livecap::nn {

class Executor {
 public:
  // requested: positions in graph.outputs; what only other outputs need is not computed. `fused` false keeps one step
  // per operator. Throws IoError when the graph needs more memory than the device gives, LogicError for a wrong
  // request.
  Executor(ocl::DeviceContext& device, const Graph& graph, const std::vector<int>& requested, bool fused = true);

  // [1,H,W,C] values of the graph's only input. Blocking. Throws LogicError when the size differs.
  void set_input(std::span<const float> values);
  // The same from bytes: value = offset + scale * byte.
  void set_input_u8(std::span<const uint8_t> bytes, float scale, float offset);

  // Enqueues all steps; nothing waits until an output is read.
  void run();

  // i: position in `requested`. Blocking. Throws LogicError when the size differs.
  void read_output(size_t i, std::span<float> values);
  const Shape& output_shape(size_t i) const { return graph_.tensors[graph_.outputs.at(i)].shape; }
  const Shape& input_shape() const { return graph_.tensors[graph_.inputs.front()].shape; }

  // For kernels that write the input or look at outputs on the device: all values, and where each begins.
  ocl::Buffer<float>& arena() { return arena_; }
  int input_at() const { return static_cast<int>(offsets_[graph_.inputs.front()]); }
  int output_at(size_t i) const { return static_cast<int>(offsets_[graph_.outputs.at(i)]); }
  // After a blocking read behind run(): true once when the device did not do all of the run, which is then to be
  // enqueued again. read_output does so itself.
  bool gave_up() { return groups_.gave_up(graph_.name); }

  size_t step_count() const { return steps_.size(); }
  // Whether layers are launched together. No longer after a launch in which work-groups did not run at once.
  bool together() const { return groups_.work(); }

 private:
  struct Step {
    size_t kernel = 0;  // index into kernels_
    NnOp op{};
    size_t local = 1;
    bool has_weights = false;
    int layer = -1;  // index into layers_, or a kernel of its own
  };

  size_t kernel(const char* name, const char* file = "nn/nn.cl");
  void add_step(const Op& op, const std::vector<int64_t>& offsets, std::vector<float>& weights);
  void add_layer(Step& step, int kind);
  size_t launch_layers(size_t first);

  ocl::DeviceContext& device_;
  Graph graph_;  // pruned and fused, without constants
  std::vector<ocl::Kernel> kernels_;
  std::vector<Step> steps_;
  std::vector<NnLayer> layers_;
  ocl::Buffer<NnLayer> layers_on_device_;
  ocl::GroupsTogether groups_;
  size_t run_layers_ = 0;
  ocl::Buffer<float> weights_;
  ocl::Buffer<float> arena_;
  ocl::Buffer<uint8_t> input_u8_;
  size_t convert_u8_ = 0;
  std::vector<int64_t> offsets_;
};

// Known-answer tests of the kernels/nn files for `livecap devices`.
std::vector<ocl::SelfTestResult> nn_self_test(ocl::DeviceContext& device);

}  // namespace livecap::nn

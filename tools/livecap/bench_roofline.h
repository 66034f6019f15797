// What a device can do at most, measured: the rate at which it copies memory and at which it multiplies matrices.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace livecap::tools {

struct Roofline {
  double copy_gb_per_s = 0;     // read and written bytes of a copy within the device's memory
  double gemm_gflop_per_s = 0;  // our own 1x1 convolution, 4096 x 512 times 512 x 512; two operations a multiply-add
};

// selector: as of --cnn-device; role: "network" or "solver" of the pair that a capture would use.
Roofline measure_roofline(const std::string& cnn_device, const std::string& solver_device, bool network);

nlohmann::ordered_json roofline_json(const Roofline& roofline);

// The network's arithmetic, which is known: operations a frame, their rate in the stage, and its share of the roofline.
// network_ms: of the stage, crop and read-back included.
nlohmann::ordered_json network_share_json(const std::string& model, double network_ms, const Roofline& roofline);

}  // namespace livecap::tools

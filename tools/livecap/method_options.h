// Options that several subcommands share: each is declared once, so that it has the same name, check and help in all.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "actor/height_range.h"
#include "base/value_range.h"
#include "livecap/method.h"

namespace livecap::tools {

// --height, in metres.
CLI::Option* add_height_option(CLI::App& command, double& height_mm, const std::string& what,
                               const ValueRange& range_mm = kActorHeightMm);
// --fov.
CLI::Option* add_fov_option(CLI::App& command, double& fov_deg,
                            const std::string& what = "instead of --camera: field of view of the longer side, degrees");
// --floor.
void add_floor_option(CLI::App& command, std::string& file);
// --camera, --fov; not both.
void add_camera_options(CLI::App& command, std::string& camera, double& fov_deg);
// --background, --background-frames; not both.
std::vector<CLI::Option*> add_background_options(CLI::App& command, std::string& background, int& n_frames);
// --model.
CLI::Option* add_model_option(CLI::App& command, std::string& model);
// --cnn-device.
CLI::Option* add_network_device_option(CLI::App& command, std::string& selector);
// --cnn-device, --solver-device.
std::vector<CLI::Option*> add_device_options(CLI::App& command, std::string& cnn_device, std::string& solver_device);
// --first, --frames.
std::vector<CLI::Option*> add_frame_options(CLI::App& command, int64_t& first, int64_t& frames);

// What a capture can be told besides its actor: --height, --model, --without, --rigidity and the devices.
std::vector<CLI::Option*> add_setting_options(CLI::App& command, MethodOptions& method);
// All of MethodOptions: --actor, --no-surface and those settings.
void add_method_options(CLI::App& command, MethodOptions& method);

}  // namespace livecap::tools

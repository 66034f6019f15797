// What the subcommands of the program `livecap` share. Each lives in its own cmd_<name>.cpp.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace livecap::tools {

// What main() runs after the command line is understood. Returns the exit code; may throw livecap::Error.
using Action = std::function<int()>;

inline constexpr int kExitOk = 0;
inline constexpr int kExitRunFailed = 1;  // no device, a failed OpenCL call, a failed self-test, nothing tracked
inline constexpr int kExitBadInput = 2;   // bad usage, or an input or output file that is not what it has to be

// Each adds its subcommand, which sets `action` when it was chosen.
void add_actor_command(CLI::App& app, Action& action);
void add_bench_command(CLI::App& app, Action& action);
void add_calibrate_command(CLI::App& app, Action& action);
void add_capture_command(CLI::App& app, Action& action);
void add_detect_command(CLI::App& app, Action& action);
void add_devices_command(CLI::App& app, Action& action);
void add_eval_command(CLI::App& app, Action& action);
void add_export_command(CLI::App& app, Action& action);
void add_live_command(CLI::App& app, Action& action);
void add_render_command(CLI::App& app, Action& action);
void add_synth_command(CLI::App& app, Action& action);

}  // namespace livecap::tools

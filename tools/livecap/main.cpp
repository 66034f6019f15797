// The command line: livecap SUBCOMMAND OPTIONS. Reads options, runs one subcommand, turns every failure into one line
// on standard error and a documented exit code.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "base/log.h"
#include "command.h"
#include "config_file.h"
#include "livecap/error.h"
#include "ocl/device.h"
#include "progress.h"
#include "standard_output.h"
#include "usage_error.h"

namespace livecap::tools {
namespace {

constexpr const char* kFooter =
    "Exit codes: 0 ok, 1 the run failed (no OpenCL device, a failed OpenCL call or self-test, an interruption), 2 bad "
    "usage or bad input.\n`livecap SUBCOMMAND --help` lists the options of a subcommand.";

// Errors are one line: what follows the first line (a build log, a list of devices) is folded, or printed with -v.
void print_error(const std::string& message) {
  const size_t end = message.find('\n');
  if (end == std::string::npos || log_level() >= LogLevel::kInfo) return log_error(message);
  log_error(message.substr(0, end) + " (more with -v)");
}

int run(int argc, char** argv) {
  CLI::App app("LiveCap-CL: real-time human performance capture from one colour camera, in OpenCL.", "livecap");
  app.footer(kFooter);
  app.set_version_flag("--version", std::string("livecap ") + LIVECAP_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);

  int verbosity = 0;
  bool quiet = false;
  CLI::Option* verbose_flag = app.add_flag("-v,--verbose", verbosity, "say more; twice: everything");
  app.add_flag("-q,--quiet", quiet, "errors only, no progress")->excludes(verbose_flag);
  add_config_option(app);

  Action action;
  add_devices_command(app, action);
  add_actor_command(app, action);
  add_calibrate_command(app, action);
  add_synth_command(app, action);
  add_detect_command(app, action);
  add_capture_command(app, action);
  add_live_command(app, action);
  add_render_command(app, action);
  add_export_command(app, action);
  add_eval_command(app, action);
  add_bench_command(app, action);
  for (CLI::App* command : app.get_subcommands({})) command->fallthrough();  // -v, -q, --config after the subcommand

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    const std::string unknown = unknown_subcommand(app);
    if (unknown.empty()) return app.exit(help);
    log_error(usage_message(app, CLI::ExtrasError({unknown})));
    return kExitBadInput;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --version
    log_error(usage_message(app, error));
    return kExitBadInput;
  }
  if (quiet) set_log_level(LogLevel::kError);
  if (verbosity > 0) set_log_level(verbosity > 1 ? LogLevel::kDebug : LogLevel::kInfo);

  ocl::prepare_platforms();
  return action();
}

}  // namespace
}  // namespace livecap::tools

int main(int argc, char** argv) {
  using namespace livecap;
  tools::outlive_closed_pipes();
  try {
    const int code = tools::run(argc, argv);
    if (code == tools::kExitOk) tools::require_heard();
    return code;
  } catch (const ConfigError& error) {
    tools::print_error(error.what());
    return tools::kExitBadInput;
  } catch (const IoError& error) {
    tools::print_error(error.what());
    return tools::kExitBadInput;
  } catch (const OclError& error) {
    // Ctrl-C also reaches the compiler that a driver has started.
    tools::print_error(tools::interrupted() ? "interrupted" : error.what());
  } catch (const std::bad_alloc&) {
    tools::print_error("out of memory");
  } catch (const std::exception& error) {
    tools::print_error(error.what());
  } catch (...) {
    tools::print_error("unknown exception");
  }
  return tools::kExitRunFailed;
}

#include "usage_error.h"

#include <vector>

#include "config_file.h"
#include "livecap/error.h"

namespace livecap::tools {
namespace {

// Of an option whose value could not be read.
std::string expected_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type.rfind("FLOAT", 0) == 0) return "a number";
  if (type.rfind("INT", 0) == 0) return "a whole number";
  if (type.rfind("UINT", 0) == 0) return "a whole number, at least 0";
  return "true or false";
}

// The option that a message of CLI11's begins with ("--frames: ..."), or that follows its "Could not convert: ".
const CLI::Option* option_of(const CLI::App& app, const CLI::App& command, std::string message) {
  const std::string convert = "Could not convert: ";
  if (message.rfind(convert, 0) == 0) message.erase(0, convert.size());
  const std::string name = message.substr(0, message.find_first_of(": ="));
  const CLI::Option* option = command.get_option_no_throw(name);
  return option ? option : app.get_option_no_throw(name);
}

// The innermost subcommand that was understood.
const CLI::App& reached(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return *command;
}

}  // namespace

std::string unknown_subcommand(const CLI::App& app) {
  if (reached(app).get_require_subcommand_min() == 0) return {};
  for (const std::string& argument : app.remaining(true))
    if (argument.rfind('-', 0) != 0) return argument;
  return {};
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  std::string called = app.get_name();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    called += " " + command->get_name();
  }
  std::string message = error.what();
  const std::string kind = error.get_name();
  const std::vector<std::string> unknown = app.remaining(true);
  const CLI::Option* option = option_of(app, *command, message);
  const bool has_extras = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);
  if (!unknown.empty() && (has_extras || kind == "RequiredError")) {
    const bool is_option = unknown.front().rfind('-', 0) == 0;
    const bool is_command = !is_option && command->get_require_subcommand_min() > 0;
    message = (is_option ? "no option " : is_command ? "no subcommand " : "unexpected argument ") + unknown.front();
  } else if (kind == "ConversionError" && option) {
    const std::vector<std::string>& given = option->results();
    message = option->get_name() + ": must be " + expected_of(*option) + ", not " + CLI::detail::join(given, " ");
  } else if (kind == "ArgumentMismatch" && option && message.ends_with(" missing")) {
    message = option->get_name() + ": a value is missing";
  } else if (kind == "FileError") {
    message = "--config " + message;
  }
  if (option) message = place_in_config(app, *option) + message;
  return one_line(message) + " (see `" + called + " --help`)";
}

}  // namespace livecap::tools

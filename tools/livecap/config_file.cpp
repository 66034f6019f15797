#include "config_file.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "livecap/error.h"
#include "toml_entries.h"

namespace livecap::tools {
namespace {

// Puts the items of the file where CLI11 looks for them: below the subcommand that was chosen.
class SubcommandConfig : public CLI::ConfigTOML {
 public:
  explicit SubcommandConfig(const CLI::App& app) : app_(app) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    const std::string file = app_.get_config_ptr()->as<std::string>();
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    std::vector<std::string> chosen;  // actor, build
    const CLI::App* command = &app_;
    while (!command->get_subcommands().empty()) {
      command = command->get_subcommands().front();
      chosen.push_back(command->get_name());
    }
    std::vector<CLI::ConfigItem> kept;
    std::vector<TomlEntry> entries = read_toml(text, file);
    // A subcommand's own section counts before the top of the file: CLI11 keeps the first.
    std::stable_partition(entries.begin(), entries.end(),
                          [](const TomlEntry& entry) { return !entry.section.empty(); });
    for (TomlEntry& entry : entries) {
      const std::string place = file + ":" + std::to_string(entry.line) + ": ";
      if (!entry.section.empty() && !exists(entry.section)) throw ConfigError(place + "there is no such subcommand");
      if (is_above(entry.section, chosen))
        throw ConfigError(place + entry.name + ": options of `" + CLI::detail::join(chosen, " ") + "` stand in [" +
                          CLI::detail::join(chosen, ".") + "] or at the top");
      if (!entry.section.empty() && entry.section != chosen) continue;
      const bool of_program = entry.section.empty() && option(app_, entry.name);
      const CLI::Option* found = option(of_program ? app_ : *command, entry.name);
      if (!found) throw ConfigError(place + "no option " + entry.name);
      if (found->count() == 0) places_.emplace(found, place);
      kept.emplace_back();
      if (!of_program) kept.back().parents = chosen;
      kept.back().name = std::move(entry.name);
      kept.back().inputs = std::move(entry.values);
    }
    return kept;
  }

  std::string place(const CLI::Option& option) const {
    const auto found = places_.find(&option);
    return found == places_.end() ? std::string() : found->second;
  }

 private:
  // {"actor"} above {"actor", "build"}.
  static bool is_above(const std::vector<std::string>& section, const std::vector<std::string>& chosen) {
    return !section.empty() && section.size() < chosen.size() &&
           std::equal(section.begin(), section.end(), chosen.begin());
  }

  static const CLI::Option* option(const CLI::App& app, const std::string& name) {
    const CLI::Option* option = app.get_option_no_throw("--" + name);
    if (!option) option = app.get_option_no_throw(name);  // an argument without a name on the command line
    return option && option->get_configurable() ? option : nullptr;
  }

  bool exists(const std::vector<std::string>& path) const {
    const CLI::App* at = &app_;
    for (const std::string& name : path) {
      const auto below = at->get_subcommands([&](const CLI::App* command) { return command->get_name() == name; });
      if (below.empty()) return false;
      at = below.front();
    }
    return true;
  }

  const CLI::App& app_;
  mutable std::map<const CLI::Option*, std::string> places_;  // from_config is const
};

}  // namespace

void add_config_option(CLI::App& app) {
  app.config_formatter(std::make_shared<SubcommandConfig>(app));
  app.set_config("--config", "", "read options from a TOML file; the command line wins");
  app.allow_config_extras(CLI::config_extras_mode::error);
}

std::string place_in_config(const CLI::App& app, const CLI::Option& option) {
  const auto config = std::dynamic_pointer_cast<SubcommandConfig>(app.get_config_formatter());
  return config ? config->place(option) : std::string();
}

}  // namespace livecap::tools

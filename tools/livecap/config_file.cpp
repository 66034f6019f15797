#include "config_file.h"

#include <memory>
#include <utility>
#include <vector>

namespace livecap::tools {
namespace {

// Puts the items of the file where CLI11 looks for them: below the subcommand that was chosen.
class SubcommandConfig : public CLI::ConfigTOML {
 public:
  explicit SubcommandConfig(const CLI::App& app) : app_(app) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    const std::vector<const CLI::App*> chosen =
        app_.get_subcommands([](const CLI::App* command) { return command->parsed(); });
    std::vector<CLI::ConfigItem> kept;
    for (CLI::ConfigItem& item : CLI::ConfigTOML::from_config(in)) {
      if (item.name == "++" || item.name == "--") continue;  // section marks: a section chooses no subcommand
      if (item.parents.empty()) {
        if (!app_.get_option_no_throw("--" + item.name) && !chosen.empty()) item.parents = {chosen.front()->get_name()};
      } else if (is_other_subcommand(item.parents.front(), chosen)) {
        continue;
      }
      kept.push_back(std::move(item));
    }
    return kept;
  }

 private:
  bool is_other_subcommand(const std::string& name, const std::vector<const CLI::App*>& chosen) const {
    if (!chosen.empty() && chosen.front()->get_name() == name) return false;
    for (const CLI::App* command : app_.get_subcommands({})) {
      if (command->get_name() == name) return true;
    }
    return false;
  }

  const CLI::App& app_;
};

}  // namespace

void add_config_option(CLI::App& app) {
  app.config_formatter(std::make_shared<SubcommandConfig>(app));
  app.set_config("--config", "", "read options from a TOML file; the command line wins");
  app.allow_config_extras(CLI::config_extras_mode::error);
}

}  // namespace livecap::tools

// --config FILE.toml.
#include "fuzz/fuzz.h"
#include "livecap/config_file.h"
#include "livecap/error.h"

namespace livecap::fuzz {

std::vector<std::string> seeds() {
  return {
      "verbose = 1\n[capture]\nvideo = \"a b.mp4\"\nfov = 60.5 # degrees\nwithout = [\"photo\", 'edge']\noverlay = "
      "true\nsize = [540, 960]\n\n[eval]\nhtml = \"x\"\n",
      "video = 'v.mp4'\nframes = 0x10\n\"overlay\" = false\n"};
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("config.toml", {reinterpret_cast<const char*>(data), size});
  // Options of all kinds that the program has.
  CLI::App app("fuzz", "livecap");
  int verbosity = 0, frames = 0;
  bool overlay = false;
  double fov = 0;
  std::string video;
  std::vector<std::string> without;
  std::vector<int> size_px;
  app.require_subcommand(1);
  app.add_flag("-v,--verbose", verbosity);
  tools::add_config_option(app);
  CLI::App* capture = app.add_subcommand("capture");
  capture->add_option("--video", video);
  capture->add_option("--frames", frames);
  capture->add_option("--fov", fov);
  capture->add_option("--without", without)->delimiter(',');
  capture->add_option("--size", size_px)->expected(2);
  capture->add_flag("--overlay", overlay);
  app.add_subcommand("eval")->add_option("--html", video);
  for (CLI::App* command : app.get_subcommands({})) command->fallthrough();
  bool is_accepted = false;
  try {
    app.parse("capture --config " + file.string());
    is_accepted = true;
  } catch (const CLI::ParseError&) {  // the program makes one line of it
  } catch (const ConfigError&) {
  }
  fuzz::count(is_accepted);
  return 0;
}

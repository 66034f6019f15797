// livecap calibrate: views of a chessboard or ChArUco board -> camera.json.
#include <cstdio>
#include <memory>
#include <string>

#include "acquire/calibrate.h"
#include "base/log.h"
#include "base/text.h"
#include "command.h"
#include "livecap/error.h"
#include "progress.h"

namespace livecap::tools {
namespace {

struct Options {
  acquire::CalibrateOptions calibrate;
  std::string images, video;
  std::string board, charuco;
  std::string dictionary = "4x4_50";
  std::string out;
};

void print(const acquire::Calibration& result, const std::string& out) {
  const Camera& camera = result.camera;
  std::printf("%s: %dx%d px, f %.2f %.2f px (uncertain by %.2f %%), centre %.1f %.1f px\n", out.c_str(), camera.width,
              camera.height, camera.fx, camera.fy, 100 * result.focal_sigma, camera.cx, camera.cy);
  std::printf("distortion k1 %.5f, k2 %.5f, p1 %.5f, p2 %.5f, k3 %.5f\n", camera.distortion[0], camera.distortion[1],
              camera.distortion[2], camera.distortion[3], camera.distortion[4]);
  std::printf("reprojection %.3f px (RMS) over %d views\n", result.rms_px, result.n_used);
  std::printf("share of the corners in each ninth of the picture, per cent:\n");
  for (int row = 0; row < 3; ++row)
    std::printf("  %4.0f %4.0f %4.0f\n", 100 * result.coverage[3 * row], 100 * result.coverage[3 * row + 1],
                100 * result.coverage[3 * row + 2]);
  std::printf("the most a side of the board was farther away: left %.0f, right %.0f, upper %.0f, lower %.0f degrees\n",
              result.tilts_deg[0], result.tilts_deg[1], result.tilts_deg[2], result.tilts_deg[3]);
  std::printf("RMS of each view, px:\n");
  for (const acquire::BoardView& view : result.views)
    std::printf("  %-32s %6.3f%s\n", view.name.c_str(), view.rms_px, view.left_out.empty() ? "" : "  left out");
}

int calibrate(const Options& options) {
  acquire::CalibrateOptions given = options.calibrate;
  if (options.images.empty() == options.video.empty())
    throw ConfigError("calibrate: give either --images (a folder) or --video");
  if (options.board.empty() == options.charuco.empty())
    throw ConfigError(
        "calibrate: give either --board COLUMNSxROWS (inner corners) or --charuco COLUMNSxROWS (squares)");
  given.source = options.images.empty() ? options.video : options.images;
  if (options.charuco.empty()) {
    acquire::read_board_size(options.board, "--board", given.board.columns, given.board.rows);
  } else {
    acquire::read_board_size(options.charuco, "--charuco", given.board.columns, given.board.rows);
    given.board.dictionary = options.dictionary;
  }
  given.validate();
  catch_interrupt();
  Progress progress("calibrate");
  const acquire::BoardViews views = acquire::gather_board_views(given, [&](int done, int total) {
    progress.update(done, total);
    return !interrupted();
  });
  progress.finish();
  const acquire::Calibration result = acquire::calibrate(views);
  save_camera(result.camera, options.out);
  for (const std::string& note : result.notes) log_warning(note);
  print(result, options.out);
  return kExitOk;
}

}  // namespace

void add_calibrate_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("calibrate", "camera.json from views of a chessboard or ChArUco board");
  command->add_option("--images", options->images, "folder of pictures of the board");
  command->add_option("--video", options->video, "or a video of it");
  command->add_option("--board", options->board, "chessboard: inner corners, COLUMNSxROWS, e.g. 9x6");
  command->add_option("--charuco", options->charuco, "or a ChArUco board: squares, COLUMNSxROWS, e.g. 7x5");
  command->add_option("--dictionary", options->dictionary, "of the ChArUco markers")->capture_default_str();
  command->add_option("--marker", options->calibrate.board.marker_share, "side of a marker over that of its square")
      ->capture_default_str();
  command->add_option("--max-views", options->calibrate.max_views, "the most different ones are used")
      ->capture_default_str();
  command->add_option("--out", options->out, "camera.json to write")->required();
  command->callback([options, &action] { action = [options] { return calibrate(*options); }; });
}

}  // namespace livecap::tools

// livecap calibrate: views of a chessboard or ChArUco board -> camera.json; and where the floor is, from one of them.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "base/log.h"
#include "base/require_apart.h"
#include "base/require_writable.h"
#include "base/text.h"
#include "calibrate/calibrate.h"
#include "calibrate/floor_board.h"
#include "command.h"
#include "livecap/error.h"
#include "progress.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

struct CalibrateCommand {
  CalibrateOptions calibrate;
  FloorBoardOptions floor;
  std::string images, video, camera;
  std::string board, charuco;
  std::string dictionary = "4x4_50";
  std::string out;
};

void print(const Calibration& result, const std::string& out) {
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
  for (const BoardView& view : result.views)
    std::printf("  %-32s %6.3f%s\n", view.name.c_str(), view.rms_px, view.left_out.empty() ? "" : "  left out");
}

void print(const FloorBoard& result, const std::string& out) {
  std::printf("floor: the camera is %.0f mm above it, looks down by %.1f degrees and is rolled by %.1f degrees\n",
              result.floor.distance_mm, result.tilt.down_deg, result.tilt.roll_deg);
  std::printf(
      "  from %d corners %.2f m away, reprojection %.3f px (RMS); a metre from the board uncertain by %.1f mm\n",
      result.n_corners, result.away_mm / 1000, result.rms_px, result.sigma_mm);
  std::printf("%s written\n", out.c_str());
}

BoardOptions board_of(const CalibrateCommand& options) {
  BoardOptions board = options.calibrate.board;
  if (options.board.empty() == options.charuco.empty())
    throw ConfigError(
        "calibrate: give either --board COLUMNSxROWS (inner corners) or --charuco COLUMNSxROWS (squares)");
  if (options.charuco.empty()) {
    read_board_size(options.board, "--board", board.columns, board.rows);
  } else {
    read_board_size(options.charuco, "--charuco", board.columns, board.rows);
    board.dictionary = options.dictionary;
  }
  return board;
}

Calibration calibrate_views(const CalibrateOptions& options) {
  catch_interrupt();
  Progress progress("calibrate");
  const BoardViews views = gather_board_views(options, [&](int done, int total) {
    progress.update(done, total);
    return !interrupted();
  });
  progress.finish();
  return calibrate(views);
}

int calibrate(const CalibrateCommand& options) {
  const bool has_floor = !options.floor.picture.empty(), has_camera = !options.camera.empty();
  if (has_camera && (!options.images.empty() || !options.video.empty()))
    throw ConfigError("calibrate: --camera is one that is calibrated already; it does not go with --images or --video");
  if (has_camera && !has_floor) throw ConfigError("calibrate: --camera needs --floor, the picture to add to it");
  if (!has_floor && options.floor.square_mm > 0)
    throw ConfigError("calibrate: --square is for --floor, the picture of the board on the floor");
  if (!has_camera && options.images.empty() == options.video.empty())
    throw ConfigError("calibrate: give either --images (a folder) or --video");
  CalibrateOptions views = options.calibrate;
  FloorBoardOptions floor = options.floor;
  views.board = floor.board = board_of(options);
  views.source = options.images.empty() ? options.video : options.images;
  if (!has_camera) views.validate();
  if (has_floor) floor.validate();
  require_writable(options.out);
  require_apart({{"--video", options.video}, {"--floor", floor.picture}}, {options.out});  // --camera may be

  Camera camera;
  if (has_camera) camera = load_camera(options.camera);
  std::optional<FloorPicture> picture;  // first: views take minutes
  if (has_floor) picture = read_floor_picture(floor);
  std::optional<Calibration> calibration;
  if (!has_camera) {
    calibration = calibrate_views(views);
    camera = calibration->camera;
  }
  std::optional<FloorBoard> found;
  if (picture) {
    found = find_floor(*picture, camera);
    camera.floor = found->floor;
  }
  save_camera(camera, options.out);
  for (const auto* notes : {calibration ? &calibration->notes : nullptr, found ? &found->notes : nullptr})
    if (notes)
      for (const std::string& note : *notes) log_warning(note);
  if (calibration) print(*calibration, options.out);
  if (found) print(*found, options.out);
  return kExitOk;
}

}  // namespace

void add_calibrate_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<CalibrateCommand>();
  CLI::App* command = app.add_subcommand("calibrate", "camera.json from views of a chessboard or ChArUco board");
  command->add_option("--images", options->images, "folder of pictures of the board");
  command->add_option("--video", options->video, "or a video of it");
  command->add_option("--board", options->board, "chessboard: inner corners, COLUMNSxROWS, e.g. 9x6");
  command->add_option("--charuco", options->charuco, "or a ChArUco board: squares, COLUMNSxROWS, e.g. 7x5");
  command->add_option("--dictionary", options->dictionary, "of the ChArUco markers")->capture_default_str();
  command->add_option("--marker", options->calibrate.board.marker_share, "side of a marker over that of its square")
      ->check(between({0.2, 1}))
      ->capture_default_str();
  command->add_option("--floor", options->floor.picture, "also where the floor is: a picture of the board lying on it");
  command->add_option("--square", options->floor.square_mm, "side of a square in mm, for --floor")->check(above(0));
  command->add_option("--camera", options->camera, "camera.json to add the floor to, instead of --images or --video");
  command->add_option("--max-views", options->calibrate.max_views, "the most different ones are used")
      ->check(between({kMinBoardViews, 200}))
      ->capture_default_str();
  command->add_option("--out", options->out, "camera.json to write")->required();
  command->callback([options, &action] { action = [options] { return calibrate(*options); }; });
}

}  // namespace livecap::tools

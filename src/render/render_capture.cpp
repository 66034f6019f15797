#include "render/render_capture.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <future>
#include <optional>
#include <thread>

#include "base/require_apart.h"
#include "base/text.h"
#include "image/undistort.h"
#include "image/video.h"
#include "livecap/error.h"
#include "render/clip.h"
#include "render/picture_sink.h"
#include "render/scene.h"

namespace livecap::render {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kMaxThreads = 16;
constexpr int64_t kPaintingBytes = 2'000'000'000;  // for all pictures being painted
constexpr int64_t kBytesPerPixel = 10;             // of one: background, result and nearness

// The undistorted pictures of a video by their frame's number, which rises.
class VideoFrames {
 public:
  VideoFrames(const RenderOptions& options, const CaptureFolder& capture)
      : name_(options.video.empty() ? capture.video : options.video), undistorter_(capture.camera) {
    if (name_.empty()) throw IoError(not_named(capture.path / "report.json", "video") + " or --background '#rrggbb'");
    if (is_webcam(name_))
      throw ConfigError("the video of " + capture.path.string() + " was " + name_ +
                        ", which shows something else now; give --video or --background '#rrggbb'");
    std::error_code ignored;
    if (options.video.empty() && !fs::exists(name_, ignored))
      throw IoError(name_ + ": no such file or folder; " + (capture.path / "report.json").string() +
                    " names it, --video says otherwise");
    if (options.video.empty()) require_no_pipe(name_);
    reader_.emplace(name_);
    const VideoInfo info = reader_->info();
    if (info.width != capture.camera.width || info.height != capture.camera.height)
      throw IoError(name_ + format(": pictures of %dx%d, the camera is for %dx%d; see --camera and --video", info.width,
                                   info.height, capture.camera.width, capture.camera.height));
  }

  ImageRgb at(int64_t index) {
    do {
      if (!reader_->read(frame_))
        throw IoError(name_ + format(": ends before frame %lld, which the capture has: it is not its video, or cut off",
                                     static_cast<long long>(index)));
    } while (frame_.index < index);
    return undistorter_.undistort(frame_.image);
  }

 private:
  std::string name_;
  Undistorter undistorter_;
  std::optional<VideoReader> reader_;
  Frame frame_;
};

// Evenly, first and last included; those that are tracked if there are enough of them.
std::vector<int64_t> rows_of_sheet(const Clip& clip, size_t n) {
  std::vector<int64_t> from;
  for (int64_t row : clip.rows) {
    if (clip.tracked(row)) from.push_back(row);
  }
  if (from.size() < n) from = clip.rows;
  if (from.size() <= n) return from;
  std::vector<int64_t> rows;
  for (size_t i = 0; i < n; ++i) rows.push_back(from[n == 1 ? from.size() / 2 : i * (from.size() - 1) / (n - 1)]);
  return rows;
}

// Which rows become pictures.
std::vector<int64_t> rows_of(const Clip& clip, const RenderOptions& options) {
  if (options.sheet_columns > 0)
    return rows_of_sheet(clip, static_cast<size_t>(options.sheet_columns) * options.sheet_rows);
  if (output_kind(options.out) != OutputKind::kPicture) return clip.rows;
  const auto tracked = std::find_if(clip.rows.begin(), clip.rows.end(), [&](int64_t row) { return clip.tracked(row); });
  return {tracked == clip.rows.end() ? clip.rows.front() : *tracked};
}

bool is_same(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored);
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

// A finished picture must not take the place of what it was made from, nor of a picture beside it.
void require_pictures_apart(const RenderOptions& options, const CaptureFolder& capture) {
  std::error_code ignored;
  const bool has_picture = options.background != "video" && options.background != "none";
  for (const std::string& input :
       {options.video.empty() ? capture.video : options.video, has_picture ? options.background : std::string()}) {
    if (input.empty()) continue;
    if (is_same(options.out, input)) throw ConfigError("--out " + options.out + ": is an input of this");
    if (fs::is_directory(input, ignored) && is_same(folder_of(options.out), input))
      throw ConfigError("--out " + options.out + ": lies among the pictures of " + input +
                        ", an input of this; give another folder");
    if (fs::path(input).extension() == ".png" && is_same(options.out, folder_of(input)))
      throw ConfigError("--out " + options.out + ": holds " + input + ", an input of this; give another folder");
  }
  require_apart(capture_inputs("--capture", options.capture), {options.out});
}

SceneFrame scene_frame(Clip& clip, int64_t row, double share, VideoFrames* video) {
  SceneFrame frame{row, share, clip.vertices(row), clip.joints(row), {}};
  if (video) frame.video = video->at(clip.capture.rows[row].index);
  return frame;
}

// Pictures are painted several at a time; in and out go in order.
void paint_all(const std::vector<int64_t>& rows, Clip& clip, const Scene& scene, VideoFrames* video, PictureSink& sink,
               const RenderProgress& progress, RenderReport& report) {
  const size_t at_once = pictures_at_once(scene.drawn_pixels(), std::thread::hardware_concurrency());
  const auto n = static_cast<int64_t>(rows.size());
  for (size_t begin = 0; begin < rows.size() && report.complete; begin += at_once) {
    const size_t end = std::min(rows.size(), begin + at_once);
    struct Painting {
      bool empty;
      std::future<ScenePicture> picture;
    };
    std::vector<Painting> paintings;
    std::exception_ptr unread;  // thrown when what comes before it is written
    for (size_t i = begin; i < end && !unread; ++i) {
      try {
        SceneFrame frame = scene_frame(clip, rows[i], static_cast<double>(i) / static_cast<double>(n), video);
        const bool empty = frame.vertices.empty();
        paintings.push_back(
            {empty, std::async(std::launch::async, [&scene, frame = std::move(frame)] { return scene.paint(frame); })});
      } catch (...) {
        unread = std::current_exception();
      }
    }
    for (size_t k = 0; k < paintings.size() && report.complete; ++k) {
      sink.write(clip.capture.rows[rows[begin + k]].index, paintings[k].picture.get());
      ++report.pictures;
      report.empty += paintings[k].empty;
      if (progress && !progress(report.pictures, n)) report.complete = report.pictures == n;
    }
    if (unread && report.complete) std::rethrow_exception(unread);
  }
}

}  // namespace

size_t pictures_at_once(int64_t drawn_pixels, unsigned processors) {
  const int64_t room = kPaintingBytes / (kBytesPerPixel * drawn_pixels);
  return static_cast<size_t>(std::max<int64_t>(1, std::min({room, int64_t{processors}, kMaxThreads})));
}

RenderReport render_capture(const RenderOptions& options, const RenderProgress& progress) {
  options.validate();
  Clip clip = open_clip(options);
  require_pictures_apart(options, clip.capture);
  const Scene scene(clip, options);
  std::optional<VideoFrames> video;
  if (options.needs_video()) video.emplace(options, clip.capture);
  RenderReport report;
  report.width = scene.width();
  report.height = scene.height();
  report.fps = options.fps > 0 ? options.fps : clip.capture.fps / static_cast<double>(options.every);
  if (output_kind(options.out) == OutputKind::kFilm && !(report.fps >= kMinFps && report.fps <= kMaxFps))
    throw ConfigError(format("--every %lld: a film of %g pictures a second, expected %g to %g; see --fps",
                             static_cast<long long>(options.every), report.fps, kMinFps, kMaxFps));
  const std::unique_ptr<PictureSink> sink = open_sink(options, report.width, report.height, report.fps);
  try {
    paint_all(rows_of(clip, options), clip, scene, video ? &*video : nullptr, *sink, progress, report);
  } catch (const IoError& error) {
    if (output_kind(options.out) != OutputKind::kFolder || report.pictures == 0) throw;
    throw IoError(error.what() + format("; %s holds the first %lld pictures", options.out.c_str(),
                                        static_cast<long long>(report.pictures)));
  }
  sink->finish();
  return report;
}

}  // namespace livecap::render

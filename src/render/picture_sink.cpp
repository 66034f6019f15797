#include "render/picture_sink.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "base/log.h"
#include "base/output_path.h"
#include "base/require_writable.h"
#include "base/text.h"
#include "image/image_io.h"
#include "image/video.h"
#include "livecap/error.h"

namespace livecap::render {
namespace {

namespace fs = std::filesystem;

constexpr int kGapPx = 4;  // between the panels of a sheet
constexpr int kMaxSheetPx = 16384;
constexpr Rgb kPaper = {255, 255, 255};

// width or height of n panels in a row.
int sheet_side(int n, int panel_px) {
  const int64_t side = static_cast<int64_t>(n) * (panel_px + kGapPx) - kGapPx;
  if (side > kMaxSheetPx)
    throw ConfigError(format("--sheet: %d panels of %d px are %lld px; at most %d, see --size", n, panel_px,
                             static_cast<long long>(side), kMaxSheetPx));
  return static_cast<int>(side);
}

void write_picture(const ScenePicture& picture, const fs::path& file) {
  if (picture.alpha.empty()) {
    write_png(picture.color, file);
  } else {
    write_png(picture.color, picture.alpha, file);
  }
}

class Film : public PictureSink {
 public:
  Film(const std::string& file, int width, int height, double fps) : file_(link_target(file).string()) {
    writer_.emplace(file, width, height, fps);
  }
  ~Film() override {
    if (finished_) return;
    writer_.reset();
    std::error_code ignored;
    fs::remove(file_ + ".part", ignored);
  }
  void write(int64_t, const ScenePicture& picture) override { writer_->write(picture.color); }
  void finish() override {
    writer_->close();
    finished_ = true;
  }

 private:
  std::string file_;
  std::optional<VideoWriter> writer_;
  bool finished_ = false;
};

class Folder : public PictureSink {
 public:
  explicit Folder(const fs::path& folder) : folder_(folder) {
    std::error_code code;
    fs::create_directories(folder, code);
    std::error_code ignored;
    if (code || !fs::is_directory(folder, ignored))
      throw IoError(folder.string() + ": cannot be made a folder" + (code ? ": " + code.message() : ""));
  }
  void write(int64_t index, const ScenePicture& picture) override {
    const std::string name = format("%06d.png", static_cast<int>(index));
    write_picture(picture, folder_ / name);
    written_.insert(name);
  }
  // They may be another part of the same clip, or of another render that a program takes for this one's.
  void finish() override {
    size_t n_others = 0;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
      const std::string name = entry.path().filename().string();
      if (name.size() == 10 && name.ends_with(".png") && name.find_first_not_of("0123456789") == 6)
        n_others += !written_.count(name);
    }
    if (n_others > 0)
      log_warning(folder_.string() + format(": %zu numbered pictures in it are of another render", n_others));
  }

 private:
  fs::path folder_;
  std::set<std::string> written_;
};

class OnePicture : public PictureSink {
 public:
  explicit OnePicture(const std::string& file) : file_(file) { require_writable(file); }
  void write(int64_t, const ScenePicture& picture) override { write_picture(picture, file_); }
  void finish() override {}

 private:
  std::string file_;
};

// Panels in rows, the first at the upper left.
class Sheet : public PictureSink {
 public:
  Sheet(const std::string& file, int columns, int rows, int width, int height)
      : picture_(file),
        columns_(columns),
        width_(width),
        height_(height),
        sheet_{plain_picture(sheet_side(columns, width), sheet_side(rows, height), kPaper), {}} {}
  void write(int64_t, const ScenePicture& picture) override {
    const int left = n_ % columns_ * (width_ + kGapPx), top = n_ / columns_ * (height_ + kGapPx);
    const auto place = [&](std::vector<uint8_t>& to, const std::vector<uint8_t>& from, int channels) {
      for (int y = 0; y < height_; ++y)
        std::copy_n(&from[size_t(channels) * y * width_], channels * width_,
                    &to[channels * (size_t(top + y) * sheet_.color.width + left)]);
    };
    place(sheet_.color.pixels, picture.color.pixels, 3);
    if (!picture.alpha.empty()) {
      if (sheet_.alpha.empty())
        sheet_.alpha = {sheet_.color.width, sheet_.color.height, std::vector<uint8_t>(sheet_.color.pixels.size() / 3)};
      place(sheet_.alpha.pixels, picture.alpha.pixels, 1);
    }
    ++n_;
  }
  void finish() override { picture_.write(0, sheet_); }

 private:
  OnePicture picture_;
  int columns_, width_, height_;
  int n_ = 0;
  ScenePicture sheet_;
};

}  // namespace

OutputKind output_kind(const std::string& out) {
  std::error_code ignored;
  if (fs::is_directory(out, ignored)) return OutputKind::kFolder;
  const std::string suffix = fs::path(out).extension().string();
  if (suffix == ".mp4") return OutputKind::kFilm;
  if (suffix == ".png") return OutputKind::kPicture;
  if (suffix.empty()) return OutputKind::kFolder;
  throw ConfigError("--out " + out + ": expected a film (.mp4), a picture (.png) or a folder");
}

std::unique_ptr<PictureSink> open_sink(const RenderOptions& options, int width, int height, double fps) {
  if (options.sheet_columns > 0)
    return std::make_unique<Sheet>(options.out, options.sheet_columns, options.sheet_rows, width, height);
  switch (output_kind(options.out)) {
    case OutputKind::kFilm:
      return std::make_unique<Film>(options.out, width, height, fps);
    case OutputKind::kPicture:
      return std::make_unique<OnePicture>(options.out);
    case OutputKind::kFolder:
      break;
  }
  return std::make_unique<Folder>(options.out);
}

}  // namespace livecap::render

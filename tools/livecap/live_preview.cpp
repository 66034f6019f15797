#include "live_preview.h"

#include <exception>

#include "base/log.h"
#include "image/video_window.h"
#include "picture/overlay.h"

namespace livecap::tools {

LivePreview::LivePreview(const LiveActor& actor, const Camera& camera, const std::string& title)
    : actor_(load_actor_bytes(actor.glb, "actor")), undistorter_(camera), camera_(undistorter_.undistorted_camera()) {
  std::promise<void> opened;  // of the thread, which may still be leaving it when the answer is here
  std::future<void> answer = opened.get_future();
  thread_ = std::thread([this, title, opened = std::move(opened)]() mutable { run(title, std::move(opened)); });
  try {
    answer.get();
  } catch (...) {
    thread_.join();
    throw;
  }
}

LivePreview::~LivePreview() {
  to_show_.abort();
  thread_.join();
}

void LivePreview::expect(int64_t index, const ImageRgb& image) {
  std::lock_guard lock(mutex_);
  expected_.emplace_back(index, image);
}

void LivePreview::show(const LiveResult& result) {
  Shown shown;
  {
    std::lock_guard lock(mutex_);
    while (!expected_.empty() && expected_.front().first < result.report.index) expected_.pop_front();
    if (expected_.empty() || expected_.front().first != result.report.index) return;
    shown.image = std::move(expected_.front().second);
    expected_.pop_front();
  }
  if (result.report.status == TrackStatus::kDropped) return;
  shown.vertices_mm.reserve(result.vertices_m.size());
  for (size_t i = 0; i < result.vertices_m.size(); ++i)  // of glTF: y down, z away from the camera
    shown.vertices_mm.push_back((i % 3 == 0 ? 1000 : -1000) * result.vertices_m[i]);
  (void)to_show_.push_newest(std::move(shown), [](Shown&, Shown&&) {});
}

ImageRgb LivePreview::drawn(Shown shown) const {
  ImageRgb image = undistorter_.undistort(std::move(shown.image));
  return shown.vertices_mm.empty() ? image : render_overlay(actor_, shown.vertices_mm, camera_, image);
}

void LivePreview::run(const std::string& title, std::promise<void> opened) {
  std::unique_ptr<VideoWindow> window;
  try {
    window = std::make_unique<VideoWindow>(title, camera_.width, camera_.height);
  } catch (...) {
    opened.set_exception(std::current_exception());
    return;
  }
  opened.set_value();
  try {
    while (std::optional<Shown> next = to_show_.pop())
      if (!window->show(drawn(std::move(*next)))) break;
  } catch (const std::exception& error) {
    log_warning(std::string("the window is gone: ") + error.what());
  }
  closed_ = true;
}

}  // namespace livecap::tools

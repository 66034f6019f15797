// Links the whole library through its public headers and sees it answer: what is missing is refused by name.
#include <livecap/capture.h>
#include <livecap/error.h>
#include <livecap/live.h>

#include <cstdio>
#include <string>

// 0 when `act` is refused by a message that names what is missing.
template <typename Act>
int refused(Act&& act) {
  try {
    act();
  } catch (const livecap::Error& error) {
    std::printf("refused: %s\n", error.what());
    return std::string(error.what()).find("no_such_") == std::string::npos;
  }
  return 1;
}

int main() {
  livecap::CaptureOptions options;
  options.video = "no_such_video.mp4";
  options.camera = "no_such_camera.json";
  options.actor = "no_such_actor.glb";
  options.out = "consumer_out";
  livecap::LiveOptions live;
  live.camera = livecap::camera_from_fov(640, 480, 60);
  live.actor = "no_such_actor.glb";
  return refused([&] { livecap::run_capture(options); }) +
         refused([&] { livecap::LiveCapture(live, [](const livecap::LiveResult&) { return true; }); });
}

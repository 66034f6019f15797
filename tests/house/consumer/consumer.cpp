// Links the whole library through its public header and sees it answer: a missing input is refused by name.
#include <livecap/capture.h>
#include <livecap/error.h>

#include <cstdio>
#include <string>

int main() {
  livecap::CaptureOptions options;
  options.video = "no_such_video.mp4";
  options.camera = "no_such_camera.json";
  options.actor = "no_such_actor.glb";
  options.out = "consumer_out";
  try {
    livecap::run_capture(options);
  } catch (const livecap::Error& error) {
    std::printf("refused: %s\n", error.what());
    return std::string(error.what()).find("no_such_") == std::string::npos;
  }
  return 1;
}

// Without a desktop: SDL's own "dummy" driver opens windows that nobody sees.
#include "image/video_window.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "livecap/error.h"

namespace livecap {
namespace {

constexpr int kWidth = 61, kHeight = 34;

ImageRgb grey(int width, int height) {
  return {width, height, std::vector<uint8_t>(size_t(3) * width * height, 128)};
}

TEST(VideoWindow, ShowsPictures) {
  setenv("SDL_VIDEODRIVER", "dummy", 1);
  VideoWindow window("test", kWidth, kHeight);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(window.show(grey(kWidth, kHeight)));
  EXPECT_THROW((void)window.show(grey(kHeight, kWidth)), LogicError);
}

TEST(VideoWindow, AnotherOneOpensAfterTheFirst) {
  setenv("SDL_VIDEODRIVER", "dummy", 1);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(VideoWindow("test", kWidth, kHeight).show(grey(kWidth, kHeight)));
}

// In a process of its own, since SDL keeps the driver that it chose first.
void refused(const char* driver) {
  if (driver) {
    setenv("SDL_VIDEODRIVER", driver, 1);
  } else {
    unsetenv("SDL_VIDEODRIVER");
  }
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(name);
  try {
    VideoWindow window("test", kWidth, kHeight);
  } catch (const ConfigError& error) {
    std::fputs(error.what(), stderr);
    std::exit(2);
  }
  std::exit(0);
}

TEST(VideoWindow, WithoutADesktopIsRefused) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const char* driver : {"x11", static_cast<const char*>(nullptr)})
    EXPECT_EXIT(refused(driver), testing::ExitedWithCode(2), "no window.*DISPLAY");
}

}  // namespace
}  // namespace livecap

// Without a desktop: SDL's own "dummy" driver opens windows that nobody sees.
#include "image/video_window.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "livecap/error.h"

namespace livecap {
namespace {

constexpr int kWindowWidth = 61, kWindowHeight = 34;

ImageRgb grey(int width, int height) {
  return {width, height, std::vector<uint8_t>(size_t(3) * width * height, 128)};
}

// Why this build opens no window anywhere; empty where it can. Asked without a desktop, so that SDL chooses no driver.
std::string unsupported() {
  setenv("SDL_VIDEODRIVER", "x11", 1);
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(name);
  try {
    VideoWindow window("test", kWindowWidth, kWindowHeight);
  } catch (const ConfigError& error) {
    const std::string why = error.what();
    for (const char* missing : {"is missing or cannot be loaded; install libavdevice", "this FFmpeg has no SDL"})
      if (why.find(missing) != std::string::npos) return why;
  }
  return {};
}

TEST(VideoWindow, ShowsPictures) {
  if (const std::string why = unsupported(); !why.empty()) GTEST_SKIP() << "skipped: " << why;
  setenv("SDL_VIDEODRIVER", "dummy", 1);
  VideoWindow window("test", kWindowWidth, kWindowHeight);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(window.show(grey(kWindowWidth, kWindowHeight)));
  EXPECT_THROW((void)window.show(grey(kWindowHeight, kWindowWidth)), LogicError);
}

TEST(VideoWindow, AnotherOneOpensAfterTheFirst) {
  if (const std::string why = unsupported(); !why.empty()) GTEST_SKIP() << "skipped: " << why;
  setenv("SDL_VIDEODRIVER", "dummy", 1);
  for (int i = 0; i < 2; ++i)
    EXPECT_TRUE(VideoWindow("test", kWindowWidth, kWindowHeight).show(grey(kWindowWidth, kWindowHeight)));
}

// In a process of its own, since SDL keeps the driver that it chose first.
void refused(const char* driver) {
  if (driver) {
    setenv("SDL_VIDEODRIVER", driver, 1);
  } else {
    unsetenv("SDL_VIDEODRIVER");
  }
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(name);
  choose_window_driver();
  try {
    VideoWindow window("test", kWindowWidth, kWindowHeight);
  } catch (const ConfigError& error) {
    std::fputs(error.what(), stderr);
    std::exit(2);
  }
  std::exit(0);
}

TEST(VideoWindow, WithoutADesktopIsRefused) {
  if (const std::string why = unsupported(); !why.empty()) GTEST_SKIP() << "skipped: " << why;
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const char* driver : {"x11", static_cast<const char*>(nullptr)})
    EXPECT_EXIT(refused(driver), testing::ExitedWithCode(2), "no window.*DISPLAY");
}

// Other threads may read the environment while a window opens.
TEST(VideoWindow, TheEnvironmentIsTheProgramsToChange) {
  if (const std::string why = unsupported(); !why.empty()) GTEST_SKIP() << "skipped: " << why;
  setenv("SDL_VIDEODRIVER", "dummy", 1);
  VideoWindow first("test", kWindowWidth, kWindowHeight);  // SDL keeps its driver
  unsetenv("SDL_VIDEODRIVER");
  VideoWindow window("test", kWindowWidth, kWindowHeight);
  EXPECT_EQ(std::getenv("SDL_VIDEODRIVER"), nullptr);
  setenv("WAYLAND_DISPLAY", "wayland-0", 1);
  choose_window_driver();
  EXPECT_STREQ(std::getenv("SDL_VIDEODRIVER"), "wayland,x11");
  unsetenv("WAYLAND_DISPLAY");
  setenv("SDL_VIDEODRIVER", "dummy", 1);
  choose_window_driver();
  EXPECT_STREQ(std::getenv("SDL_VIDEODRIVER"), "dummy") << "the user's";
}

}  // namespace
}  // namespace livecap

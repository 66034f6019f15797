#include "image/av_devices.h"

#include <dlfcn.h>

extern "C" {
#include <libavformat/version.h>
#include <libavutil/macros.h>
}

#include "livecap/error.h"

namespace livecap {
namespace {

// Both libraries of a release of FFmpeg have the same major number.
#ifdef __APPLE__
constexpr char kLibrary[] = "libavdevice." AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR) ".dylib";
#else
constexpr char kLibrary[] = "libavdevice.so." AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR);
#endif

}  // namespace

void register_av_devices(const std::string& who) {
  static void* const library = dlopen(kLibrary, RTLD_NOW);  // never closed: FFmpeg keeps pointers into it
  void* const call = library ? dlsym(library, "avdevice_register_all") : nullptr;
  if (!call) throw ConfigError(who + ": " + kLibrary + " is missing or cannot be loaded; install libavdevice");
  reinterpret_cast<void (*)()>(call)();
}

}  // namespace livecap

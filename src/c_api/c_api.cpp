// livecap/livecap.h over livecap/live.h: structs of C to structs of C++ and back, exceptions to codes and lines.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "livecap/camera.h"
#include "livecap/error.h"
#include "livecap/live.h"
#include "livecap/livecap.h"
#include "livecap/log.h"

using namespace livecap;

namespace {

static_assert(LIVECAP_BGRA == static_cast<int>(PixelFormat::kBgra));
static_assert(LIVECAP_TRACK_DROPPED == static_cast<int>(TrackStatus::kDropped));
static_assert(LIVECAP_LOG_DEBUG == static_cast<int>(LogLevel::kDebug));

// The size of livecap_options in the first version that had it. Members that came later follow its last one.
constexpr uint32_t kFirstOptionsSize = offsetof(livecap_options, camera) + sizeof(livecap_camera);

thread_local char t_last_error[4096] = "";  // no std::string: saying so must not fail

livecap_error failed(livecap_error error, const char* message) noexcept {
  std::snprintf(t_last_error, sizeof t_last_error, "%s", message);
  return error;
}

// Messages of the library name options of the program; here they are fields and arguments, of other units in part.
std::string in_names_of_c(const std::string& message) {
  double height_m = 0, least_m = 0, most_m = 0;
  if (std::sscanf(message.c_str(), "--height %lf m: must be between %lf and %lf metres", &height_m, &least_m,
                  &most_m) == 3) {
    char line[128];
    std::snprintf(line, sizeof line, "height_mm %g: must be %g to %g", 1000 * height_m, 1000 * least_m, 1000 * most_m);
    return line;
  }
  for (const auto& [option, field] : {std::pair{std::string_view("--actor "), "actor "},
                                      {"--rigidity ", "rigidity "},
                                      {"--without ", "without "},
                                      {"--fov ", "fov_deg "}})
    if (message.starts_with(option)) return field + message.substr(option.size());
  return message;
}

// What act() returns, or what it throws as a code.
template <typename Act>
livecap_error guarded(Act&& act) noexcept {
  try {
    return act();
  } catch (const ConfigError& error) {
    return failed(LIVECAP_CONFIG_ERROR, in_names_of_c(error.what()).c_str());
  } catch (const IoError& error) {
    return failed(LIVECAP_IO_ERROR, error.what());
  } catch (const OclError& error) {
    return failed(LIVECAP_OCL_ERROR, error.what());
  } catch (const std::bad_alloc&) {
    return failed(LIVECAP_LOGIC_ERROR, "there is not enough memory");
  } catch (const std::exception& error) {
    return failed(LIVECAP_LOGIC_ERROR, error.what());
  } catch (...) {
    return failed(LIVECAP_LOGIC_ERROR, "something was thrown that is no std::exception");
  }
}

// Throws ConfigError naming the function and its argument.
template <typename T>
T& given(T* pointer, const char* argument) {
  if (!pointer) throw ConfigError(std::string(argument) + " is NULL");
  return *pointer;
}

std::string text(const char* given, const char* otherwise = "") {
  return given ? given : otherwise;
}

Camera camera_from_c(const livecap_camera& c) {
  Camera camera{c.width, c.height, c.fx, c.fy, c.cx, c.cy};
  std::copy_n(c.distortion, 5, camera.distortion.begin());
  if (c.floor_distance_mm != 0)
    camera.floor = FloorPlane{{c.floor_normal[0], c.floor_normal[1], c.floor_normal[2]}, c.floor_distance_mm};
  return camera;
}

livecap_camera c_from_camera(const Camera& camera) {
  livecap_camera c{camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, {}, {}, 0};
  std::copy_n(camera.distortion.begin(), 5, c.distortion);
  if (camera.floor) {
    std::copy_n(camera.floor->normal.begin(), 3, c.floor_normal);
    c.floor_distance_mm = camera.floor->distance_mm;
  }
  return c;
}

Picture picture_from_c(const livecap_picture& c) {
  return {c.pixels, c.width, c.height, static_cast<std::ptrdiff_t>(c.row_bytes), static_cast<PixelFormat>(c.format),
          c.time_s};
}

// Of a list with commas; spaces around a name and empty names do not count.
std::vector<std::string> names_of(const std::string& list) {
  constexpr char kSpaces[] = " \t\r\n";
  std::vector<std::string> names;
  std::istringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    const size_t begin = part.find_first_not_of(kSpaces);
    if (begin != std::string::npos) names.push_back(part.substr(begin, part.find_last_not_of(kSpaces) + 1 - begin));
  }
  return names;
}

LiveOptions options_from_c(const livecap_options& c) {
  LiveOptions options;
  options.every_picture = c.every_picture != 0;
  options.actor = text(c.actor);
  options.height_mm = c.height_mm;
  options.model = text(c.model, "full");
  options.surface = c.no_surface == 0;
  if (c.n_background < 0 || (c.n_background > 0 && !c.background))
    throw ConfigError("livecap_options: n_background is " + std::to_string(c.n_background) + " but background is " +
                      (c.background ? "not NULL; it must not be negative" : "NULL"));
  for (int i = 0; i < c.n_background; ++i) options.background.push_back(picture_from_c(c.background[i]));
  options.without = names_of(text(c.without));
  options.rigidity = c.rigidity;
  options.cnn_device = text(c.cnn_device);
  options.solver_device = text(c.solver_device);
  options.camera = camera_from_c(c.camera);
  return options;
}

// The options of a program that was built with this header or an older one. Throws ConfigError.
livecap_options options_of_any_version(const livecap_options& given) {
  livecap_options options;
  livecap_options_init(&options);
  if (given.struct_size < kFirstOptionsSize || given.struct_size > sizeof options)
    throw ConfigError("livecap_options: struct_size is " + std::to_string(given.struct_size) + ", but it has " +
                      std::to_string(sizeof options) +
                      " bytes in livecap " LIVECAP_VERSION
                      "; livecap_options_init() sets it, and the header must not be newer than the library");
  std::memcpy(&options, &given, given.struct_size);
  return options;
}

// A result and what it points to.
struct Result {
  explicit Result(LiveResult result) : live(std::move(result)) {
    const FrameReport& report = live.report;
    c.index = report.index;
    c.time_s = report.pts_ms / 1000;
    c.status = static_cast<int32_t>(report.status);
    c.score = report.score;
    c.iou = report.iou;
    c.latency_ms = report.latency_ms;
    if (!is_tracked(report.status)) return;
    for (const auto& [p, q] : live.bones) bones.push_back({{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}});
    c.is_tracked = 1;
    c.bones = bones.data();
    c.angles_rad = live.angles_rad.data();
    c.vertices_m = live.vertices_m.data();
  }
  Result(const Result&) = delete;
  Result& operator=(const Result&) = delete;

  LiveResult live;
  std::vector<livecap_bone_pose> bones;
  livecap_result c{};
};

// The actor's description and what it points to; the rest of that belongs to `live`.
struct ActorView {
  explicit ActorView(const LiveActor& live) {
    for (const LiveBone& bone : live.bones) {
      const auto& [x, y, z] = bone.offset_m;
      bones.push_back({bone.name.c_str(), {x, y, z}, bone.parent});
    }
    for (const std::string& angle : live.angles) angles.push_back(angle.c_str());
    c.n_bones = static_cast<int32_t>(bones.size());
    c.n_angles = static_cast<int32_t>(angles.size());
    c.n_vertices = live.n_vertices;
    c.n_triangles = static_cast<int32_t>(live.triangles.size() / 3);
    c.n_drawn = static_cast<int32_t>(live.drawn_vertex.size());
    c.bones = bones.data();
    c.angles = angles.data();
    c.triangles = live.triangles.data();
    c.drawn_vertex = live.drawn_vertex.data();
    c.drawn_uv = live.drawn_uv.data();
    c.drawn_triangles = live.drawn_triangles.data();
    c.glb = reinterpret_cast<const uint8_t*>(live.glb.data());
    c.glb_bytes = live.glb.size();
  }
  ActorView(const ActorView&) = delete;
  ActorView& operator=(const ActorView&) = delete;

  std::vector<livecap_bone> bones;
  std::vector<const char*> angles;
  livecap_actor c{};
};

}  // namespace

struct livecap_capture {
  livecap_capture(const LiveOptions& options, livecap_callback callback, void* callbacks_user)
      : on_result(callback),
        user(callbacks_user),
        live(options,
             [this](const LiveResult& result) {
               hear(result);
               return true;
             }),
        actor(live.actor()) {}

  // Of the library's thread.
  void hear(const LiveResult& heard) {
    auto result = std::make_unique<Result>(heard);
    if (on_result) on_result(&result->c, user);
    if (result->c.status == LIVECAP_TRACK_DROPPED) return;
    const std::lock_guard lock(mutex);
    newest = std::move(result);
  }

  const livecap_result* poll() {
    const std::lock_guard lock(mutex);
    if (!newest) return nullptr;
    polled = std::move(newest);
    return &polled->c;
  }

  livecap_callback on_result;
  void* user;
  std::mutex mutex;
  std::unique_ptr<Result> newest;  // that nobody has polled
  std::unique_ptr<Result> polled;
  LiveCapture live;  // its thread ends before what it writes to
  ActorView actor;
};

const char* livecap_last_error(void) {
  return t_last_error;
}

const char* livecap_version(void) {
  return LIVECAP_VERSION;
}

livecap_error livecap_camera_from_fov(int32_t width, int32_t height, double fov_deg, livecap_camera* camera) {
  return guarded([&] {
    livecap_camera& c = given(camera, "livecap_camera_from_fov: camera");
    c = c_from_camera(camera_from_fov(width, height, fov_deg));
    return LIVECAP_OK;
  });
}

livecap_error livecap_load_camera(const char* path, livecap_camera* camera) {
  return guarded([&] {
    livecap_camera& c = given(camera, "livecap_load_camera: camera");
    c = c_from_camera(load_camera(&given(path, "livecap_load_camera: path")));
    return LIVECAP_OK;
  });
}

livecap_error livecap_open(const livecap_options* options, livecap_capture** capture) {
  return guarded([&] {
    livecap_capture*& opened = given(capture, "livecap_open: capture");
    opened = nullptr;
    const livecap_options c = options_of_any_version(given(options, "livecap_open: options"));
    opened = new livecap_capture(options_from_c(c), c.on_result, c.user);
    return LIVECAP_OK;
  });
}

const livecap_actor* livecap_get_actor(const livecap_capture* capture) {
  const livecap_actor* actor = nullptr;
  guarded([&] {
    actor = &given(capture, "livecap_get_actor: capture").actor.c;
    return LIVECAP_OK;
  });
  return actor;
}

livecap_error livecap_push(livecap_capture* capture, const livecap_picture* picture) {
  return guarded([&] {
    livecap_capture& c = given(capture, "livecap_push: capture");
    if (c.live.push(picture_from_c(given(picture, "livecap_push: picture")))) return LIVECAP_OK;
    return failed(LIVECAP_ENDED, "livecap_push: the capture has ended; livecap_close() says whether by an error");
  });
}

const livecap_result* livecap_poll(livecap_capture* capture) {
  const livecap_result* result = nullptr;
  guarded([&] {
    result = given(capture, "livecap_poll: capture").poll();
    return LIVECAP_OK;
  });
  return result;
}

livecap_error livecap_close(livecap_capture* capture) {
  return guarded([&] {
    given(capture, "livecap_close: capture").live.close();
    return LIVECAP_OK;
  });
}

void livecap_free(livecap_capture* capture) {
  delete capture;
}

void livecap_set_log(int32_t level, livecap_log log, void* user) {
  guarded([&] {
    set_log_level(static_cast<LogLevel>(std::clamp<int32_t>(level, LIVECAP_LOG_ERROR, LIVECAP_LOG_DEBUG)));
    set_log_sink(log ? LogSink([log, user](LogLevel of, const std::string& line) {
      log(static_cast<int32_t>(of), line.c_str(), user);
    })
                     : LogSink());
    return LIVECAP_OK;
  });
}

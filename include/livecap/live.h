// Performance capture of pictures as they come, with every result in memory: for programs that have a camera of their
// own and want to draw, stream or measure the person.
//
//   livecap::LiveOptions options;
//   options.camera = livecap::camera_from_fov(1280, 720, 70);
//   options.actor = "builtin:trousers";
//   livecap::LiveCapture live(options, [&](const livecap::LiveResult& result) {
//     if (livecap::is_tracked(result.report.status)) draw(result.vertices_m);
//     return true;
//   });
//   while (grab(frame) && live.push({.pixels = frame.data, .width = 1280, .height = 720, .time_s = frame.time})) {
//   }
//   live.close();  // throws what went wrong
//
// Everything that leaves is in the frame of the written files: metres, glTF axes (x right, y up, z towards the viewer),
// the camera at the origin, which looks along -z.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "livecap/camera.h"
#include "livecap/capture.h"
#include "livecap/method.h"

namespace livecap {

enum class PixelFormat { kRgb, kBgr, kRgba, kBgra };

// 8 bits a channel, sRGB. The caller's memory: read during the call that it is given
// to alone.
struct Picture {
  const uint8_t* pixels = nullptr;  // of the topmost row
  int width = 0;                    // px
  int height = 0;                   // px
  // From one row to the one below it, negative where memory has the lowest first; 0: they are packed, topmost first.
  std::ptrdiff_t row_bytes = 0;
  PixelFormat format = PixelFormat::kRgb;
  double time_s = 0;  // when it was taken, on any clock; later than the picture before
};

struct LiveOptions : MethodOptions {
  Camera camera;                    // with its distortion, if any: pictures are undistorted
  std::vector<Picture> background;  // of the empty scene; none: the network's own person mask
  // False: a picture that nobody has begun with when the next one comes is dropped, as a camera needs it. True: push()
  // waits instead, so that no picture is, and the same pictures give the same results as a file does.
  bool every_picture = false;

  // Throws ConfigError.
  void validate() const;
};

struct LiveBone {
  std::string name;  // "left_elbow"; the bone that turns there
  int parent = -1;   // index of its parent, which comes before it; -1: the root
  // From its parent's origin, all angles zero (T-pose, y up, the person looks along z).
  std::array<float, 3> offset_m = {};
};

// What does not change while somebody is captured.
struct LiveActor {
  std::vector<LiveBone> bones;
  std::vector<std::string> angles;       // "left_shoulder_z"
  int n_vertices = 0;                    // of the template: vertices that a file repeats along seams are one
  std::vector<int32_t> triangles;        // [3*n_triangles] of vertices, counter-clockwise seen from outside
  std::vector<int32_t> drawn_vertex;     // [n_drawn] the vertex of each one that the file draws
  std::vector<float> drawn_uv;           // [2*n_drawn] texture coordinates, v down
  std::vector<int32_t> drawn_triangles;  // [3*n_triangles] of drawn ones
  std::string glb;                       // the actor's file, with its texture; one that height_mm scales as it was
};

struct LiveBonePose {
  std::array<float, 3> position_m = {};  // of its origin
  // x, y, z, w: from the bone's frame to its parent's; the root's: to glTF.
  std::array<float, 4> rotation = {0, 0, 0, 1};
};

// One for each picture that was pushed, in their order; report.index counts them from 0, report.pts_ms is their time,
// report.latency_ms runs from push() until on_result is called (0 for one that was dropped).
struct LiveResult {
  FrameReport report;
  // Empty unless is_tracked(report.status).
  std::vector<LiveBonePose> bones;
  std::vector<float> angles_rad;
  std::vector<float> vertices_m;  // [3*n_vertices]
};

// Called by a thread of the library. False ends the capture.
using LiveCallback = std::function<bool(const LiveResult&)>;

// A result comes when two later pictures have been captured as well, since a pose waits for the next two (without
// "fixed_lag" it does not), or at close(): the last two wait while no more come.
//
// Threads: push() and close() belong to one thread at a time, on_result is called by another. close() and the
// destructor wait for it, so it must not wait for what the closing thread holds.
class LiveCapture {
 public:
  // Opens the devices, builds and warms up every kernel: seconds, at the first time on a machine up to a minute. Throws
  // ConfigError, IoError (bad options or actor), OclError (no device, a failed call).
  LiveCapture(const LiveOptions& options, LiveCallback on_result);
  // Without close(): results that are under way are not delivered; an error is logged. Not from on_result.
  ~LiveCapture();
  LiveCapture(const LiveCapture&) = delete;
  LiveCapture& operator=(const LiveCapture&) = delete;

  const LiveActor& actor() const;

  // Copies the picture; waits only where every_picture asks for it. False when the capture has ended: by on_result, by
  // close(), or by an error, which close() throws; whatever the picture. Throws ConfigError for a picture of another
  // size than the camera's, without pixels, with rows that are too short, of an unknown format, or of a time that is
  // not finite and later than the one before; LogicError from on_result.
  [[nodiscard]] bool push(const Picture& picture);

  // Waits until every picture has its result, then ends. Throws what went wrong on the way (OclError, or whatever
  // on_result threw), LogicError from on_result. Further calls do nothing.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace livecap

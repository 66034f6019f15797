// Performance capture of pictures as they come, for C and whatever calls C: engines, Python, Rust. It is livecap/live.h
// as the shared library liblivecap.so; docs/embedding.md has examples.
//
//   livecap_options options;
//   livecap_options_init(&options);
//   options.actor = "builtin:trousers";
//   livecap_capture* capture = NULL;
//   if (livecap_camera_from_fov(1280, 720, 70, &options.camera) || livecap_open(&options, &capture))
//     return complain(livecap_last_error());
//   while (grab(&picture) && livecap_push(capture, &picture) == LIVECAP_OK) {
//     const livecap_result* result = livecap_poll(capture);
//     if (result && result->vertices_m) draw(result->vertices_m);
//   }
//   if (livecap_close(capture)) complain(livecap_last_error());
//   livecap_free(capture);
//
// Whatever leaves is in metres and glTF axes (x right, y up, z towards the viewer), the camera at the origin, which
// looks along -z. Whatever is given is read during the call alone, but for on_result and user.
//
// Threads: of one capture, livecap_push and livecap_close belong to one thread at a time, livecap_poll to one at a time
// which may be another, livecap_free to the last. Captures know nothing of each other.
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum livecap_error {
  LIVECAP_OK = 0,
  LIVECAP_ENDED = 1,         // the capture takes no more pictures
  LIVECAP_CONFIG_ERROR = 2,  // an option or argument that is wrong or does not go with another
  LIVECAP_IO_ERROR = 3,      // a file that is missing, broken or of the wrong size
  LIVECAP_OCL_ERROR = 4,     // no OpenCL device, or a call to it that failed
  LIVECAP_LOGIC_ERROR = 5    // a call from on_result that would wait for itself, no memory, or a bug
} livecap_error;

// One line: what failed, where, which value, what would be right. Of the last call of this thread that failed, until
// the next one does; "" when none has.
const char* livecap_last_error(void);

// "0.1.0", of the library.
const char* livecap_version(void);

// A static pinhole camera in OpenCV's conventions: x right, y down, z forward, pixel centres at integer coordinates.
typedef struct livecap_camera {
  int32_t width;   // px, of every picture
  int32_t height;  // px
  double fx;       // px
  double fy;
  double cx;
  double cy;
  double distortion[5];      // k1, k2, p1, p2, k3: pictures are undistorted
  double floor_normal[3];    // of the floor that the person stands on: unit, up
  double floor_distance_mm;  // how far the camera is above it; 0: nobody has measured it
} livecap_camera;

// Without distortion, from the field of view of the longer side, in degrees.
livecap_error livecap_camera_from_fov(int32_t width, int32_t height, double fov_deg, livecap_camera* camera);

// Reads a camera.json.
livecap_error livecap_load_camera(const char* path, livecap_camera* camera);

typedef enum livecap_pixel_format {
  LIVECAP_RGB = 0,
  LIVECAP_BGR = 1,
  LIVECAP_RGBA = 2,
  LIVECAP_BGRA = 3
} livecap_pixel_format;

// 8 bits a channel, sRGB.
typedef struct livecap_picture {
  const uint8_t* pixels;  // of the topmost row
  // From one row to the one below it, negative where memory has the lowest first; 0: they are packed, topmost first.
  int64_t row_bytes;
  double time_s;   // when it was taken, on any clock; later than the picture before
  int32_t width;   // px
  int32_t height;  // px
  int32_t format;  // livecap_pixel_format
} livecap_picture;

// What happened in a picture.
typedef enum livecap_track_status {
  LIVECAP_TRACK_OK = 0,
  LIVECAP_TRACK_INITIALIZED = 1,  // tracked, for the first time or after a loss
  LIVECAP_TRACK_NOBODY = 2,       // nobody is seen
  LIVECAP_TRACK_LOST = 3,         // somebody is there but the pose could not be solved
  LIVECAP_TRACK_DAMAGED = 4,      // of videos alone: never here
  LIVECAP_TRACK_DROPPED = 5       // a newer picture was there before anybody had begun with this one
} livecap_track_status;

typedef struct livecap_bone_pose {
  float position_m[3];  // of its origin
  float rotation[4];    // x, y, z, w: from the bone's frame to its parent's; the root's: to glTF
} livecap_bone_pose;

// What was captured in one picture. Later versions may have more at the end.
typedef struct livecap_result {
  int64_t index;                   // of the picture, from 0 in the order they were pushed
  double time_s;                   // of the picture
  int32_t status;                  // livecap_track_status
  int32_t is_tracked;              // 1 where there are bones, angles and vertices, else 0 and these are NULL
  const livecap_bone_pose* bones;  // [n_bones]
  const float* angles_rad;         // [n_angles]
  const float* vertices_m;         // [3*n_vertices]
  double score;                    // network's probability of a person, 0 to 1
  double iou;                      // rendered mesh against the segmented silhouette, 0 to 1
  double latency_ms;               // from livecap_push until it was there
} livecap_result;

typedef struct livecap_bone {
  const char* name;   // "left_elbow"; the bone that turns there
  float offset_m[3];  // from its parent's origin, all angles zero (T-pose, y up, the person looks along z)
  int32_t parent;     // index of its parent, which comes before it; -1: the root
} livecap_bone;

// What does not change while somebody is captured. Later versions may have more at the end.
typedef struct livecap_actor {
  int32_t n_bones;
  int32_t n_angles;
  int32_t n_vertices;  // of the template: vertices that a file repeats along seams are one
  int32_t n_triangles;
  int32_t n_drawn;                 // vertices as the file draws them
  const livecap_bone* bones;       // [n_bones]
  const char* const* angles;       // [n_angles] "left_shoulder_z"
  const int32_t* triangles;        // [3*n_triangles] of vertices, counter-clockwise seen from outside
  const int32_t* drawn_vertex;     // [n_drawn] the vertex of each drawn one
  const float* drawn_uv;           // [2*n_drawn] texture coordinates, v down
  const int32_t* drawn_triangles;  // [3*n_triangles] of drawn ones
  const uint8_t* glb;  // [glb_bytes] the actor's file, with its texture; one that height_mm scales as it was
  size_t glb_bytes;
} livecap_actor;

// Called by a thread of the library with the result of every picture, in order. *result and what it points to last
// until it returns. It must not call livecap_free, and livecap_push and livecap_close refuse to be called from it.
typedef void (*livecap_callback)(const livecap_result* result, void* user);

// All zero is the default of each, but for struct_size. An actor and a camera are needed.
typedef struct livecap_options {
  uint32_t struct_size;  // sizeof(livecap_options), so that a library of another version knows what was meant
  // 0: a picture that nobody has begun with when the next one comes is dropped, as a camera needs it. 1: livecap_push
  // waits instead, so that no picture is, and the same pictures give the same results as their file does.
  int32_t every_picture;
  const char* actor;                  // actor.glb or "builtin:skirt", "builtin:trousers"
  double height_mm;                   // > 0: the actor is scaled to this height
  const char* model;                  // lite, full (NULL), heavy or the path of a .tflite file
  int32_t no_surface;                 // 1: the pose alone moves the vertices
  int32_t n_background;               // pictures of the empty scene; 0: the network's own person mask
  const livecap_picture* background;  // [n_background]
  const char* without;                // what is switched off: names of docs/conventions.md, commas between them
  double rigidity;                    // > 0: material weight of the whole surface, instead of each label's
  const char* cnn_device;             // selectors of docs/conventions.md; NULL: chosen
  const char* solver_device;
  livecap_callback on_result;  // NULL: results are polled
  void* user;                  // handed to on_result
  livecap_camera camera;
} livecap_options;

static inline void livecap_options_init(livecap_options* options) {
  memset(options, 0, sizeof *options);
  options->struct_size = sizeof *options;
}

typedef struct livecap_capture livecap_capture;

// Opens the devices, builds and warms up every kernel: seconds, at the first time on a machine up to a minute. *capture
// is NULL when it fails.
livecap_error livecap_open(const livecap_options* options, livecap_capture** capture);

// Valid until livecap_free. NULL when capture is.
const livecap_actor* livecap_get_actor(const livecap_capture* capture);

// Copies the picture; waits only where every_picture asks for it. LIVECAP_ENDED after livecap_close or after an error,
// which livecap_close returns. LIVECAP_CONFIG_ERROR for a picture of another size than the camera's, without pixels,
// with rows that are too short, of an unknown format, or of a time that is not later than the one before: it has no
// result, and the next one may follow.
livecap_error livecap_push(livecap_capture* capture, const livecap_picture* picture);

// The newest result of a picture that was not dropped. NULL when there is none that an earlier call has not returned:
// it never waits. *result and what it points to last until the next call or livecap_free. A result comes when two later
// pictures have been captured as well, since a pose waits for the next two (without "fixed_lag" it does not), or at
// livecap_close.
const livecap_result* livecap_poll(livecap_capture* capture);

// Waits until every picture has its result, the last of which can then be polled, and ends. Returns what went wrong on
// the way. Further calls do nothing.
livecap_error livecap_close(livecap_capture* capture);

// Without livecap_close: results that are under way are not delivered. NULL is allowed.
void livecap_free(livecap_capture* capture);

typedef enum livecap_log_level {
  LIVECAP_LOG_ERROR = 0,
  LIVECAP_LOG_WARNING = 1,  // the default
  LIVECAP_LOG_INFO = 2,
  LIVECAP_LOG_DEBUG = 3
} livecap_log_level;

// Called with each line of the level or below, by whichever thread has something to say, one at a time. It must call
// nothing of the library.
typedef void (*livecap_log)(int32_t level, const char* line, void* user);

// Of all captures. log: NULL is standard error; once this has returned the one before is not called any more.
void livecap_set_log(int32_t level, livecap_log log, void* user);

#ifdef __cplusplus
}
#endif

// A capture folder (docs/formats.md) opened for comparing: what it says about itself and the files it names.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "actor/actor.h"
#include "base/require_apart.h"
#include "eval/sequence_files.h"
#include "export/pc2.h"
#include "livecap/camera.h"

namespace livecap {

// Speed as report.json and frames.csv tell it; NaN where they do not.
struct CaptureSpeed {
  double fps = 0;
  double latency_ms = 0;      // median
  double latency_p95_ms = 0;  // of the tracked frames
};

struct CaptureFolder {
  std::filesystem::path path;
  Actor actor;
  Camera camera;        // of the video as it came, with its distortion; its floor is the one that was given
  double fps = 0;       // of the video, from the time stamps of the rows; 30 when they do not tell
  std::string video;    // empty: not known
  int64_t first = 0;    // frame of the video that the capture began at
  int64_t frames = -1;  // the most it was asked for; -1: all
  std::string run;      // the options that differ from the defaults, for titles; empty: none
  CaptureSpeed speed;
  std::optional<FloorPlane> floor;  // that the capture had at its end; nullopt: none, or no report.json tells
  std::vector<FrameRow> rows;
  JointTrack joints;
  AngleTrack angles;                  // empty: no angles.csv
  std::optional<Pc2Reader> vertices;  // none: a skeleton only
};

// An actor file or builtin:NAME; height_mm > 0 scales it.
Actor load_actor_named(const std::string& name, double height_mm);

// A folder of another program needs joints.csv alone: without report.json both actor and camera have to be given or lie
// in the folder, where a run that was killed leaves them; without frames.csv the frames are those of joints.csv.
//
// actor, camera: empty = what report.json names. An actor that is not there any more is read from the folder's own
// copy, and for a capture that was given a field of view only the folder knows the camera; where it does not, the masks
// in `masks` give the size. Throws IoError naming the file when the folder does not hold what is needed, sizes do not
// fit together, or the report's floor is none that can be.
CaptureFolder open_capture(const std::filesystem::path& folder, const std::string& actor, const std::string& camera,
                           const std::filesystem::path& masks);

// What to do when report.json does not say which actor, camera or video it was, or is not there.
std::string not_named(const std::filesystem::path& report_path, const std::string& what);

// The camera.json in the folder itself, whose frame everything in it is in: that of the video without distortion.
// Empty: an older capture has none.
std::string own_camera_file(const std::filesystem::path& folder);

// What a capture is and was made from, for require_apart(): the files of the folder, read or not, and those that its
// report.json names. Nothing of a folder that is none.
std::vector<InputFile> capture_inputs(const std::string& option, const std::filesystem::path& folder);

// Where somebody was tracked in one of the rows, `file` has to have an entry, of which it has n. Throws IoError.
// entries: what they are called.
void require_rows(const CaptureFolder& capture, const std::vector<int64_t>& rows, const char* file, size_t n,
                  const char* entries);

// metres, glTF frame -> mm, camera frame.
std::vector<float> to_camera_mm(std::vector<float> positions);

// A sample of them likewise; empty when there is none or a vertex is not known.
std::vector<float> known_sample(std::optional<Pc2Reader>& vertices, int64_t index);

// The vertices of a row, mm, camera frame; empty when there are none.
std::vector<float> captured_vertices(CaptureFolder& capture, int64_t row);

// The joints and keypoints of a row by CaptureFolder::joints' names, mm, camera frame, NaN for one that is not known;
// empty when there are none.
std::vector<float> captured_joints(const CaptureFolder& capture, int64_t row);

}  // namespace livecap

// A capture folder and the truth it is compared with, as `livecap eval` and `livecap render` read them.
#include "actor/glb_fixture.h"
#include "base/text.h"
#include "eval/evaluate.h"
#include "export/csv.h"
#include "export/export_frame.h"
#include "export/pc2.h"
#include "fuzz/fuzz.h"
#include "render/clip.h"

namespace livecap::fuzz {
namespace {

constexpr int kFrames = 2;
const std::vector<std::string> kFiles = {"capture/report.json", "capture/frames.csv",   "capture/joints.csv",
                                         "capture/angles.csv",  "capture/vertices.pc2", "capture/detections.jsonl",
                                         "truth/vertices.pc2",  "truth/joints.json",    "capture/camera.json"};

// Neither is fuzzed here: glb_fuzz.cpp does it.
const std::string& actor_bytes() {
  static const std::string bytes = test::make_fixture().bytes;
  return bytes;
}

std::string pc2(const ScratchFolder& folder, const Actor& actor) {
  std::vector<float> positions = actor.mesh.positions;
  for (float& p : positions) p /= 1000;
  Pc2Writer writer(folder.path() / "v.pc2", actor.n_vertices());
  for (int frame = 0; frame < kFrames; ++frame) writer.append(positions);
  return read_file(folder.path() / "v.pc2");
}

}  // namespace

std::vector<std::string> seeds() {
  const ScratchFolder folder;
  const Actor actor = load_actor_bytes(actor_bytes(), "actor.glb");
  const Pose pose = rest_pose(actor.skeleton);
  {
    JointsCsvWriter joints(folder.path() / "joints.csv", actor);
    AnglesCsvWriter angles(folder.path() / "angles.csv", actor.skeleton);
    for (int frame = 0; frame < kFrames; ++frame) {
      joints.append(frame, 40 * frame, true, pose);
      angles.append(frame, 40 * frame, true, pose);
    }
  }
  std::map<std::string, std::string> files;
  for (const char* name : {"joints.csv", "angles.csv"})
    files[std::string("capture/") + name] = read_file(folder.path() / name);
  files["capture/frames.csv"] = "index,pts_ms,status,latency_ms\n0,0,ok,100\n1,40,lost,99.5\n";
  files["capture/report.json"] =
      R"({"fps":25.0,"latency_ms":100,"floor":{"normal":[0,-1,0],"distance_mm":1000},"video":"v.mp4","options":{"camera":"","fov_deg":60,"height_mm":0,"model":"lite",
"rigidity":2,"surface":true,"without":["photo"],"smooth":false,"video":"v.mp4"}})";
  files["capture/camera.json"] = R"({"width":64,"height":48,"fx":60,"fy":60,"cx":31.5,"cy":23.5})";
  files["truth/joints.json"] =
      R"({"names":["Hips","LeftArm","RightArm","LeftHand"],"frames":[null,[[0,0,-3],[0.2,0.5,-3],[-0.2,0.5,-3],[0.3,0,-3]]]})";
  std::vector<std::string> inputs = {join_files(files)};
  files["capture/detections.jsonl"] =
      "{\"frame\":1,\"person\":true,\"score\":0.9,\"keypoints\":{\"neck\":[1,2,3,4,5,1]}}\n";
  files["capture/vertices.pc2"] = files["truth/vertices.pc2"] = pc2(folder, actor);
  inputs.push_back(join_files(files));
  return inputs;
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  static const fuzz::ScratchFolder folder;
  const auto files = fuzz::split_files({reinterpret_cast<const char*>(data), size}, fuzz::kFiles);
  folder.hold(files);
  const std::string actor = folder.write("fixture.glb", fuzz::actor_bytes()).string();

  EvalOptions eval;
  eval.capture = folder.path() / "capture";
  eval.truth = folder.path() / "truth";
  eval.actor = actor;
  if (fuzz::accepts(folder.path().string(), [&] { eval_report_json(evaluate(eval)); }))
    eval_report_text(evaluate(eval));

  render::RenderOptions options;
  options.capture = eval.capture.string();
  options.actor = actor;
  options.view = "front";
  fuzz::accepts(folder.path().string(), [&] {
    render::Clip clip = render::open_clip(options);
    for (int64_t row : clip.rows) clip.vertices(row);
  });
  return 0;
}

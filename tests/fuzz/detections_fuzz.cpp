// detections.jsonl.
#include <cmath>

#include "detect/detections_io.h"
#include "fuzz/fuzz.h"

namespace livecap::fuzz {

std::vector<std::string> seeds() {
  return {R"({"frame":0,"person":false,"score":0.1,"keypoints":{}}
{"frame":1,"person":true,"score":0.98,"keypoints":{"neck":[10.5,20,-3e2,4,5.25,1],"left_hip":[1,2,3,4,5,0]}}

{"frame":7,"person":true,"score":1,"keypoints":{"chin":[0,0,0,0,0,0.5]}}
)"};
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("detections.jsonl", {reinterpret_cast<const char*>(data), size});
  fuzz::accepts(file.string(), [&] {
    for (const Detections& frame : detect::load_detections(file))
      for (const KeypointDetection& k : frame.keypoints)
        fuzz::require(
            std::isfinite(k.x_px + k.y_px + k.x_mm + k.y_mm + k.z_mm) && k.confidence >= 0 && k.confidence <= 1,
            "finite keypoints with a confidence of 0 to 1");
  });
  return 0;
}

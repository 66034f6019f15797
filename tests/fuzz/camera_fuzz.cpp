// camera.json, also of a further view.
#include "eval/extra_view.h"
#include "fuzz/fuzz.h"
#include "livecap/camera.h"

namespace livecap::fuzz {

std::vector<std::string> seeds() {
  return {R"({"width":540,"height":960,"fx":1000.5,"fy":1000,"cx":269.5,"cy":479.5,"distortion":[0.1,-0.2,1e-3,0,0.01],
 "floor":{"normal":[0,-0.99,0.1411],"distance_mm":1500}})",
          R"({"width":64,"height":48,"fx":60,"fy":60,"cx":31.5,"cy":23.5,
 "view_from_camera":[[1,0,0,100],[0,0,-1,200],[0,1,0,-3e3]]})"};
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("camera.json", {reinterpret_cast<const char*>(data), size});
  fuzz::accepts(file.string(), [&] { load_camera(file).validate(); });
  fuzz::accepts(file.string(), [&] {
    fuzz::require(open_view(file, folder.path()).view_from_camera.matrix().allFinite(), "a finite view");
  });
  return 0;
}

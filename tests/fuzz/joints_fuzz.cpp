// The joints that `livecap actor build --joints` is told.
#include "acquire/body_rig.h"
#include "fuzz/fuzz.h"

namespace livecap::fuzz {

std::vector<std::string> seeds() {
  return {R"({"left_elbow":[0.5,1.2,-0.01],"left_eye":[0,1.7,0.1]})",
          R"({"unit":"cm","joints":{"right_knee":[-10,50,0],"nose":[0,1.6e2,1]}})"};
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("joints.json", {reinterpret_cast<const char*>(data), size});
  fuzz::accepts(file.string(), [&] {
    for (const auto& [name, place] : acquire::read_joints(file).world)
      fuzz::require(place.allFinite(), "finite joints");
  });
  return 0;
}

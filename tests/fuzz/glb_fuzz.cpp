// An actor and a scan in .glb.
#include <algorithm>
#include <cmath>

#include "actor/actor.h"
#include "actor/glb_fixture.h"
#include "fuzz/check_scan.h"
#include "fuzz/fuzz.h"

namespace livecap::fuzz {
namespace {

// An input that is no GLB file is a JSON chunk, a zero byte and a BIN chunk: in a container whose lengths are right
// more of what is behind the container's own checks is reached.
std::string container(const std::string& input) {
  if (input.rfind("glTF", 0) == 0) return input;
  const size_t end = std::min(input.find('\0'), input.size());
  std::string bin = input.substr(std::min(end + 1, input.size()));
  bin.resize((bin.size() + 3) / 4 * 4);
  return test::Fixture::pack_text(input.substr(0, end), bin);
}

bool are_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

bool are_below(const std::vector<int32_t>& indices, size_t n) {
  return std::all_of(indices.begin(), indices.end(), [&](int32_t i) { return i >= 0 && static_cast<size_t>(i) < n; });
}

void check_actor(const Actor& actor) {
  const size_t n = actor.mesh.positions.size() / 3;
  require(n >= kMinVertices && n <= kMaxVertices, "kMinVertices to kMaxVertices vertices");
  require(are_finite(actor.mesh.positions), "finite positions");
  require(are_below(actor.mesh.triangles, n), "triangles of the template's vertices");
  require(are_below(actor.render.template_vertex, n), "render vertices of the template's");
  require(are_finite(actor.render.uvs), "finite texture coordinates");
  require(are_finite(actor.colors) && actor.colors.size() == 3 * n, "a colour for every vertex");
  require(are_finite(actor.skin.weights), "finite weights");
  require(are_below({actor.skin.bones.begin(), actor.skin.bones.end()}, actor.skeleton.bones.size()),
          "weights for bones of the skeleton");
  require(actor.labels.size() == n && actor.rigidity.size() == n, "a label for every vertex");
  for (const Bone& bone : actor.skeleton.bones) require(bone.offset_mm.allFinite(), "finite bones");
  for (const KeypointAnchor& keypoint : actor.keypoints)
    require(keypoint.rest_position_mm.allFinite(), "finite keypoints");
}

}  // namespace

std::vector<std::string> seeds() {
  test::FixtureOptions rich;
  rich.livecap = {{"bones", {{"left_shoulder", "mixamorig:LeftArm"}}},
                  {"limits", {{"left_elbow_y", {-120, 2}}}},
                  {"markers", {{"nose", 40}}},
                  {"keypoints", {{"left_hand", {0.01, 0, 0}}}},
                  {"weights", "guessed"},
                  {"shape", "rough"}};
  std::vector<std::string> inputs;
  for (const test::FixtureOptions& options : {test::FixtureOptions{}, rich}) {
    const test::Fixture fixture = test::make_fixture(options);
    inputs.push_back(fixture.document.dump() + '\0' + fixture.bin);
    inputs.push_back(fixture.bytes);
  }
  return inputs;
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  static const fuzz::ScratchFolder folder;
  const std::string bytes = fuzz::container(std::string(reinterpret_cast<const char*>(data), size));
  fuzz::accepts("actor.glb", [&] { fuzz::check_actor(load_actor_bytes(bytes, "actor.glb")); });
  const std::filesystem::path file = folder.write("scan.glb", bytes);
  fuzz::accepts(file.string(), [&] {
    std::vector<std::string> notes;
    fuzz::check_scan(read_scan(file, notes));
  });
  return 0;
}

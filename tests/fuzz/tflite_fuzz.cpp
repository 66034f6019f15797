// Networks in .tflite.
#include "fuzz/fuzz.h"
#include "fuzz/run_network.h"
#include "nn/tflite_import.h"
#include "support/tflite_writer.h"

namespace livecap::fuzz {

std::vector<std::string> seeds() {
  return {test::small_tflite()};
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  fuzz::accepts("net.tflite", [&] { fuzz::run_network(nn::parse_tflite(bytes, "net.tflite")); });
  return 0;
}

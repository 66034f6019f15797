// The network weights, which are not part of this repository: LIVECAP_MODEL_DIR, else models/ of the source tree.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace livecap::test {

inline std::filesystem::path model_path(const std::string& size) {
  const char* folder = std::getenv("LIVECAP_MODEL_DIR");
  return std::filesystem::path(folder && *folder ? folder : LIVECAP_SOURCE_MODELS) /
         ("pose_landmark_" + size + ".tflite");
}

}  // namespace livecap::test

// Skips the test, saying so, unless the weights are there; otherwise defines `variable`.
#define LIVECAP_MODEL_OR_SKIP(variable, size)                             \
  const std::filesystem::path variable = livecap::test::model_path(size); \
  if (!std::filesystem::exists(variable)) GTEST_SKIP() << "skipped: no " << variable << "; tools/setup.sh fetches it"

// The folder of recorded sequences and reference tensors that are not part of this repository (LIVECAP_DATA_DIR).
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

// Skips the test, saying so, unless LIVECAP_DATA_DIR/relative exists; otherwise defines `variable`.
#define LIVECAP_DATA_OR_SKIP(variable, relative)                                                                     \
  const char* livecap_data_dir = std::getenv("LIVECAP_DATA_DIR");                                                    \
  const std::filesystem::path variable = std::filesystem::path(livecap_data_dir ? livecap_data_dir : "") / relative; \
  if (!livecap_data_dir || !std::filesystem::exists(variable))                                                       \
  GTEST_SKIP() << "skipped: LIVECAP_DATA_DIR has no " << relative

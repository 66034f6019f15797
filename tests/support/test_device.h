// The devices a device test runs on: LIVECAP_TEST_DEVICES, a comma-separated list of selectors (default "pocl").
// No device is a failure of the test, never a silent skip.
#pragma once

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "ocl/context.h"
#include "ocl/device.h"

namespace livecap::test {

inline std::vector<std::string> device_selectors() {
  const char* list = std::getenv("LIVECAP_TEST_DEVICES");
  std::istringstream in(list && *list ? list : "pocl");
  std::vector<std::string> selectors;
  for (std::string item; std::getline(in, item, ',');) selectors.push_back(item);
  return selectors;
}

// Runs check(device) on every test device.
template <typename Check>
void on_every_device(Check&& check) {
  for (const std::string& selector : device_selectors()) {
    ocl::DeviceContext device(ocl::select_device(selector));
    check(device);
  }
}

}  // namespace livecap::test

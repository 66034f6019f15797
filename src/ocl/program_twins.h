// PoCL (seen with 3.1) finds the loaded code of a kernel by what it was built from, and ends the process with an
// assertion (pocl_release_dlhandle_cache) when two queues run it at the same time over ranges of different sizes. So
// programs of one text that are alive at the same time, of captures beside each other, differ by a definition that says
// nothing.
#pragma once

#include <string>

namespace livecap::ocl {

// The least number, 0 or more, that no living program of this name has. Thread-safe, as is the other.
int take_twin(const std::string& name);
void give_back_twin(const std::string& name, int twin);

}  // namespace livecap::ocl

#include "ocl/groups_together.h"

#include <algorithm>

#include "base/log.h"

namespace livecap::ocl {

GroupsTogether::GroupsTogether(DeviceContext& device, size_t most)
    : device_(device.info().label()),
      n_(std::clamp<size_t>(device.info().compute_units, 1, std::max<size_t>(most, 1))),
      work_(true),
      state_(device, 2) {
  state_.fill(0);
}

void GroupsTogether::read_later() {
  if (work_) state_.read_later(state_read_);
}

bool GroupsTogether::gave_up(const std::string& what, bool told) {
  if (!work_ || !told) return false;
  log_info(what + ": " + device_ +
           " has no fence between work-groups, or was too busy for them to meet; each step is launched by itself");
  work_ = false;
  return true;
}

}  // namespace livecap::ocl

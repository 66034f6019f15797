// Launches on a GPU whose work-groups wait for each other (kernels/shared/all_arrived.h) or for each other's numbers
// (kernels/shared/tagged.h): how many groups there may be, what they count with, and whether it works on the device.
//   kernel.launch(groups.n() * local, local, first, end, groups.arrived(), ..., groups.state());
//   groups.launched(end - first - 1);
#pragma once

#include <array>
#include <string>

#include "ocl/buffer.h"

namespace livecap::ocl {

class GroupsTogether {
 public:
  GroupsTogether() = default;
  // At most `most` groups, and no more than the device has compute units.
  GroupsTogether(DeviceContext& device, size_t most);

  size_t n() const { return n_; }
  // False: launches must have one step each.
  bool work() const { return work_; }
  int32_t arrived() const { return static_cast<int32_t>(arrived_); }
  const Buffer<int32_t>& state() const { return state_; }

  // After every launch: how often its groups wait for each other.
  void launched(size_t n_waits) { arrived_ += static_cast<uint32_t>(n_ * n_waits); }
  // Enqueues what gave_up() looks at after the next blocking read.
  void read_later();
  // True, and a line in the log, once when a wait was given up: what was launched is to be done again. `what` for that
  // line.
  bool gave_up(const std::string& what) { return gave_up(what, state_read_[1] != 0); }
  // The same for a kernel that tells it in what is read anyway.
  bool gave_up(const std::string& what, bool told);

 private:
  std::string device_;
  size_t n_ = 1;
  bool work_ = false;
  uint32_t arrived_ = 0;  // when all that was launched has run; wraps around
  Buffer<int32_t> state_;
  std::array<int32_t, 2> state_read_{};
};

}  // namespace livecap::ocl

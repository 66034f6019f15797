// Work-groups of one launch on a GPU that wait for each other. For that they all must run at once, which OpenCL does
// not promise and GPUs do when there are not more of them than compute units. A wait that lasts too long ends the
// launch and is told to the host (src/ocl/groups_together.h), which then launches step by step; so it is from the
// beginning where the compiler offers no fence for the whole device.
#ifndef LC_SHARED_ALL_ARRIVED_H
#define LC_SHARED_ALL_ARRIVED_H

// What all work-groups wrote before is seen by all after. OpenCL C 1.2 has this for one work-group only.
#ifdef __NV_CL_C_VERSION
#define FENCE_OF_DEVICE() asm volatile("membar.gl;" ::: "memory")
#endif

// How often a work-group looks for the others, about a second.
#define MOST_LOOKS (1 << 21)

// True in all work-items when all groups have come here. together: whether the group has given up no wait before; one
// that has does not come, so that all others give up as well. state: how many arrivals there were, and whether a wait
// was given up. arrivals: how many there are then.
static int all_arrived(int together, volatile global int* state, int arrivals, local int* given_up) {
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
#ifdef FENCE_OF_DEVICE
  if (get_local_id(0) == 0) {
    FENCE_OF_DEVICE();
    if (together) atomic_inc(state);
    *given_up = !together;
    // Read and not counted, so that who arrives need not wait for those who look. The count may wrap around.
    for (int looks = 1; together && (int)((uint)state[0] - (uint)arrivals) < 0; ++looks) {
      if (looks < MOST_LOOKS && !state[1]) continue;
      atomic_xchg(state + 1, 1);
      *given_up = 1;
      break;
    }
    FENCE_OF_DEVICE();
  }
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  return !*given_up;
#else
  (void)arrivals;
  (void)given_up;
  if (get_num_groups(0) == 1) return together;
  state[1] = 1;
  return 0;
#endif
}

#endif

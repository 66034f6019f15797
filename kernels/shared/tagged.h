// Numbers that work-groups of one launch hand to each other without all waiting for all (all_arrived.h): each stands in
// one word of 64 bits with a tag, so that who reads it sees whether it is there yet. A word is written and read at once
// or not at all, and nothing else is handed over with it, so that no fence is needed and caches keep what they have.
// What holds for waits of all groups holds for these: all must run at once, one that lasts too long is given up, and
// so is every one where the compiler offers no fence, since nothing is known there of groups and of whole words.
#ifndef LC_SHARED_TAGGED_H
#define LC_SHARED_TAGGED_H
#include "shared/all_arrived.h"

// Words that a work-item asks for at a time, at most.
#define TAGGED_AT_ONCE 8

static ulong tagged(float value, uint tag) {
  return (ulong)tag << 32 | as_uint(value);
}

static float untagged(ulong word) {
  return as_float((uint)word);
}

// words[first], words[first + stride] and so on before `end`, `at_once` (a constant) at most, once they have the tag; 0
// for those that there are not. Returns whether they had it; a wait that lasted too long is given up, which state[1]
// tells the other groups.
static int take_tagged(int at_once, int first, int stride, int end, volatile global const ulong* words, uint tag,
                       volatile global int* state, float* values) {
  ulong taken[TAGGED_AT_ONCE];
  int missing = 1;
  for (int looks = 1; missing; ++looks) {
#pragma unroll
    for (int k = 0; k < at_once; ++k) taken[k] = words[min(first + k * stride, end - 1)];
    missing = 0;
#pragma unroll
    for (int k = 0; k < at_once; ++k) missing |= first + k * stride < end && (uint)(taken[k] >> 32) != tag;
#ifdef FENCE_OF_DEVICE
    if (missing && looks < MOST_LOOKS && (looks % 1024 || !state[1])) continue;
#else
    missing |= get_num_groups(0) > 1;
#endif
    break;
  }
  if (missing) state[1] = 1;
#pragma unroll
  for (int k = 0; k < at_once; ++k) values[k] = first + k * stride < end ? untagged(taken[k]) : 0.0f;
  return !missing;
}

#endif

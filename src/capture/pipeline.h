// The three-thread pipeline of the paper ("Pipelined Implementation"): read | network | solvers, with publishing on the
// caller's thread. Hand-over of depth one, so a result is about two frames behind its input.
#pragma once

#include <functional>

#include "capture/work_item.h"

namespace livecap {

// What each thread does to an item. The same functions in the same order give the sequential run, so both give the same
// result. A stage that throws stops the others and its exception leaves run_*.
struct PipelineStages {
  std::function<bool(WorkItem&)> read;     // thread 1; false at the end of the input
  std::function<void(WorkItem&)> detect;   // thread 2, network context
  std::function<void(WorkItem&)> solve;    // thread 3, solver context
  std::function<bool(WorkItem&)> publish;  // caller's thread, in input order; false to stop early
};

void run_sequential(const PipelineStages& stages);

// newest_wins: the reader never waits for the network; an item still waiting is replaced by a newer one and is
// published with it as dropped.
void run_pipelined(const PipelineStages& stages, bool newest_wins);

}  // namespace livecap

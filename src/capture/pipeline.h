// The pipeline of the paper ("Pipelined Implementation"): read | network | segmentation in two halves | pose |
// surface, with publishing on the caller's thread. The paper has both solvers in one thread; poses do not wait for
// surfaces. The paper subtracts the background in the reading thread; here the network's mask gates it, so it follows
// the network, in threads of its own: beside the network it would lengthen the longest thread of a CPU machine, beside
// the solvers that of a GPU machine. Hand-over of depth one.
#pragma once

#include <functional>
#include <optional>

#include "capture/work_item.h"

namespace livecap {

// What each thread does to an item. The same functions in the same order give the sequential run, so both give the same
// result. A stage that throws stops the others and its exception leaves run_*.
struct PipelineStages {
  std::function<bool(WorkItem&)> read;  // thread 1; false at the end of the input
  // Where read may wait for as long as it likes: ends that when the run stops early. Any thread.
  std::function<void()> stop_reading = [] {};
  std::function<void(WorkItem&)> detect;   // thread 2, network context
  std::function<void(WorkItem&)> gate;     // thread 3: where in the picture the person is looked for
  std::function<void(WorkItem&)> segment;  // thread 4
  // Thread 5, solver context: the pose. May keep items until others come; flush gives one of those that are left, or
  // none.
  std::function<std::optional<WorkItem>(WorkItem&&)> solve;
  std::function<std::optional<WorkItem>()> flush;
  std::function<void(WorkItem&)> surface;  // thread 6, solver's device
  std::function<bool(WorkItem&)> publish;  // caller's thread, in input order; false to stop early
};

// The newer item carries the displaced one's report on, and those it carried, before its own.
void inherit_dropped(WorkItem& newer, WorkItem&& displaced);

void run_sequential(const PipelineStages& stages);

// newest_wins: the reader never waits for the network; an item still waiting is replaced by a newer one and is
// published with it as dropped. The network takes the next one when fewer than most_under_way are between it and
// publish(), those that solve() keeps included, of which there must be fewer: what waits in front of a slow stage would
// be the older when it is published. 0: as many as there is room for.
void run_pipelined(const PipelineStages& stages, bool newest_wins, int most_under_way = 0);

}  // namespace livecap

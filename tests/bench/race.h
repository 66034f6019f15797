// Two ways to the same result, in turns in the same run.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/timer.h"

namespace livecap::bench {

constexpr int kRounds = 60;

struct Contest {
  std::string name;
  std::function<void()> ours;  // returns when its result is there
  std::string peer_name;
  std::function<void()> peer;
  int repeats = 1;  // of what is reported in one call of each
};

// Time is ours; the counters are the medians of both, ms, and how often ours fits into the peer's.
inline void register_contest(Contest contest) {
  const std::string name = contest.name + ", peer: " + contest.peer_name;
  benchmark::RegisterBenchmark(name.c_str(),
                               [contest = std::move(contest)](benchmark::State& state) {
                                 const auto timed = [&](const std::function<void()>& work) {
                                   const Timer timer;
                                   work();
                                   return timer.elapsed_ms() / contest.repeats;
                                 };
                                 contest.ours();
                                 contest.peer();
                                 std::vector<double> ours, peer;
                                 for (auto _ : state) {
                                   ours.push_back(timed(contest.ours));
                                   peer.push_back(timed(contest.peer));
                                   state.SetIterationTime(ours.back() * contest.repeats * 1e-3);
                                 }
                                 state.counters["ours_ms"] = median(ours);
                                 state.counters["peer_ms"] = median(peer);
                                 state.counters["peer/ours"] = median(peer) / median(ours);
                               })
      ->UseManualTime()
      ->Iterations(kRounds)
      ->Unit(benchmark::kMillisecond);
}

// Takes --name=value out of the arguments; `otherwise` when it is not there.
inline std::string take_option(int& argc, char** argv, const std::string& name, const std::string& otherwise) {
  const std::string start = "--" + name + "=";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.rfind(start, 0) != 0) continue;
    std::copy(argv + i + 1, argv + argc, argv + i);
    --argc;
    return argument.substr(start.size());
  }
  return otherwise;
}

}  // namespace livecap::bench

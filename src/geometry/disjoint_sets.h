// Which of n things belong together, as pairs of them become known (union-find).
#pragma once

#include <numeric>
#include <vector>

namespace livecap {

class DisjointSets {
 public:
  explicit DisjointSets(int n) : parents_(n) { std::iota(parents_.begin(), parents_.end(), 0); }

  // The member that stands for i's set.
  int find(int i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }

  // From now on what stands for b's set stands for a's as well. False when they were one already.
  bool join(int a, int b) {
    const int from = find(a), to = find(b);
    parents_[from] = to;
    return from != to;
  }

 private:
  std::vector<int> parents_;
};

}  // namespace livecap

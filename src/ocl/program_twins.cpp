#include "ocl/program_twins.h"

#include <map>
#include <mutex>
#include <set>

namespace livecap::ocl {
namespace {

struct Taken {
  std::mutex mutex;
  std::map<std::string, std::set<int>> by_name;
};

Taken& taken() {
  static Taken* taken = new Taken;  // outlives contexts that are never destroyed
  return *taken;
}

}  // namespace

int take_twin(const std::string& name) {
  const std::scoped_lock lock(taken().mutex);
  std::set<int>& twins = taken().by_name[name];
  int twin = 0;
  while (!twins.insert(twin).second) ++twin;
  return twin;
}

void give_back_twin(const std::string& name, int twin) {
  const std::scoped_lock lock(taken().mutex);
  taken().by_name[name].erase(twin);
}

}  // namespace livecap::ocl

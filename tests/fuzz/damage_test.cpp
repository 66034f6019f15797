// The targets without libFuzzer: every seed whole, cut short and with bytes changed. `--write FOLDER` writes the seeds
// instead, for libFuzzer to begin with.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <random>

#include "base/text.h"
#include "fuzz/fuzz.h"

namespace {

constexpr size_t kCuts = 60;
constexpr int kFlipped = 120;

void run(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(input.data()), input.size());
}

void run_damaged(const std::string& seed, std::mt19937& rng) {
  for (size_t cut = 0; cut < kCuts; ++cut) run(seed.substr(0, seed.size() * cut / kCuts));
  for (int i = 0; i < kFlipped; ++i) {
    std::string input = seed;
    for (int flips = 1 + i % 3; flips > 0; --flips) {
      char& byte = input[rng() % input.size()];
      byte = static_cast<char>(i % 2 ? rng() : byte ^ (1 << rng() % 8));
    }
    run(input);
  }
}

int64_t n_accepted() {
  int64_t n = 0;
  for (const auto& [line, times] : livecap::fuzz::accepted()) n += times;
  return n;
}

// Runs the seeds as they are. Whether each is accepted by a reader, and each reader accepts one.
bool are_accepted(const std::vector<std::string>& seeds) {
  bool all = true;
  for (size_t i = 0; i < seeds.size(); ++i) {
    const int64_t before = n_accepted();
    run(seeds[i]);
    if (n_accepted() > before) continue;
    std::printf("seed %zu is accepted by no reader\n", i);
    all = false;
  }
  for (const auto& [line, times] : livecap::fuzz::accepted()) {
    if (times > 0) continue;
    std::printf("the reader of line %d accepts no seed\n", line);
    all = false;
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> seeds = livecap::fuzz::seeds();
  if (argc == 3 && std::string(argv[1]) == "--write") {
    std::filesystem::create_directories(argv[2]);
    for (size_t i = 0; i < seeds.size(); ++i)
      livecap::write_file_atomically(std::filesystem::path(argv[2]) / livecap::format("seed_%zu", i), seeds[i]);
    return 0;
  }
  if (!are_accepted(seeds)) return 1;
  run("");
  std::mt19937 rng(1);
  for (const std::string& seed : seeds) run_damaged(seed, rng);
  std::printf("%zu seeds, %zu damaged inputs: nothing but what the readers promise\n", seeds.size(),
              seeds.size() * (kCuts + kFlipped));
}

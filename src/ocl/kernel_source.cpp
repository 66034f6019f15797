#include "ocl/kernel_source.h"

#include <cstdlib>
#include <set>
#include <sstream>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::ocl {
namespace {

std::string load(const std::string& path) {
  if (const char* folder = std::getenv("LIVECAP_KERNEL_DIR")) return read_file(std::filesystem::path(folder) / path);
  for (int i = 0; i < kEmbeddedKernelCount; ++i) {
    if (path == kEmbeddedKernels[i].path) return std::string(kEmbeddedKernels[i].text, kEmbeddedKernels[i].size);
  }
  throw LogicError("kernel source \"" + path + "\" is not embedded");
}

// The quoted name when the line is #include "name", else empty.
std::string included_name(const std::string& line) {
  const size_t hash = line.find_first_not_of(" \t");
  if (hash == std::string::npos || line[hash] != '#') return {};
  const size_t word = line.find_first_not_of(" \t", hash + 1);
  if (word == std::string::npos || line.compare(word, 7, "include") != 0) return {};
  const size_t open = line.find('"', word);
  if (open == std::string::npos) return {};
  const size_t close = line.find('"', open + 1);
  if (close == std::string::npos) return {};
  return line.substr(open + 1, close - open - 1);
}

void expand(const std::string& path, std::set<std::string>& seen, std::string& out) {
  if (!seen.insert(path).second) return;
  std::istringstream in(load(path));
  std::string line;
  int number = 0;
  out += "#line 1 \"" + path + "\"\n";
  while (std::getline(in, line)) {
    ++number;
    const std::string name = included_name(line);
    if (name.empty()) {
      out += line + "\n";
    } else {
      expand(name, seen, out);
      out += format("#line %d \"%s\"\n", number + 1, path.c_str());
    }
  }
}

}  // namespace

std::string resolve_kernel_source(const std::string& path) {
  std::set<std::string> seen;
  std::string out;
  expand(path, seen, out);
  return out;
}

std::vector<std::string> kernel_paths() {
  std::vector<std::string> paths;
  for (int i = 0; i < kEmbeddedKernelCount; ++i) paths.emplace_back(kEmbeddedKernels[i].path);
  return paths;
}

}  // namespace livecap::ocl

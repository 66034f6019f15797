#include "fuzz/fuzz.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::fuzz {
namespace {

std::map<int, int64_t> g_accepted;

[[noreturn]] void stop(const std::string& why) {
  std::fprintf(stderr, "fuzz: %s\n", why.c_str());
  std::abort();
}

void check_message(const std::string& file, const std::string& message) {
  if (message.find(file) == std::string::npos) stop("the message does not name " + file + ": " + message);
  if (message != one_line(message)) stop("the message is not one printable line: " + message);
}

}  // namespace

const std::map<int, int64_t>& accepted() {
  return g_accepted;
}

void count(bool is_accepted, int line) {
  g_accepted[line] += is_accepted;
}

bool accepts(const std::string& file, const std::function<void()>& read, int line) {
  bool is_accepted = false;
  try {
    read();
    is_accepted = true;
  } catch (const IoError& error) {
    check_message(file, error.what());
  } catch (const ConfigError& error) {
    check_message(file, error.what());
  }
  count(is_accepted, line);
  return is_accepted;
}

void require(bool holds, const char* promise) {
  if (!holds) stop(std::string("broken promise: ") + promise);
}

void ScratchFolder::clear() const {
  std::filesystem::remove_all(path());
  std::filesystem::create_directories(path());
}

void ScratchFolder::hold(const std::map<std::string, std::string>& files) const {
  clear();
  for (const auto& [name, bytes] : files) write(name, bytes);
}

std::filesystem::path ScratchFolder::write(const std::string& name, std::string_view bytes) const {
  const std::filesystem::path file = path() / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

std::map<std::string, std::string> split_files(std::string_view input, const std::vector<std::string>& names) {
  std::map<std::string, std::string> files;
  std::string* file = nullptr;
  while (!input.empty()) {
    const size_t end = std::min(input.find('\n'), input.size() - 1) + 1;
    const std::string_view line = input.substr(0, end);
    input.remove_prefix(end);
    const auto named =
        std::find_if(names.begin(), names.end(), [&](const std::string& name) { return line == "@" + name + "\n"; });
    if (named != names.end()) {
      file = &files[*named];
    } else if (file) {
      *file += line;
    }
  }
  return files;
}

std::string join_files(const std::map<std::string, std::string>& files) {
  std::string input;
  for (const auto& [name, bytes] : files)
    input += (input.empty() || input.back() == '\n' ? "@" : "\n@") + name + "\n" + bytes;
  return input;
}

}  // namespace livecap::fuzz

// What the fuzz targets of this folder share. A target is one reader, or a few, of a file that a user may hand over:
// LLVMFuzzerTestOneInput gives it any bytes, seeds() are inputs to begin with. With libFuzzer (LIVECAP_FUZZ)
// the inputs are looked for, in the tests they are the seeds, damaged (damage_test.cpp): docs/fuzzing.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/scratch_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace livecap::fuzz {

// Whole inputs. One of the target's readers at least accepts each, and each reader one of them: damage_test.cpp sees to
// it, since what is refused at the front tries nothing behind it. Defined by the target.
std::vector<std::string> seeds();

// Runs a reader; true when it accepts its input. It may refuse it by IoError or ConfigError whose message is one
// printable line that names `file`. Anything else ends the program, as it would end the user's. line: of the call.
bool accepts(const std::string& file, const std::function<void()>& read, int line = __builtin_LINE());

// How often the reader of each line accepted an input. Counted by accepts(), else by count().
const std::map<int, int64_t>& accepted();
void count(bool is_accepted, int line = __builtin_LINE());

// Ends the program when what a reader returned is not what its header promises.
void require(bool holds, const char* promise);

class ScratchFolder : public livecap::ScratchFolder {
 public:
  // Writes a file, with the folders above it.
  std::filesystem::path write(const std::string& name, std::string_view bytes) const;
  void clear() const;
  // These files, by their names, and no others.
  void hold(const std::map<std::string, std::string>& files) const;
};

// One input for several files: each is headed by a line "@NAME". What is before the first such line, or under a name
// that is not in `names`, is dropped.
std::map<std::string, std::string> split_files(std::string_view input, const std::vector<std::string>& names);
std::string join_files(const std::map<std::string, std::string>& files);

}  // namespace livecap::fuzz

// A file that is written bit by bit: beside its name, which it takes when it is whole. What had that name before is
// there until then, and nothing is left of a file that never is whole.
#pragma once

#include <filesystem>

namespace livecap {

class PartFile {
 public:
  // Of a link, what it leads to; a pipe or a device is written to as it is.
  explicit PartFile(const std::filesystem::path& file);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  // Where to write.
  const std::filesystem::path& path() const { return part_; }
  // Once the writer has closed it. Throws IoError.
  void finish();

 private:
  std::filesystem::path file_, part_;
};

}  // namespace livecap

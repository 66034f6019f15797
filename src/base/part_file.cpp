#include "base/part_file.h"

#include "base/output_path.h"
#include "livecap/error.h"

namespace livecap {

namespace fs = std::filesystem;

PartFile::PartFile(const fs::path& file) : file_(link_target(file)), part_(file_) {
  if (!is_stream(file_)) part_ += ".part";
}

PartFile::~PartFile() {
  std::error_code ignored;
  if (part_ != file_) fs::remove(part_, ignored);
}

void PartFile::finish() {
  std::error_code code;
  if (part_ != file_) fs::rename(part_, file_, code);
  if (code) throw IoError(file_.string() + ": cannot be written: " + code.message());
}

}  // namespace livecap

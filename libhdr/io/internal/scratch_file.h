#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace hdr::internal {

/// Room on the disk for what must not stay in memory: a file in the folder for temporary files that has no name any
/// more, so that nothing is left of it however the program ends. `purpose` begins the messages of its Errors.
class ScratchFile {
 public:
  explicit ScratchFile(std::string purpose);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  void append(const void* bytes, std::size_t count);
  void read_at(std::int64_t offset, void* bytes, std::size_t count) const;

 private:
  std::string purpose_;
  int file_ = -1;
};

}  // namespace hdr::internal

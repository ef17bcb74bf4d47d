#include "libhdr/io/output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const Path& target, const std::string& fact, const std::string& remedy) {
  throw Error(fmt::format("{}: cannot be written: {}; {}", target.string(), fact, remedy));
}

/// What stands in the way at the target's place, told before hours of computing are spent.
void check_place(const Path& target) {
  if (target.filename().empty() || fs::is_directory(target)) refuse(target, "it is a folder", "name a file in it");
  const Path folder = target.has_parent_path() ? target.parent_path() : Path(".");
  std::error_code absent;
  const fs::file_status status = fs::status(folder, absent);
  if (!fs::exists(status)) refuse(target, fmt::format("no folder {}", folder.string()), "make it first");
  if (!fs::is_directory(status)) refuse(target, folder.string() + " is not a folder", "name another place");
  // A rename would put a plain file where a device or a pipe stood.
  if (fs::exists(target) && !fs::is_regular_file(target)) {
    refuse(target, "it is a device or a pipe", "name a plain file");
  }
}

/// `.NAME.PID.tmp.EXT` beside the target; a very long NAME is cut, since a folder entry holds at most 255 bytes.
Path temporary_for(const Path& target) {
  const std::string name = fmt::format(".{}.{}.tmp{}", target.stem().string().substr(0, 200), getpid(),
                                       target.extension().string().substr(0, 20));
  return target.parent_path() / name;
}

}  // namespace

OutputFile::OutputFile(Path target) : target_(std::move(target)) {
  // A link stays a link: what it points to is replaced.
  if (std::error_code failed; fs::is_symlink(target_, failed)) target_ = fs::weakly_canonical(target_);
  std::error_code failed;
  check_place(target_);
  temporary_ = temporary_for(target_);
  errno = 0;
  if (!std::ofstream(temporary_, std::ios::binary)) {
    refuse(target_, std::strerror(errno ? errno : EACCES), "check the folder's permissions and the disk");
  }
}

OutputFile::~OutputFile() {
  std::error_code ignored;
  if (!committed_) fs::remove(temporary_, ignored);
}

void OutputFile::commit() {
  std::error_code failed;
  fs::rename(temporary_, target_, failed);
  if (failed) refuse(target_, failed.message(), "check the folder and the disk");
  committed_ = true;
}

void write_text(const Path& path, const std::string& text) {
  OutputFile out(path);
  std::ofstream file(out.temporary(), std::ios::binary);
  file << text;
  file.close();
  if (!file) refuse(path, "the text did not fit", "check the space on the disk");
  out.commit();
}

std::string read_text(const Path& path) {
  if (!fs::exists(path)) throw Error(path.string() + ": no such file; check the name");
  if (fs::is_directory(path)) throw Error(path.string() + ": is a folder; name a file");
  std::ifstream file(path, std::ios::binary);
  std::string text;
  if (fs::is_regular_file(path)) {  // whole, at once: a map is a large text
    text.resize(fs::file_size(path));
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
    if (file.eof()) file.clear();
  } else {
    text.assign(std::istreambuf_iterator<char>(file), {});
  }
  if (!file.is_open() || file.bad()) throw Error(path.string() + ": cannot be read; check its permissions");
  return text;
}

}  // namespace hdr

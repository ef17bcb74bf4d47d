#include "libhdr/io/output_file.h"

#include <fstream>

#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::ScratchDir;

std::size_t entries_in(const Path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const ScratchDir scratch;
  const Path target = scratch / "map.exr";
  write_text(target, "old");
  {
    OutputFile out(target);
    EXPECT_EQ(out.temporary().parent_path(), target.parent_path()) << "a rename is atomic inside one folder only";
    EXPECT_EQ(out.temporary().extension(), ".exr") << "writers choose the format by the extension";
    EXPECT_TRUE(out.temporary().filename().string().starts_with(".map."));
    std::ofstream(out.temporary()) << "new";
    EXPECT_EQ(read_text(target), "old");
    out.commit();
    EXPECT_EQ(read_text(target), "new");
  }
  EXPECT_EQ(entries_in(scratch.path()), 1u) << "nothing but the target stays";
}

TEST(OutputFile, LeavesTheOldFileWhenAbandoned) {
  const ScratchDir scratch;
  const Path target = scratch / "map.exr";
  write_text(target, "old");
  { OutputFile out(target); }
  EXPECT_EQ(read_text(target), "old");
  EXPECT_EQ(entries_in(scratch.path()), 1u);
}

TEST(OutputFile, SaysWhatStandsInTheWay) {
  const ScratchDir scratch;
  write_text(scratch / "file", "");
  const auto refusal = [&](const Path& target) { return error_of([&] { OutputFile out(target); }); };

  const std::string missing = refusal(scratch / "nowhere/out.exr");
  EXPECT_TRUE(missing.starts_with((scratch / "nowhere/out.exr").string() + ": cannot be written: no folder"))
      << missing;
  EXPECT_NE(refusal(scratch.path()).find("it is a folder"), std::string::npos);
  EXPECT_NE(refusal(scratch / "file/out.exr").find("is not a folder"), std::string::npos);
  EXPECT_NE(refusal("/dev/null").find("device or a pipe"), std::string::npos) << "a rename would replace the device";
  EXPECT_NE(refusal("/proc/out.exr").find("/proc/out.exr: cannot be written: "), std::string::npos);
}

TEST(OutputFile, WritesThroughALink) {
  const ScratchDir scratch;
  write_text(scratch / "real.txt", "old");
  fs::create_symlink("real.txt", scratch / "link.txt");
  write_text(scratch / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(scratch / "link.txt"));
  EXPECT_EQ(read_text(scratch / "real.txt"), "new");
}

TEST(OutputFile, TakesTheLongestNameAFolderHolds) {
  const ScratchDir scratch;
  const Path target = scratch / (std::string(251, 'x') + ".txt");
  write_text(target, "kept");
  EXPECT_EQ(read_text(target), "kept");
}

TEST(ReadText, RefusesWhatIsNotAFile) {
  const ScratchDir scratch;
  EXPECT_NE(error_of([&] { read_text(scratch / "absent"); }).find("no such file"), std::string::npos);
  EXPECT_NE(error_of([&] { read_text(scratch.path()); }).find("is a folder"), std::string::npos);
  write_text(scratch / "empty", "");
  EXPECT_EQ(read_text(scratch / "empty"), "");
}

}  // namespace
}  // namespace hdr

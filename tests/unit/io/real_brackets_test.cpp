// Real photographs: exposures agree with the collection's table.
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "libhdr/io/bracket.h"
#include "libhdr/io/read.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

/// Exposure times of one set, by file name.
std::map<std::string, double> table_of(const Path& tsv, const std::string& set) {
  std::map<std::string, double> seconds;
  std::ifstream file(tsv);
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string name, file_name, time;
    std::getline(fields, name, '\t');
    std::getline(fields, file_name, '\t');
    std::getline(fields, time, '\t');
    if (name == set) seconds[file_name] = std::stod(time);
  }
  return seconds;
}

void expect_times(const Bracket& bracket, const std::map<std::string, double>& table) {
  ASSERT_EQ(bracket.shots.size(), table.size());
  for (const Photo& shot : bracket.shots) {
    const auto row = table.find(shot.path.filename().string());
    ASSERT_NE(row, table.end()) << shot.path;
    EXPECT_NEAR(*shot.exposure.seconds / row->second, 1, 1e-6) << shot.path;
  }
}

TEST(RealBrackets, Canon5dFromExif) {
  HDR_NEED_SHARED_DATA(folder, "brackets/canon5d_15");
  HDR_NEED_SHARED_DATA(tsv, "exposures.tsv");
  const Bracket bracket = read_bracket({folder});
  expect_times(bracket, table_of(tsv, "brackets/canon5d_15"));
  EXPECT_EQ(bracket.shots[0].exposure.f_number, 4);
  EXPECT_EQ(bracket.shots[0].exposure.iso, 100);
  EXPECT_TRUE(bracket.shots[0].lossy);
}

TEST(RealBrackets, T2iFromExif) {
  HDR_NEED_SHARED_DATA(folder, "brackets/t2i_tripod");
  HDR_NEED_SHARED_DATA(tsv, "exposures.tsv");
  expect_times(read_bracket({folder}), table_of(tsv, "brackets/t2i_tripod"));
}

TEST(RealBrackets, MemorialFromItsLists) {
  HDR_NEED_SHARED_DATA(folder, "brackets/memorial");
  HDR_NEED_SHARED_DATA(tsv, "exposures.tsv");
  for (const char* list : {"image_list.txt", "memorial.hdr_image_list.txt"}) {
    const Bracket bracket = read_bracket({folder}, {.times = {}, .exposures = folder / list});
    expect_times(bracket, table_of(tsv, "brackets/memorial"));
    EXPECT_EQ(bracket.shots[0].exposure.f_number, 8) << list;
    EXPECT_EQ(bracket.size(), (Size{512, 768})) << list;
  }
}

TEST(RealBrackets, Iphone6FromItsListOfShutterSpeeds) {
  HDR_NEED_SHARED_DATA(folder, "brackets/iphone6_window");
  HDR_NEED_SHARED_DATA(tsv, "exposures.tsv");
  const Bracket listed = read_bracket({folder}, {.times = {}, .exposures = folder / "detail.txt"});
  expect_times(listed, table_of(tsv, "brackets/iphone6_window"));
  EXPECT_EQ(listed.size(), (Size{2448, 3264})) << "taken upright: EXIF orientation 6";
  const double first = read_photo_header(folder / "1.JPG").exposure.seconds.value();
  EXPECT_DOUBLE_EQ(first, 1.0 / 3049) << "recovered from the float that OpenImageIO gives";
}

}  // namespace
}  // namespace hdr

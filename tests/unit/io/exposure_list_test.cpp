#include "libhdr/io/exposure_list.h"

#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

using test::error_of;
using Brightness = std::vector<std::optional<double>>;

Exposure only(const std::string& text, ListFormat format = ListFormat::kAuto) {
  const auto listed = parse_exposure_list(text, "LIST", format);
  EXPECT_EQ(listed.size(), 1u);
  return listed.at(0).exposure;
}

TEST(ExposureList, PlainLinesAreSeconds) {
  const auto listed = parse_exposure_list("# a comment\n\na.jpg 0.25 8 200 3  # ND filter\r\nb.jpg 1/60\n", "LIST");
  ASSERT_EQ(listed.size(), 2u);
  EXPECT_EQ(listed[0].name, "a.jpg");
  EXPECT_EQ(listed[0].exposure.seconds, 0.25);
  EXPECT_EQ(listed[0].exposure.f_number, 8);
  EXPECT_EQ(listed[0].exposure.iso, 200);
  EXPECT_EQ(listed[0].exposure.nd_stops, 3);
  EXPECT_EQ(listed[1].exposure.seconds, 1.0 / 60);
  EXPECT_FALSE(listed[1].exposure.f_number || listed[1].exposure.iso);
}

TEST(ExposureList, NamesWithSpacesStandInQuotes) {
  const auto listed = parse_exposure_list("\"my shots/IMG 1.jpg\" 2\n", "LIST");
  EXPECT_EQ(listed.at(0).name, "my shots/IMG 1.jpg");
}

TEST(ExposureList, DebevecsHeaderNamesTheColumns) {
  const Exposure both =
      only("# Filename  exposure  1/shutter_speed f/stop gain(db) ND_filters\na.png 32 0.03125 8 6 1\n");
  EXPECT_EQ(both.seconds, 32);
  EXPECT_EQ(both.f_number, 8);
  EXPECT_DOUBLE_EQ(both.iso.value_or(0), 400) << "3 dB double the exposure";
  EXPECT_EQ(both.nd_stops, 1);
  const Exposure inverse =
      only("# Number of Images\n1\n# Filename  1/shutter_speed f/stop gain(db) ND_filters\na.ppm 1024 8 0 0\n");
  EXPECT_EQ(inverse.seconds, 1.0 / 1024);
  EXPECT_DOUBLE_EQ(inverse.iso.value_or(0), 100);
}

TEST(ExposureList, TheFormatMayBeGiven) {
  EXPECT_EQ(only("a.jpg 250 8", ListFormat::kInverse).seconds, 1.0 / 250);
  EXPECT_DOUBLE_EQ(only("a.jpg 250 8 3", ListFormat::kInverse).iso.value_or(0), 200);
  const Exposure hdrgen = only("shots/a.jpg 250 5.6 400 0", ListFormat::kHdrgen);
  EXPECT_EQ(hdrgen.seconds, 1.0 / 250);
  EXPECT_EQ(hdrgen.iso, 400);
  EXPECT_EQ(only("a.jpg 250", ListFormat::kSeconds).seconds, 250);
  EXPECT_EQ(list_format_from_name("hdrgen"), ListFormat::kHdrgen);
  EXPECT_FALSE(list_format_from_name("debevec"));
}

TEST(ExposureList, BrightnessDecidesWhatTheSecondFieldMeans) {
  const std::string rising = "a 1\nb 10\nc 100\n";
  EXPECT_EQ(parse_exposure_list(rising, "LIST", ListFormat::kAuto, {10, 90, 200}).at(2).exposure.seconds, 100);
  EXPECT_EQ(parse_exposure_list(rising, "LIST", ListFormat::kAuto, {200, 90, 10}).at(2).exposure.seconds, 0.01);
  // One picture out of line (a passer-by) does not outvote the others; an unknown one does not vote.
  const Brightness mixed{200, std::nullopt, 10}, outlier{80, 90, 10};
  EXPECT_EQ(parse_exposure_list(rising, "LIST", ListFormat::kAuto, mixed).at(2).exposure.seconds, 0.01);
  EXPECT_EQ(parse_exposure_list(rising, "LIST", ListFormat::kAuto, outlier).at(2).exposure.seconds, 0.01);
  EXPECT_EQ(parse_exposure_list(rising, "LIST", ListFormat::kAuto, {}).at(2).exposure.seconds, 100) << "nothing known";
  // hdrgen's lists have an ISO speed where Debevec's have a gain in dB.
  const auto hdrgen = parse_exposure_list("a 10 8 100 0\nb 100 8 100 0\n", "LIST", ListFormat::kAuto, {200, 20});
  EXPECT_EQ(hdrgen.at(0).exposure.iso, 100);
  const auto debevec = parse_exposure_list("a 10 8 0 0\nb 100 8 0 0\n", "LIST", ListFormat::kAuto, {200, 20});
  EXPECT_DOUBLE_EQ(debevec.at(0).exposure.iso.value_or(0), 100);
  EXPECT_EQ(debevec.at(0).exposure.seconds, 0.1);
}

TEST(ExposureList, MistakesAreToldWithTheirLine) {
  const auto message = [](const std::string& text, ListFormat format = ListFormat::kAuto) {
    return error_of([&] { parse_exposure_list(text, "LIST", format); });
  };
  EXPECT_TRUE(message("a 1\n# fine\nb two\n").starts_with("LIST:3: 'two'")) << message("a 1\n# fine\nb two\n");
  for (const char* bad : {"a 1\nb 0\n", "a 1\nb -2\n", "a 1\nb nan\n", "a 1\nb inf\n", "a 1\nb\n", "a 1\nb 1 2 3 4 5\n",
                          "a 1\nb 1 0\n", "a 1\nb 1 8 -100\n", "a 1\nb 1 8 100 nan\n", "a 1\nb 1/0\n"}) {
    EXPECT_TRUE(message(bad).starts_with("LIST:2: ")) << bad << " -> " << message(bad);
  }
  EXPECT_TRUE(message("a 1\nb 0\n", ListFormat::kInverse).starts_with("LIST:2: shutter speed"));
  EXPECT_TRUE(message("3\na 1\nb 2\n").starts_with("LIST:1: says 3 pictures, but 2 follow"))
      << message("3\na 1\nb 2\n");
  EXPECT_TRUE(message("# nothing\n").starts_with("LIST: names no picture"));
}

}  // namespace
}  // namespace hdr

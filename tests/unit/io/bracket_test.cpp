#include "libhdr/io/bracket.h"

#include <cmath>
#include <filesystem>
#include <limits>

#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::ScratchDir;

/// A scene of 12 stops as a camera of gamma 2.2 sees it for `light` seconds, with a little noise of its own.
Photo shot_of_scene(double light, std::uint64_t seed, Size size = {120, 80}) {
  const Image<float> scene = test::test_scene(size.width, size.height, 12, 7);
  Random random(seed, 1);
  Photo photo;
  photo.exposure = {light, 8.0, 100.0, 0};
  Image<std::uint8_t> codes(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double level = std::clamp(light * scene(x, y, c) + 0.002 * random.normal(), 0.0, 1.0);
        codes(x, y, c) = static_cast<std::uint8_t>(std::lround(255 * std::pow(level, 1 / 2.2)));
      }
    }
  }
  photo.codes = std::move(codes);
  return photo;
}

/// Writes shots a.png, b.png ... of these times and returns their paths.
std::vector<Path> write_shots(const ScratchDir& scratch, const std::vector<double>& times) {
  std::vector<Path> paths;
  for (std::size_t i = 0; i < times.size(); ++i) {
    paths.push_back(scratch / (std::string(1, static_cast<char>('a' + i)) + ".png"));
    write_photo(paths.back(), shot_of_scene(times[i], i));
  }
  return paths;
}

std::vector<double> times_of(const Bracket& bracket) {
  std::vector<double> times;
  for (const Photo& shot : bracket.shots) times.push_back(shot.exposure.seconds.value());
  return times;
}

using Times = std::vector<double>;

TEST(Bracket, RisesInExposureWhateverTheOrder) {
  const ScratchDir scratch;
  const auto paths = write_shots(scratch, {0.5, 0.125, 2});
  const Bracket bracket = read_bracket(paths);
  EXPECT_EQ(times_of(bracket), (Times{0.125, 0.5, 2}));
  EXPECT_EQ(bracket.input_order, (std::vector<int>{1, 0, 2}));
  for (std::size_t k = 0; k < paths.size(); ++k) {
    EXPECT_EQ(bracket.shots[static_cast<std::size_t>(bracket.input_order[k])].path, paths[k]);
  }
  EXPECT_TRUE(bracket.warnings.empty());
  EXPECT_EQ(times_of(read_bracket({scratch.path()})), times_of(bracket)) << "a folder is its photographs";
}

TEST(Bracket, ApertureIsoAndTimeMakeTheExposure) {
  const ScratchDir scratch;
  // 1 s at f/8 lets in less than 1/2 s at f/4.
  Photo a = shot_of_scene(1, 0), b = shot_of_scene(2, 1);
  b.exposure = {0.5, 4.0, 100.0, 0};
  write_photo(scratch / "a.png", a);
  write_photo(scratch / "b.png", b);
  const Bracket bracket = read_bracket({scratch / "b.png", scratch / "a.png"});
  EXPECT_EQ(bracket.shots[0].path.filename(), "a.png");
  EXPECT_DOUBLE_EQ(bracket.shots[1].relative_exposure() / bracket.shots[0].relative_exposure(), 2);
}

TEST(Bracket, TiesAreOrderedByName) {
  const ScratchDir scratch;
  const auto paths = write_shots(scratch, {0.5, 0.5, 0.125});
  const Bracket bracket = read_bracket({paths[1], paths[0], paths[2]});
  EXPECT_EQ(bracket.shots[1].path, paths[0]);
  EXPECT_EQ(bracket.shots[2].path, paths[1]);
}

TEST(Bracket, TimesReplaceTheTimeOnlyAndMendStaleExif) {
  const ScratchDir scratch;
  auto paths = write_shots(scratch, {0.5, 0.125});
  Photo broken = shot_of_scene(2, 5);
  broken.exposure.seconds = 0.0;
  paths.push_back(scratch / "c.png");
  write_photo(paths[2], broken);
  EXPECT_NE(error_of([&] { read_bracket(paths); }).find("c.png: the exposure time in EXIF is 0"), std::string::npos);
  const Bracket bracket = read_bracket(paths, {.times = {0.4, 0.1, 1.6}, .exposures = {}});
  EXPECT_EQ(times_of(bracket), (Times{0.1, 0.4, 1.6}));
  EXPECT_EQ(bracket.shots[0].exposure.f_number, 8) << "--times replaces the time only";
}

TEST(Bracket, BadTimesAreErrors) {
  const ScratchDir scratch;
  const auto paths = write_shots(scratch, {0.5, 0.125});
  const auto message = [&](Times times) {
    return error_of([&] { read_bracket(paths, {.times = times, .exposures = {}}); });
  };
  EXPECT_NE(message({1, 2, 3}).find("3 times for 2 shots"), std::string::npos) << message({1, 2, 3});
  EXPECT_NE(message({1}).find("1 times for 2 shots"), std::string::npos);
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(message({1, bad}).find("time 2 is"), std::string::npos) << message({1, bad});
  }
}

TEST(Bracket, NoTimeAnywhereNamesTheFileAndTheRemedy) {
  const ScratchDir scratch;
  auto paths = write_shots(scratch, {0.5});
  Photo untold = shot_of_scene(2, 5);
  untold.exposure = {};
  paths.push_back(scratch / "untold.png");
  write_photo(paths[1], untold);
  const std::string message = error_of([&] { read_bracket(paths); });
  EXPECT_NE(message.find("untold.png: no exposure time in EXIF; pass --times"), std::string::npos) << message;
}

TEST(Bracket, EqualExposuresAreAnErrorUnlessAllowed) {
  const ScratchDir scratch;
  const auto paths = write_shots(scratch, {1.0 / 60, 1.0 / 60, 1.0 / 60});
  const std::string message = error_of([&] { read_bracket(paths); });
  EXPECT_NE(message.find("all 3 shots have the same exposure 1/60 s"), std::string::npos) << message;
  BracketOptions allow;
  allow.allow_equal_exposures = true;
  EXPECT_EQ(read_bracket(paths, allow).shots.size(), 3u);
  EXPECT_EQ(read_bracket({paths[0]}).shots.size(), 1u) << "one shot alone has nothing to differ from";
}

TEST(Bracket, WhatCannotBeABracketIsRefused) {
  const ScratchDir scratch;
  const auto paths = write_shots(scratch, {0.5, 0.125});
  write_photo(scratch / "small.png", shot_of_scene(2, 3, {60, 40}));
  write_photo(scratch / "deep.png", test::made_up_photo(120, 80, 16, 3, {2.0, 8.0, 100.0, 0}));
  fs::create_directory(scratch / "empty");
  fs::create_symlink(paths[0], scratch / "link.png");
  const auto message = [&](const std::vector<Path>& files) { return error_of([&] { read_bracket(files); }); };

  const std::string sizes = message({paths[0], scratch / "small.png"});
  EXPECT_NE(sizes.find("small.png: 60x40"), std::string::npos) << sizes;
  EXPECT_NE(sizes.find("a.png has 120x80"), std::string::npos) << sizes;
  EXPECT_NE(message({paths[0], scratch / "deep.png"}).find("deep.png: 16 bits, but"), std::string::npos);
  EXPECT_NE(message({paths[0], paths[0]}).find("a.png: named twice"), std::string::npos);
  EXPECT_NE(message({paths[0], scratch / "link.png"}).find("link.png: named twice (also as"), std::string::npos);
  EXPECT_NE(message({}).find("no photographs named"), std::string::npos);
  EXPECT_NE(message({scratch / "empty"}).find("empty: no photographs"), std::string::npos);
  EXPECT_NE(message({scratch / "absent.jpg"}).find("absent.jpg: no such file"), std::string::npos);
}

TEST(Bracket, ShotsTrimmedByHandShareTheirTopLeft) {
  const ScratchDir scratch;
  write_photo(scratch / "a.png", shot_of_scene(0.5, 0, {122, 80}));
  write_photo(scratch / "b.png", shot_of_scene(2, 1, {120, 83}));
  const Bracket bracket = read_bracket({scratch.path()});
  EXPECT_EQ(bracket.size(), (Size{120, 80}));
  ASSERT_EQ(bracket.warnings.size(), 1u);
  EXPECT_NE(bracket.warnings[0].find("122x83"), std::string::npos) << bracket.warnings[0];
  const Photo whole = read_photo(scratch / "b.png");
  const auto& kept = std::get<Image<std::uint8_t>>(bracket.shots[1].codes);
  EXPECT_EQ(kept(119, 79, 2), std::get<Image<std::uint8_t>>(whole.codes)(119, 79, 2)) << "coordinates stay";
}

TEST(Bracket, SettingsThatOnlySomeShotsHaveAreDroppedForAll) {
  const ScratchDir scratch;
  Photo a = shot_of_scene(0.125, 0), b = shot_of_scene(0.5, 1);
  a.exposure.f_number.reset();
  write_photo(scratch / "a.png", a);
  write_photo(scratch / "b.png", b);
  const Bracket bracket = read_bracket({scratch / "a.png", scratch / "b.png"});
  ASSERT_EQ(bracket.warnings.size(), 1u);
  EXPECT_EQ(bracket.warnings[0], "only 1 of 2 shots have an aperture; it is taken as constant");
  EXPECT_DOUBLE_EQ(bracket.shots[1].relative_exposure() / bracket.shots[0].relative_exposure(), 4);
}

TEST(Bracket, SettingsThatNoShotHasAreTakenAsConstant) {
  const ScratchDir scratch;
  for (const double t : {0.125, 0.5}) {
    Photo shot = shot_of_scene(t, 0);
    shot.exposure.f_number.reset();
    write_photo(scratch / (t < 0.2 ? "a.png" : "b.png"), shot);
  }
  const Bracket bracket = read_bracket({scratch.path()});
  ASSERT_EQ(bracket.warnings.size(), 1u);
  EXPECT_EQ(bracket.warnings[0], "no aperture in EXIF or the list; taken as constant");
}

TEST(Bracket, ALongerExposureThatIsDarkerIsAnErrorNamingBoth) {
  const ScratchDir scratch;
  const auto paths = write_shots(scratch, {0.01, 0.04, 0.16, 0.64});
  const auto with = [&](Times times) {
    return error_of([&] { read_bracket(paths, {.times = times, .exposures = {}}); });
  };
  EXPECT_EQ(with({0.01, 0.04, 0.16, 0.64}), "");
  for (const Times& wrong :
       {Times{0.64, 0.16, 0.04, 0.01}, Times{0.04, 0.01, 0.16, 0.64}, Times{0.01, 0.64, 0.16, 0.04}}) {
    EXPECT_NE(with(wrong).find("darker throughout"), std::string::npos);
  }
  const std::string swapped = with({0.04, 0.01, 0.16, 0.64});
  EXPECT_NE(swapped.find("a.png (1/25 s)"), std::string::npos) << swapped;
  EXPECT_NE(swapped.find("b.png (1/100 s)"), std::string::npos) << swapped;
}

/// Bracket of these pictures, named a.png, b.png ...: the error, if any.
std::string bracket_error(const ScratchDir& scratch, const std::vector<Image<std::uint8_t>>& pictures,
                          const Times& times) {
  std::vector<Path> paths;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    Photo photo;
    photo.exposure = {times[i], 8.0, 100.0, 0};
    photo.codes = pictures[i].clone();
    paths.push_back(scratch / (std::string(1, static_cast<char>('a' + i)) + ".png"));
    write_photo(paths.back(), photo);
  }
  return error_of([&] { read_bracket(paths); });
}

Image<std::uint8_t> noisy_grey(double mean, double sigma, std::uint64_t seed) {
  Image<std::uint8_t> image(120, 80, 3);
  Random random(seed, 2);
  for (int y = 0; y < 80; ++y) {
    for (int i = 0; i < 360; ++i) {
      image.row(y)[i] = static_cast<std::uint8_t>(std::clamp(mean + sigma * random.normal(), 0.0, 255.0));
    }
  }
  return image;
}

TEST(Bracket, DarknessIsNotSeenWhereThereIsNone) {
  const ScratchDir scratch;
  // All black, all white, or equal but for noise: nothing contradicts the times.
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    for (const double level : {0.0, 3.0, 100.0, 255.0}) {
      std::vector<Image<std::uint8_t>> pictures;
      for (std::uint64_t k = 0; k < 2; ++k) pictures.push_back(noisy_grey(level, 6, 2 * seed + k));
      EXPECT_EQ(bracket_error(scratch, pictures, {0.1, 0.4}), "") << "level " << level << " seed " << seed;
    }
  }
  // A tenth of a stop may drown in the flicker of a lamp.
  std::vector<Image<std::uint8_t>> flicker;
  flicker.push_back(noisy_grey(105, 6, 1));
  flicker.push_back(noisy_grey(100, 6, 2));
  EXPECT_EQ(bracket_error(scratch, flicker, {0.1, 0.107}), "");
  // Somebody in white walks through the short exposure only.
  std::vector<Image<std::uint8_t>> passer_by;
  for (std::uint64_t k = 0; k < 2; ++k) passer_by.push_back(noisy_grey(k == 0 ? 20 : 60, 3, k));
  for (int y = 20; y < 80; ++y) std::fill_n(passer_by[0].pixel(40, y), 3 * 40, std::uint8_t{220});
  EXPECT_EQ(bracket_error(scratch, passer_by, {0.1, 0.4}), "");
}

TEST(Bracket, AListReplacesExposuresByNameOrStem) {
  const ScratchDir scratch;
  const auto paths = write_shots(scratch, {0.01, 0.04, 0.16});
  write_text(scratch / "list", "# name seconds\nelsewhere/a.ppm 1\nb.png 4\nc.png 16 8 100\nunused.png 99\n");
  const Bracket bracket = read_bracket(paths, {.times = {}, .exposures = scratch / "list"});
  EXPECT_EQ(times_of(bracket), (Times{1, 4, 16}));
  EXPECT_FALSE(bracket.shots[2].exposure.f_number) << "only one of three had an aperture";
  write_text(scratch / "list", "a.png 100\nb.png 25\nc.png 6.25\n");  // the pictures brighten while the field falls
  EXPECT_EQ(times_of(read_bracket(paths, {.times = {}, .exposures = scratch / "list"})), (Times{0.01, 0.04, 0.16}));
  write_text(scratch / "list", "x.png 100\n");
  EXPECT_NE(error_of([&] { read_bracket(paths, {.times = {}, .exposures = scratch / "list"}); }).find("names none"),
            std::string::npos);
  // A shot that the list leaves out keeps its EXIF.
  write_text(scratch / "list", "a.png 0.02\n");
  EXPECT_EQ(times_of(read_bracket(paths, {.times = {}, .exposures = scratch / "list"})), (Times{0.02, 0.04, 0.16}));
}

}  // namespace
}  // namespace hdr

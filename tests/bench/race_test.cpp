// The race is fair: answers first, then times.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/bench/advice.h"
#include "tests/bench/bench.h"
#include "tests/bench/peak_memory.h"
#include "tests/bench/suites/suite.h"

namespace hdr::bench {
namespace {

Row row_of(const std::string& subject) {
  Row row{"test", "a stage", subject, "knob"};
  row.value = 1;
  row.error_name = "rms";
  row.error_unit = "%";
  return row;
}

TEST(Race, ARivalWithAWrongAnswerIsNotTimed) {
  int right_runs = 0, wrong_runs = 0, nan_runs = 0;
  Bench bench({true, {}, {}});
  bench.race({{row_of("hdr"), [&] { ++right_runs; }, [] { return 2.0; }, 10},
              {row_of("rival"), [&] { ++wrong_runs; }, [] { return 90.0; }, 10},
              {row_of("other rival"), [&] { ++nan_runs; }, [] { return std::nan(""); }, 10}});
  ASSERT_EQ(bench.rows().size(), 3u);
  const Row &right = bench.rows()[0], &wrong = bench.rows()[1], &not_a_number = bench.rows()[2];
  EXPECT_TRUE(right.timed());
  EXPECT_GT(right_runs, 1);
  EXPECT_TRUE(right.note.empty()) << right.note;
  EXPECT_EQ(wrong_runs, 1) << "once, to be checked";
  EXPECT_FALSE(wrong.timed());
  EXPECT_TRUE(std::isnan(wrong.wall_seconds));
  EXPECT_EQ(wrong.error, 90);
  EXPECT_NE(wrong.note.find("wrong"), std::string::npos) << wrong.note;
  EXPECT_EQ(nan_runs, 1);
  EXPECT_FALSE(not_a_number.timed());
}

TEST(Race, ARivalThatFailsIsARowThatSaysWhy) {
  Bench bench({true, {}, {}});
  bench.race({{row_of("rival"), [] { throw Error("rival failed: no display"); }, [] { return 0.0; }, 10}});
  ASSERT_EQ(bench.rows().size(), 1u);
  EXPECT_FALSE(bench.rows()[0].timed());
  EXPECT_NE(bench.rows()[0].note.find("no display"), std::string::npos);
}

TEST(Race, WorkThatFailsWhenItIsTimedIsARowThatSaysWhy) {
  int runs = 0;
  Bench bench({true, {}, {}});
  bench.race({{row_of("rival"),
               [&] {
                 if (++runs > 1) throw Error("the disk is full");
               },
               [] { return 0.0; }, 10},
              {row_of("hdr"), [] {}, [] { return 0.0; }, 10}});
  ASSERT_EQ(bench.rows().size(), 2u);
  EXPECT_FALSE(bench.rows()[0].timed());
  EXPECT_EQ(runs, 2) << "not again";
  EXPECT_NE(bench.rows()[0].note.find("the disk is full"), std::string::npos);
  EXPECT_TRUE(bench.rows()[1].timed()) << "the others race on";
}

TEST(Bench, APartThatCannotBeSetUpIsARowThatSaysWhy) {
  Bench bench({true, {}, {}});
  bench.attempt("render", "by method", [] { throw Error("this build has no `hdr render --method prt`"); });
  bench.attempt("render", "by size", [&] { bench.race({{row_of("hdr"), [] {}}}); });
  ASSERT_EQ(bench.rows().size(), 2u);
  EXPECT_FALSE(bench.rows()[0].timed());
  EXPECT_EQ(bench.rows()[0].suite, "render");
  EXPECT_EQ(bench.rows()[0].note, "not timed: this build has no `hdr render --method prt`");
  EXPECT_TRUE(bench.rows()[1].timed());
}

TEST(Race, TimesAreThoseOfTheWork) {
  volatile double sink = 0;
  const auto work = [&sink](int rounds) {
    return [&sink, rounds] {
      for (int k = 0; k < rounds; ++k) sink = sink + std::sqrt(k);
    };
  };
  Bench bench({true, {}, {}});
  bench.race({{row_of("once"), work(2'000'000)}, {row_of("ten times"), work(20'000'000)}});
  const double ratio = bench.rows()[1].cpu_seconds / bench.rows()[0].cpu_seconds;
  EXPECT_GT(ratio, 5);
  EXPECT_LT(ratio, 20);
  EXPECT_LE(bench.rows()[0].cpu_seconds, bench.rows()[0].median_cpu_seconds);
}

TEST(Race, MemoryIsThatOfTheWork) {
  if (PeakMemory().bytes() < 0) GTEST_SKIP() << "this system does not forget its high-water mark";
  Bench bench({true, {}, {}});
  const auto fill = [](std::size_t bytes) {
    return [bytes] {
      std::vector<char> all(bytes, 1);
      [[maybe_unused]] static volatile char sink;
      sink = all[bytes / 2];
    };
  };
  bench.race({{row_of("much"), fill(200u << 20)}, {row_of("little"), fill(1u << 10)}});
  EXPECT_NEAR(static_cast<double>(bench.rows()[0].peak_bytes), 200.0 * (1 << 20), 30.0 * (1 << 20));
  EXPECT_LT(bench.rows()[1].peak_bytes, 30 << 20) << "what came before counts";
}

TEST(Csv, HasAColumnForEachFieldAndQuotesWhatNeedsIt) {
  Row row = row_of("a \"rival\", quoted");
  row.error = 0.25;
  const std::string text = csv_of({row});
  const std::string names = text.substr(0, text.find('\n'));
  EXPECT_EQ(names,
            "suite,stage,subject,knob,value,error,error_name,error_unit,cpu_seconds,median_cpu_seconds,wall_seconds,"
            "peak_bytes,megapixels,threads,note,setting");
  EXPECT_NE(text.find("test,a stage,\"a \"\"rival\"\", quoted\",knob,1,0.25,rms,%,,,,,,0,,\n"), std::string::npos)
      << text;
}

TEST(Advice, IsTheCheapestSettingWithinTheTarget) {
  std::vector<Row> rows;
  const auto add = [&](const std::string& subject, double error, double cpu, const std::string& setting) {
    Row row = row_of(subject);
    row.error = error;
    row.cpu_seconds = cpu;
    row.setting = setting;
    rows.push_back(row);
  };
  add("hdr", 40, 0.1, "hdr sh --degree 0");
  add("hdr", 4, 0.3, "hdr sh --degree 2");
  add("hdr", 1, 0.9, "hdr sh --degree 4");
  add("rival", 3, 2, "");
  add("hdr reference", 1, 0.01, "");
  const Suite suite{"test", "", nullptr, {5, "%"}};
  const std::string words = advice_of(suite, rows);
  EXPECT_NE(words.find("For 5 %: `hdr sh --degree 2` (4 %, 300 ms CPU)"), std::string::npos) << words;
  EXPECT_NE(words.find("rival"), std::string::npos) << words;
  const std::string out_of_reach = advice_of({"test", "", nullptr, {0.5, "%"}}, rows);
  EXPECT_NE(out_of_reach.find("is not reached; closest: `hdr sh --degree 4`"), std::string::npos) << out_of_reach;
}

TEST(Numbers, AreShortAndPlain) {
  EXPECT_EQ(short_number(1.5234), "1.52");
  EXPECT_EQ(short_number(0.031416), "0.0314");
  EXPECT_EQ(short_number(1234.5), "1234");
  EXPECT_EQ(short_number(2.1e-8), "2.1e-08");
  EXPECT_EQ(short_number(100), "100");
  EXPECT_EQ(short_seconds(0.00035), "350 us");
  EXPECT_EQ(short_seconds(1.25), "1.25 s");
  EXPECT_EQ(short_bytes(275'000'000), "275 MB");
}

TEST(Suites, AreThoseOfTheContractAndHaveNamesOfTheirOwn) {
  for (const char* name :
       {"calibrate", "merge", "align", "unwrap", "sh", "lights", "render", "capture-plan", "files"}) {
    EXPECT_NE(find_suite(name), nullptr) << name;
  }
  EXPECT_EQ(find_suite("no such"), nullptr);
}

}  // namespace
}  // namespace hdr::bench

#include "tools/hdr/report/plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

#include "tests/support/markup.h"

namespace hdr::report {
namespace {

std::string labels(const std::vector<Tick>& ticks) {
  std::string text;
  for (const Tick& tick : ticks) {
    if (!tick.label.empty()) text += (text.empty() ? "" : " ") + tick.label;
  }
  return text;
}

TEST(Ticks, AreRoundNumbersWithinTheEnds) {
  EXPECT_EQ(labels(linear_ticks(-0.03, 1.02, 5)), "0 0.2 0.4 0.6 0.8 1");
  EXPECT_EQ(labels(linear_ticks(-7, 5.2, 6)), "−6 −4 −2 0 2 4");
  EXPECT_EQ(labels(linear_ticks(1000, 1004, 4)), "1000 1001 1002 1003 1004");
  EXPECT_EQ(labels(log_ticks(0.9, 1100, 6)), "1 10 100 1000");
  EXPECT_EQ(labels(log_ticks(3, 60, 6)), "5 10 20 50");
  EXPECT_EQ(labels(log_ticks(1e-12, 1e12, 6)), "10⁻¹² 10⁻⁸ 10⁻⁴ 1 10⁴ 10⁸ 10¹²");
}

TEST(Ticks, AnyRangeHasSomeAndNotTooMany) {
  for (double low : {-1e9, -3.7, 0.0, 1e-9, 5.0, 123456.0}) {
    for (double span : {1e-6, 0.013, 1.0, 9.99, 4e7}) {
      if (span < 1e-9 * std::abs(low)) continue;
      const auto ticks = linear_ticks(low, low + span, 6);
      EXPECT_GE(ticks.size(), 3u) << low << " " << span;
      EXPECT_LE(ticks.size(), 12u) << low << " " << span;
    }
  }
}

Plot one(Series series) {
  Plot plot;
  plot.title = "p";
  plot.series = {std::move(series)};
  return plot;
}

/// The d of the only line.
std::string path_of(const std::string& svg) {
  std::smatch found;
  const std::regex path(R"re(class="line[^"]*" data-name="s" d="([^"]*)")re");
  return std::regex_search(svg, found, path) ? found[1].str() : "";
}

TEST(Plot, AGapWhereAValueIsNone) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const std::string line =
      path_of(html_of(one({"s", Mark::kLine, Colour::kInk, {0, 1, 2, 3, 4, 5}, {1, 2, nan, 4, inf, 3}})));
  EXPECT_EQ(std::count(line.begin(), line.end(), 'M'), 3);
  EXPECT_EQ(line.find("nan"), std::string::npos);
  Plot log = one({"s", Mark::kLine, Colour::kInk, {0, 1, 2}, {1, 0, 100}});
  log.y.log = true;
  const std::string broken = path_of(html_of(log));
  EXPECT_EQ(std::count(broken.begin(), broken.end(), 'M'), 2) << "zero has no logarithm";
}

TEST(Plot, PutsDataWhereTheAxesSay) {
  Plot plot = one({"s", Mark::kLine, Colour::kInk, {1, 1000}, {0, 10}});
  plot.x = {"x", true, 1, 1000};
  plot.y = {"y", false, 0, 10};
  const std::string svg = html_of(plot);
  std::smatch frame, line;
  ASSERT_TRUE(std::regex_search(
      svg, frame, std::regex(R"re(class="frame" x="([0-9.]+)" y="([0-9.]+)" width="([0-9.]+)" height="([0-9.]+)")re")));
  const std::string path = path_of(svg);
  ASSERT_TRUE(std::regex_search(path, line, std::regex(R"re(M([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+))re")));
  const auto f = [&](int k) { return std::stod(frame[k]); };
  const auto p = [&](int k) { return std::stod(line[k]); };
  EXPECT_NEAR(p(1), f(1), 0.11);
  EXPECT_NEAR(p(2), f(2) + f(4), 0.11);
  EXPECT_NEAR(p(3), f(1) + f(3), 0.11);
  EXPECT_NEAR(p(4), f(2), 0.11);
}

// One measured point must be readable off both axes, wherever it lies.
TEST(Plot, ASinglePointHasMarkedAxes) {
  const std::regex label("<text x=[^>]*>[^<]+</text>");
  for (double value = 1.07e-5; value < 1e5; value *= 1.37) {
    Plot plot = one({"s", Mark::kPoints, Colour::kInk, {value}, {1 / value}});
    plot.x.log = plot.y.log = true;
    const std::string svg = html_of(plot);
    const auto count = std::distance(std::sregex_iterator(svg.begin(), svg.end(), label), std::sregex_iterator());
    EXPECT_GE(count, 4) << "labels, of both axes, around " << value;
  }
}

TEST(Plot, EveryMarkIsWellFormedEvenWithoutData) {
  for (const Mark mark : {Mark::kLine, Mark::kPoints, Mark::kSteps, Mark::kBand, Mark::kSpans, Mark::kArrows}) {
    for (const std::size_t count : {0u, 1u, 3u}) {
      for (const bool log : {false, true}) {
        Series series{"a<b", mark, Colour::kGreen, {}, {}, {}, {}, 1, 0, {"note <1>"}};
        for (std::size_t k = 0; k < count; ++k) {
          series.x.push_back(static_cast<double>(k));
          series.y.push_back(static_cast<double>(k * k));
        }
        series.low = series.high = series.y;
        if (mark == Mark::kSteps && count > 0) series.x.push_back(static_cast<double>(count));
        Plot plot = one(series);
        plot.x.log = log;
        const std::string html = "<!DOCTYPE html>\n<div>" + html_of(plot) + "</div>";
        EXPECT_EQ(test::fault_of_page(html), "") << static_cast<int>(mark) << " " << count;
        EXPECT_EQ(html.find("nan"), std::string::npos) << html;
        EXPECT_EQ(html.find("inf"), std::string::npos) << html;
      }
    }
  }
}

}  // namespace
}  // namespace hdr::report

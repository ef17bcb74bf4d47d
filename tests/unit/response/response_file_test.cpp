#include "libhdr/response/response_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

std::string message(const std::string& text, const Path& path, int bits = 8) {
  try {
    response_from_text(text, path, bits);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// A matrix as pfshdrcalibrate prints it: exposure(code), 0 for codes that it does not know.
template <class Exposure>
std::string matrix(const std::string& name, int rows, const Exposure& exposure) {
  std::string text = "# Camera response curve, channel " + name +
                     "\n# data layout: log10(response) | camera output | response\n# name: " + name +
                     "\n# type: matrix\n# rows: " + std::to_string(rows) + "\n# columns: 3\n";
  for (int code = 0; code < rows; ++code) {
    const double e = exposure(code);
    char line[80];
    std::snprintf(line, sizeof line, " %e %4d %e\n", e > 0 ? std::log10(e) : -6.0, code, e);
    text += line;
  }
  return text + "\n";
}

template <class Exposure>
std::string pfstools_file(int rows, const Exposure& exposure) {
  return matrix("IR", rows, exposure) + matrix("IG", rows, exposure) + matrix("IB", rows, exposure) +
         "# Weighting function\n# data layout: weight | camera output\n# name: W\n# type: matrix\n# rows: 1\n"
         "# columns: 2\n 1.000000e+00    0\n\n";
}

template <class Exposure>
std::string alicevision_file(int rows, const Exposure& exposure) {
  std::string text = "response,Red,Green,Blue,\n";
  for (int row = 0; row < rows; ++row) {
    const std::string e = std::to_string(exposure(row));  // six decimals, as AliceVision writes
    text += std::to_string(row) + "," + e + "," + e + "," + e + ",\n";
  }
  return text;
}

struct File {
  const char* name;
  int bits;
  double tolerance;  ///< ln, codes 1 and up
};

void PrintTo(const File& file, std::ostream* out) {
  *out << file.name << ", " << file.bits << " bits";
}

class ResponseFile : public testing::TestWithParam<File> {};

TEST_P(ResponseFile, RoundTrip) {
  const File file = GetParam();
  for (const char* name : {"film", "srgb", "linear", "gamma:2.2"}) {
    const Response response = *response_from_name(name, file.bits);
    const Response again = response_from_text(text_from_response(response, file.name), file.name, file.bits);
    EXPECT_EQ(again.bits, file.bits);
    for (int c = 0; c < 3; ++c) {
      ASSERT_EQ(again.levels(), response.levels());
      EXPECT_EQ(again.g[static_cast<std::size_t>(c)][static_cast<std::size_t>(again.levels() / 2)], 0);
      const int last = (1 << file.bits) - 1;
      for (int code = 1; code <= last; code += file.bits == 8 ? 1 : 37) {
        ASSERT_NEAR(again.ln_exposure(c, code), response.ln_exposure(c, code), file.tolerance)
            << name << ", channel " << c << ", code " << code;
      }
      EXPECT_NEAR(again.ln_exposure(c, 0), response.ln_exposure(c, 0), file.tolerance) << name << ": code 0";
    }
  }
}

// 10 and 12 bits have samples between or at codes; the 4096 rows of a 16-bit .csv and the 4096 samples of a Response do
// not stand at the same codes, and interpolation between them is felt where a gamma is steepest.
INSTANTIATE_TEST_SUITE_P(Files, ResponseFile,
                         testing::Values(File{"r.json", 8, 0}, File{"r.json", 16, 0}, File{"r.m", 8, 1e-8},
                                         File{"R.M", 12, 1e-8}, File{"r.m", 16, 1e-8}, File{"r.csv", 8, 1e-8},
                                         File{"r.CSV", 12, 1e-8}, File{"r.csv", 16, 0.05}));

// pfstools' own linear start: I = m / 255, so that code 0 has no exposure.
TEST(PfstoolsResponse, ReadsWhatPfshdrcalibrateWrites) {
  const Response read = response_from_text(pfstools_file(256, [](int code) { return code / 255.0; }), "cam.m", 8);
  const Response linear = linear_response(8);
  EXPECT_EQ(read.bits, 8);
  for (int code = 0; code < 256; ++code) {
    ASSERT_NEAR(read.ln_exposure(1, code), linear.ln_exposure(1, code), 1e-5) << "code " << code;
  }
}

TEST(PfstoolsResponse, WritesWhatOctaveAndPfstoolsRead) {
  std::istringstream lines(text_from_response(linear_response(8), "cam.m"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "# Camera response curve, channel IR");
  std::getline(lines, line);
  std::getline(lines, line);
  EXPECT_EQ(line, "# name: IR");
  std::getline(lines, line);
  EXPECT_EQ(line, "# type: matrix");
  std::getline(lines, line);
  EXPECT_EQ(line, "# rows: 256");
  std::getline(lines, line);
  EXPECT_EQ(line, "# columns: 3");
  // responseLoad of pfstools: three numbers a row, the middle one the code.
  for (int code = 0; code < 256; ++code) {
    float log10 = 0, exposure = 0;
    int number = -1;
    std::getline(lines, line);
    ASSERT_EQ(std::sscanf(line.c_str(), " %f %d %f", &log10, &number, &exposure), 3) << line;
    ASSERT_EQ(number, code);
    ASSERT_NEAR(std::pow(10.0, log10), exposure, 1e-5 * exposure);
    if (code > 0) {
      ASSERT_NEAR(exposure, code / 128.0, 1e-5) << "1 at the middle code";
    }
  }
  std::getline(lines, line);
  EXPECT_EQ(line, "") << "a blank line ends a matrix";
}

// Robertson's method in pfstools leaves 0 where no pixel had a code, and wiggles.
TEST(PfstoolsResponse, FillsGapsAndPoolsWhatFalls) {
  const auto exposure = [](int code) {
    if (code < 3 || code > 250 || (code >= 100 && code < 110)) return 0.0;
    return code / 255.0 + (code == 60 ? 0.02 : 0.0);  // more than codes 61 .. 65
  };
  const Response read = response_from_text(pfstools_file(256, exposure), "cam.m", 8);
  EXPECT_TRUE(std::is_sorted(read.g[0].begin(), read.g[0].end()));
  for (const int code : {1, 2, 40, 104, 200}) EXPECT_NEAR(read.exposure(0, code), code / 128.0, 1e-5) << code;
  EXPECT_NEAR(read.exposure(0, 255), 255 / 128.0, 0.01) << "rising on";
  EXPECT_NEAR(read.exposure(0, 62), 62 / 128.0, 0.03);
}

TEST(AliceVisionResponse, ReadsItsRowsAsShareOfTheLargestCode) {
  // 1024 rows, as its 10-bit quantisation has, of a gamma of 2.
  const std::string text = alicevision_file(1024, [](int row) { return row * row / (1023.0 * 1023.0); });
  for (const int bits : {8, 16}) {
    const Response read = response_from_text(text, "response.csv", bits);
    EXPECT_EQ(read.bits, bits);
    const Response truth = gamma_response(bits, 2);
    for (const double share : {0.1, 0.3, 0.5, 0.9, 1.0}) {
      const double code = std::floor(share * std::ldexp(1.0, bits) - 1e-9);
      EXPECT_NEAR(read.ln_exposure(0, code), truth.ln_exposure(0, code), 0.002) << bits << " bits, code " << code;
    }
  }
}

// Between equal rows lies the same value, whatever the rounding of its two shares.
TEST(AliceVisionResponse, APlateauDoesNotFall) {
  const std::string text = alicevision_file(1000, [](int row) { return (row / 7 * 7 + 1) / 1000.0; });
  const std::vector<double> g = response_from_text(text, "response.csv", 16).g[0];
  for (std::size_t k = 1; k < g.size(); ++k) ASSERT_GE(g[k], g[k - 1]) << "level " << k;
}

TEST(AliceVisionResponse, WritesItsColumns) {
  std::istringstream lines(text_from_response(film_response(8), "response.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "response,Red,Green,Blue,");
  double largest = 0;
  int rows = 0;
  for (; std::getline(lines, line); ++rows) {
    int index = -1;
    float r = 0, g = 0, b = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%f,%f,%f,", &index, &r, &g, &b), 4) << line;
    ASSERT_EQ(index, rows);
    largest = std::max({largest, double{r}, double{g}, double{b}});
  }
  EXPECT_EQ(rows, 256);
  EXPECT_NEAR(largest, 1, 1e-6);
}

TEST(ResponseFiles, ABadFileIsAnErrorThatNamesItAndTheLine) {
  const std::string good = pfstools_file(256, [](int code) { return code / 255.0; });
  const auto with = [&](const std::string& what, const std::string& instead) {
    std::string text = good;
    return text.replace(text.find(what), what.size(), instead);
  };
  EXPECT_NE(message("", "cam.m").find("cam.m: no matrix IR"), std::string::npos);
  EXPECT_NE(message(with("# name: IB", "# name: XX"), "cam.m").find("no matrix IB"), std::string::npos);
  EXPECT_NE(message(with("# columns: 3", "# columns: 7"), "cam.m").find("cam.m:6: a response has 3"),
            std::string::npos);
  EXPECT_NE(message(with("# rows: 256", "# rows: 300"), "cam.m").find("cam.m:"), std::string::npos);
  EXPECT_NE(message(with("# rows: 256", "# rows: x"), "cam.m").find("cam.m:5: 'x' is not"), std::string::npos);
  EXPECT_NE(message(with("    7 ", " 7000 "), "cam.m").find("cam.m:14: not a row"), std::string::npos)
      << message(with("    7 ", " 7000 "), "cam.m");
  EXPECT_NE(message(good.substr(0, 4000), "cam.m").find("not a row"), std::string::npos) << "cut short";
  EXPECT_NE(message(pfstools_file(100, [](int code) { return code; }), "cam.m").find("100 rows"), std::string::npos);
  EXPECT_NE(message(pfstools_file(256, [](int) { return 0; }), "cam.m").find("no exposure is positive"),
            std::string::npos);
  EXPECT_NE(message(pfstools_file(256, [](int) { return 1; }), "cam.m").find("flat"), std::string::npos);

  const std::string csv = alicevision_file(256, [](int row) { return row / 255.0; });
  EXPECT_EQ(message(csv, "cam.csv"), "no error");
  EXPECT_NE(message("", "cam.csv").find("cam.csv: 0 rows"), std::string::npos);
  EXPECT_NE(message(csv + "256,1\n", "cam.csv").find("cam.csv:258: not a row"), std::string::npos);
  EXPECT_NE(message(csv + "256,1,nan,1,\n", "cam.csv").find("'nan'"), std::string::npos);
  EXPECT_NE(message(csv + "256,1,-1,1,\n", "cam.csv").find("'-1'"), std::string::npos);
  EXPECT_NE(message(csv, "cam.json").find("cam.json: not JSON"), std::string::npos);
}

}  // namespace
}  // namespace hdr

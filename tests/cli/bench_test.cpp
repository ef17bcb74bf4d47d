// hdr bench: its rows as JSON and as a table.
#include "tests/cli/fixture.h"
#include "tests/support/markup.h"

namespace hdr::test {
namespace {

void expect_row(const Json& row) {
  for (const char* key : {"suite", "stage", "subject", "knob", "error_name", "error_unit", "note", "setting"}) {
    EXPECT_TRUE(row.contains(key) && row[key].is_string()) << key << " in " << row.dump();
  }
  for (const char* key :
       {"error", "cpu_seconds", "median_cpu_seconds", "wall_seconds", "peak_bytes", "megapixels", "threads"}) {
    EXPECT_TRUE(row.contains(key) && (row[key].is_number() || row[key].is_null())) << key << " in " << row.dump();
  }
  EXPECT_TRUE(row.contains("value") && (row["value"].is_number() || row["value"].is_string())) << row.dump();
  if (row["cpu_seconds"].is_number()) {
    EXPECT_GT(row["wall_seconds"].get<double>(), 0) << row.dump();
    EXPECT_LE(row["cpu_seconds"].get<double>(), row["median_cpu_seconds"].get<double>()) << row.dump();
  } else {
    EXPECT_NE(row["note"].get<std::string>().find("not timed"), std::string::npos) << row.dump();
  }
}

TEST(Bench, RowsHaveErrorsAndTimes) {
  const ScratchDir scratch;
  const std::string csv = (scratch / "rows.csv").string();
  const std::string page = (scratch / "report.html").string();
  const Json answer = answer_of({"bench", "sh", "lights", "--quick", "--csv", csv, "-o", page});
  const Json& rows = answer["rows"];
  ASSERT_GE(rows.size(), 20u);
  std::vector<double> errors;
  bool has_reference = false;
  for (const Json& row : rows) {
    expect_row(row);
    const bool ours = row["subject"] == "hdr" && row["knob"] == "degree";
    if (ours) errors.push_back(row["error"].get<double>());
    has_reference = has_reference || row["subject"] == "hdr reference";
  }
  EXPECT_TRUE(has_reference);
  ASSERT_GE(errors.size(), 5u);
  EXPECT_GT(errors.front(), 10) << "degree 0 of a sunny sky";
  EXPECT_LT(errors.back(), 2);
  for (std::size_t k = 1; k < errors.size(); ++k) {  // an odd degree adds nothing [Ramamoorthi01]
    EXPECT_LE(errors[k], 1.001 * errors[k - 1]) << "more degrees, less error";
  }
  EXPECT_TRUE(answer["advice"].contains("lights"));
  EXPECT_FALSE(answer["machine"]["processor"].get<std::string>().empty());
  ASSERT_EQ(answer["stages"].size(), 3u) << "a suite each, and the report";
  EXPECT_EQ(answer["stages"][0]["name"], "sh");
  EXPECT_EQ(answer["stages"][2]["name"], "report");
  const std::string table = bytes_of(csv);
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')), rows.size() + 1);
  const std::string html = bytes_of(page);
  EXPECT_EQ(fault_of_page(html), "");
  for (const char* words :
       {"Which setting to use", "error (%)", "CPU time (s)", "picture (megapixels)", "hdr reference"}) {
    EXPECT_NE(html.find(words), std::string::npos) << words;
  }
}

TEST(Bench, AnUnknownSuiteIsMisuse) {
  const CommandResult result = run_hdr({"bench", "astrology", "--quick"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("astrology"), std::string::npos) << result.err;
}

TEST(Bench, HelpNamesTheSuites) {
  const std::string help = run_hdr({"bench", "--help"}).out;
  for (const char* suite :
       {"calibrate", "merge", "align", "unwrap", "sh", "lights", "render", "capture-plan", "files"}) {
    EXPECT_NE(help.find(suite), std::string::npos) << suite;
  }
}

}  // namespace
}  // namespace hdr::test

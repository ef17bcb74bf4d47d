// --report: a page with its sections, and nothing else changes.
#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"
#include "tests/support/markup.h"

namespace hdr::test {
namespace {

class Report : public ::testing::Test {
 protected:
  void SetUp() override {
    write_world(at("world.exr"));
    answer_of({"simulate", at("world.exr"), "-o", at("shots"), "--ball", "--size", "400x300", "--times",
               "1/1000,1/250,1/60,1/15,1/4", "--shift", "2"});
  }
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }
  void expect_page(const std::string& name, const std::vector<std::string>& sections) const {
    const std::string html = bytes_of(at(name));
    EXPECT_EQ(fault_of_page(html), "") << name;
    for (const std::string& section : sections) {
      EXPECT_NE(html.find("<section id=\"" + section + "\">"), std::string::npos) << name << " lacks " << section;
    }
  }

  ScratchDir scratch_;
};

TEST_F(Report, OfEveryVerbHasItsSections) {
  answer_of({"calibrate", at("shots"), "-o", at("r.json"), "--report", at("calibrate.html")});
  expect_page("calibrate.html", {"response", "exposures", "alignment", "time"});
  answer_of({"probe", at("shots"), "-o", at("probe.exr"), "--width", "128", "--report", at("probe.html")});
  expect_page("probe.html", {"probe", "ball", "map", "coverage", "shots", "alignment", "response", "exposures", "time"});
  EXPECT_NE(bytes_of(at("probe.html")).find("<circle class=\"c1\""), std::string::npos) << "the ball";
  EXPECT_NE(bytes_of(at("probe.html")).find("degrees off"), std::string::npos) << "what its distance leaves in doubt";
  const Json render = answer_of({"render", "--probe", at("probe.exr"), "-o", at("render.exr"), "--size", "64x48",
                                 "--samples", "8", "--report", at("render.html")});
  expect_page("render.html", {"picture-section", "error-section", "time"});
  EXPECT_EQ(render["stages"].back()["name"], "report");
}

TEST_F(Report, ChangesNoByteOfTheResult) {
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--uncertainty"}, {"--deghost"}}) {
    std::vector<std::string> plain = {"merge", at("shots"), "-o", at("plain.exr")}, told = plain;
    told[3] = at("told.exr");
    for (auto* arguments : {&plain, &told}) arguments->insert(arguments->end(), more.begin(), more.end());
    told.insert(told.end(), {"--report", at("merge.html")});
    answer_of(plain);
    answer_of(told);
    EXPECT_EQ(bytes_of(at("plain.exr")), bytes_of(at("told.exr")));
    expect_page("merge.html", {"map", "coverage", "shots", "alignment", "response", "time"});
  }
  answer_of({"probe", at("shots"), "-o", at("plain.exr"), "--width", "128"});
  answer_of({"probe", at("shots"), "-o", at("told.exr"), "--width", "128", "--report", at("probe.html")});
  EXPECT_EQ(bytes_of(at("plain.exr")), bytes_of(at("told.exr")));
}

TEST_F(Report, IsTheSameForTheSameWorkButForItsTimes) {
  for (const char* threads : {"1", "2"}) {
    answer_of({"merge", at("shots"), "-o", at("map.exr"), "--threads", threads, "--report",
               at(std::string("r") + threads + ".html")});
  }
  const auto before_times = [&](const char* name) {
    const std::string html = bytes_of(at(name));
    return html.substr(0, html.find("<section id=\"time\">"));
  };
  EXPECT_EQ(before_times("r1.html"), before_times("r2.html"));
  EXPECT_GT(before_times("r1.html").size(), 100000u);
}

TEST_F(Report, SaysBeforeTheWorkThatItCannotBeWritten) {
  expect_refusal({"merge", at("shots"), "-o", at("map.exr"), "--report", at("nowhere/r.html")}, {"nowhere"});
  EXPECT_FALSE(std::filesystem::exists(at("map.exr")));
}

TEST_F(Report, NamesOfFilesAreNoMarkup) {
  std::filesystem::rename(at("shots"), at("a"));
  std::filesystem::create_directory(at("shots"));
  for (const auto& entry : std::filesystem::directory_iterator(at("a"))) {
    if (entry.path().extension() == ".jpg") {
      std::filesystem::rename(entry.path(), at("shots") + "/<b onx=\"1\">&'" + entry.path().filename().string());
    }
  }
  answer_of({"merge", at("shots"), "-o", at("map.exr"), "--report", at("r.html")});
  expect_page("r.html", {"shots"});
  EXPECT_EQ(bytes_of(at("r.html")).find("<b onx"), std::string::npos);
}

}  // namespace
}  // namespace hdr::test

#include "tools/hdr/report/page.h"

#include "libhdr/core/error.h"
#include "libhdr/io/output_file.h"
#include "tests/support/markup.h"
#include "tests/support/support.h"
#include "tools/hdr/report/assets.h"
#include "tools/hdr/report/html.h"
#include "tools/hdr/report/plot.h"

namespace hdr::report {
namespace {

TEST(Escaped, NothingOfATextIsMarkup) {
  EXPECT_EQ(escaped("<b>\"R&D\" 'x'</b>"), "&lt;b&gt;&quot;R&amp;D&quot; &#39;x&#39;&lt;/b&gt;");
  EXPECT_EQ(escaped("Straße 5 µm ⁻³ 🌞"), "Straße 5 µm ⁻³ 🌞");
}

TEST(Html, CommandsStandBetweenBackticks) {
  EXPECT_EQ(with_code("run `hdr info <file>` or `hdr`."),
            "run <code>hdr info &lt;file&gt;</code> or <code>hdr</code>.");
  EXPECT_EQ(with_code("`a` and a `"), "<code>a</code> and a `") << "one backtick alone is no command";
  EXPECT_EQ(with_code(""), "");
}

TEST(Escaped, BytesThatAreNoCharactersAreReplaced) {
  const std::string bad = "\xEF\xBF\xBD";
  EXPECT_EQ(escaped("caf\xE9.jpg"), "caf" + bad + ".jpg") << "Latin-1";
  EXPECT_EQ(escaped("\xC0\xAF"), bad + bad) << "overlong";
  EXPECT_EQ(escaped("\xED\xA0\x80"), bad + bad + bad) << "half a surrogate";
  EXPECT_EQ(escaped("\xF4\x90\x80\x80"), bad + bad + bad + bad) << "beyond Unicode";
  EXPECT_EQ(escaped("\xE2\x82"), bad + bad) << "cut";
  EXPECT_EQ(escaped(std::string("a\0b\x1b", 4)), "a" + bad + "b" + bad);
}

TEST(Number, ReadsAsAPersonWritesIt) {
  EXPECT_EQ(number(0.0123456), "0.0123");
  EXPECT_EQ(number(-2), "−2");
  EXPECT_EQ(number(123456), "123456");
  EXPECT_EQ(number(0.00012), "0.00012");
  EXPECT_EQ(number(std::nan("")), "–");
  EXPECT_EQ(seconds_text(1.0 / 250), "1/250 s");
  EXPECT_EQ(seconds_text(2.5), "2.5 s");
}

Page full_page() {
  Page page("<calibrate> & \"co\"", "rms < 0.01");
  Table table({{"shot"}, {"seconds", true}});
  table.row({"<img src=x onerror=alert(1)>.jpg", "0.5"});
  Facts facts;
  facts.add("a & b", "<1>");
  Plot plot;
  plot.title = "a < b";
  plot.x.label = "x (\"stops\")";
  plot.series = {{"line & co", Mark::kLine, Colour::kBlue, {0, 1, 2}, {1, 2, 3}}};
  page.add({"first", "First & last", facts.html() + table.html() + list({"<li>"}, "warnings")});
  page.add({"second", "Second", figure(html_of(plot), "it's <caption>")});
  page.use(assets::kPlotScript);
  page.use(assets::kPlotScript);
  return page;
}

TEST(Page, IsWellFormedWhateverTheTexts) {
  const std::string html = full_page().text();
  EXPECT_EQ(test::fault_of_page(html), "");
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_NE(html.find("href=\"#first\""), std::string::npos);
}

TEST(Page, TheCheckerSeesFaults) {
  const std::string head = "<!DOCTYPE html>\n";
  for (const char* body : {"<p><b></p></b>", "<p>", "a & b", "<p a=b></p>", "<a href=\"#nowhere\"></a>",
                           "<script src=\"https://x/y.js\"></script>", "<p id=\"a\"></p><p id=\"a\"></p>"}) {
    EXPECT_NE(test::fault_of_page(head + body), "") << body;
  }
  EXPECT_EQ(test::fault_of_page(head + "<p id=\"a\">x</p><a href=\"#a\">y</a>"), "");
}

TEST(Page, HasAScriptOnceAndMayFetchNothing) {
  const std::string html = full_page().text();
  const std::string script = assets::kPlotScript;
  const std::size_t first = html.find(script);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(html.find(script, first + 1), std::string::npos);
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  for (const char* asset : {assets::kStyle, assets::kPlotScript}) {
    EXPECT_EQ(std::string(asset).find("</s"), std::string::npos) << "would end its own element";
    EXPECT_EQ(std::string(asset).find("//cdn"), std::string::npos);
  }
}

TEST(Page, LeavesEmptySectionsOutAndWritesWhole) {
  Page page("t", "s");
  page.add({"nothing", "Nothing", ""});
  page.add({"some", "Some", "<p>x</p>"});
  EXPECT_EQ(page.text().find("Nothing"), std::string::npos);
  const test::ScratchDir scratch;
  page.write(scratch / "r.html");
  EXPECT_EQ(read_text(scratch / "r.html"), page.text());
  EXPECT_THROW(page.write(scratch.path() / "no" / "r.html"), Error);
}

}  // namespace
}  // namespace hdr::report

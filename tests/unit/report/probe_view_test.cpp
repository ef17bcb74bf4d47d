#include "tools/hdr/report/probe_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "libhdr/core/sphere.h"
#include "tests/support/markup.h"

namespace hdr::report {
namespace {

TEST(ProbeView, IsWellFormedAndBearsAnyProbe) {
  Image<float> probe(64, 32, 3);
  for (int y = 0; y < 32; ++y) {
    for (int k = 0; k < 192; ++k) probe.row(y)[k] = 1;
  }
  probe(3, 4, 0) = std::nanf("");
  probe(5, 6, 1) = std::numeric_limits<float>::infinity();
  probe(7, 8, 2) = -4;
  Page page("t", "s");
  page.add({"probe", "Probe", html_of(ProbeView{"v", probe, 0.2}, page)});
  const std::string html = page.text();
  EXPECT_EQ(test::fault_of_page(html), "");
  const std::size_t first = html.find("data-irradiance=");
  EXPECT_EQ(html.substr(first, html.find('>', first) - first).find("nan"), std::string::npos);
}

// White light everywhere: the irradiance is pi whatever the normal, so M is pi in its corner and nothing else matters.
TEST(ProbeView, AWhiteFurnaceHasTheIrradiancePi) {
  Image<float> probe(64, 32, 3);
  for (int y = 0; y < 32; ++y) {
    for (int k = 0; k < 192; ++k) probe.row(y)[k] = 1;
  }
  Page page("t", "s");
  const std::string html = html_of(ProbeView{"v", probe, 0}, page);
  const std::size_t first = html.find("data-irradiance=\"") + 17;
  std::istringstream numbers(html.substr(first, html.find('"', first) - first));
  std::vector<double> m(48);
  for (double& value : m) ASSERT_TRUE(numbers >> value);
  for (int c = 0; c < 3; ++c) {
    for (const Vec3& n : {Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0.6, 0, -0.8)}) {
      const Eigen::Vector4d h(n.x(), n.y(), n.z(), 1);
      double sum = 0;
      for (int k = 0; k < 16; ++k) sum += h[k / 4] * m[static_cast<std::size_t>(16 * c + k)] * h[k % 4];
      EXPECT_NEAR(sum, kPi, 1e-4);
    }
  }
}

}  // namespace
}  // namespace hdr::report

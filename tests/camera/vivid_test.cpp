// Streams of the kernel's test driver, vivid: every format that it and we have, and controls that are bound to frames.
// Runs in the virtual machine only.
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <map>
#include <utility>

#include "capture/develop.h"
#include "capture/v4l2/v4l2_camera.h"
#include "capture/v4l2/v4l2_stream.h"

namespace hdr::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
constexpr Size kSize{320, 180};

std::string vivid_uri() {
  for (const CameraName& camera : list_v4l2_cameras()) {
    if (camera.name.starts_with("vivid")) return camera.uri;
  }
  throw std::runtime_error("no vivid; is the module loaded?");
}

v4l2::Device open_vivid() {
  const std::string uri = vivid_uri();
  return {uri, uri.substr(uri.find(':') + 1)};
}

/// Means of the three channels, of full scale.
std::array<double, 3> means_of(const Photo& photo) {
  std::array<double, 3> sums{};
  std::visit(
      [&](const auto& codes) {
        for (int y = 0; y < codes.height(); ++y) {
          for (int x = 0; x < codes.width(); ++x) {
            for (int c = 0; c < 3; ++c) sums[static_cast<std::size_t>(c)] += codes(x, y, c);
          }
        }
      },
      photo.codes);
  for (double& sum : sums) sum /= double{1.0} * photo.width() * photo.height() * photo.max_code();
  return sums;
}

TEST(Vivid, EveryFormatShowsTheSamePicture) {
  v4l2::Device device = open_vivid();
  const Capabilities can = open_camera(vivid_uri() + "?size=320x180")->capabilities();
  std::array<double, 3> expected{};
  int compared = 0;
  std::vector<FrameFormat> formats = can.formats;
  std::ranges::stable_partition(formats, [](const FrameFormat& f) { return f.pixels == PixelFormat::kRgb8; });
  ASSERT_EQ(formats.front().pixels, PixelFormat::kRgb8);
  for (const FrameFormat& offered : formats) {
    const v4l2::FormatCode& code = *v4l2::find_format(offered.pixels, offered.cfa);
    const FrameFormat format = v4l2::set_format(device, code, kSize);
    v4l2::Stream stream(device, format, {});
    std::uint32_t last = 0;
    for (int k = 0; k < 2; ++k) {
      const Frame frame = stream.next(Clock::now() + 10s).frame;
      EXPECT_TRUE(frame.is_whole()) << to_text(format);
      EXPECT_TRUE(k == 0 || frame.sequence > last) << to_text(format);
      last = frame.sequence;
      if (k == 0) continue;
      const std::array<double, 3> means = means_of(develop(frame));
      if (compared++ == 0) expected = means;
      const double luma = 0.299 * expected[0] + 0.587 * expected[1] + 0.114 * expected[2];
      const bool grey = format.cfa == Cfa::kNone && format.pixels != PixelFormat::kRgb8 &&
                        format.pixels != PixelFormat::kYuyv && format.pixels != PixelFormat::kMjpeg;
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(means[c], grey ? luma : expected[c], 0.02) << to_text(format) << ", channel " << c;
      }
    }
  }
  std::cout << "  " << compared << " formats\n";
  EXPECT_GE(compared, 22) << "16 of Bayer, 4 grey, YUYV and RGB";
}

TEST(Vivid, ControlsAreBoundToFrames) {
  v4l2::Device device = open_vivid();
  const FrameFormat format = v4l2::set_format(device, *v4l2::find_format(PixelFormat::kGrey8, Cfa::kNone), kSize);
  v4l2::Stream stream(device, format, {.request_controls = {{V4L2_CID_BRIGHTNESS, 40}}});
  ASSERT_TRUE(stream.has_requests());
  // What each frame says, and what it looks like. Which value is the brighter one is vivid's affair.
  std::map<std::int64_t, std::pair<double, double>> range_of;  // value -> least and greatest mean
  for (int k = 0; k < 30; ++k) {
    if (k == 10) stream.ask({{V4L2_CID_BRIGHTNESS, 200}});
    const v4l2::Arrived arrived = stream.next(Clock::now() + 10s);
    const auto said = arrived.controls.find(V4L2_CID_BRIGHTNESS);
    ASSERT_NE(said, arrived.controls.end()) << "frame " << k << " does not say what it was taken with";
    const double mean = means_of(develop(arrived.frame))[0];
    auto& [least, most] = range_of.try_emplace(said->second, mean, mean).first->second;
    least = std::min(least, mean);
    most = std::max(most, mean);
  }
  ASSERT_EQ(range_of.size(), 2u) << "values that frames say";
  const auto [low, high] = std::pair(range_of.at(40), range_of.at(200));
  std::cout << "  brightness 40: " << low.first << " to " << low.second << ", 200: " << high.first << " to "
            << high.second << '\n';
  EXPECT_LT(low.second - low.first, 0.01) << "all that say 40 look alike";
  EXPECT_LT(high.second - high.first, 0.01) << "all that say 200 look alike";
  EXPECT_GT(std::abs(high.first - low.first), 0.1);
}

TEST(Vivid, WithoutExposureThereIsNoBracket) {
  const auto camera = open_camera(vivid_uri() + "?size=320x180");
  EXPECT_FALSE(camera->capabilities().manual_exposure);
  EXPECT_THROW(camera->start({0.01, 1}), CameraError);
}

}  // namespace
}  // namespace hdr::test

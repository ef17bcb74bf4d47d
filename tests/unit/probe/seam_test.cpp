// Seams by graph cut: what moved is shown whole or not at all.
#include "libhdr/probe/seam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/fisheye_pair.h"
#include "libhdr/probe/internal/seam_cut.h"
#include "libhdr/probe/stitch.h"
#include "tests/support/carpet.h"
#include "tests/support/rounds.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

/// Somebody dark, taller than wide: an ellipse of the sphere around `middle`, half-axes in degrees.
struct Person {
  Vec3 middle;
  double wide = 5, tall = 12;
  bool covers(const Vec3& d, double grown = 1) const {
    const Vec3 right = middle.cross(Vec3::UnitY()).normalized(), up = right.cross(middle);
    if (d.dot(middle) < 0.5) return false;
    const double x = std::asin(d.dot(right)) / (grown * wide * kDegree),
                 y = std::asin(d.dot(up)) / (grown * tall * kDegree);
    return x * x + y * y < 1;
  }
};

Vec3 towards(double right, double up) {
  return {-std::cos(up * kDegree) * std::sin(right * kDegree), std::sin(up * kDegree),
          std::cos(up * kDegree) * std::cos(right * kDegree)};
}

constexpr float kCoat = 0.05f;

/// World as one moment shows it.
struct Moment {
  const test::Carpet* world;
  std::vector<Person> people;
  double operator()(const Vec3& d) const {
    for (const Person& person : people) {
      if (person.covers(d)) return static_cast<double>(kCoat);
    }
    return (*world)(d);
  }
};

template <class Lens>
Image<float> photograph(const Moment& moment, const Lens& lens, Size size, const Mat3& world_from_view, double gain) {
  Image<float> picture(size, 3);
  for_rows(size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const auto d = lens.dir_from_px({x + 0.5, y + 0.5});
        const auto light = static_cast<float>(d ? gain * moment(world_from_view * *d) : 0);
        for (int c = 0; c < 3; ++c) picture(x, y, c) = light;
      }
    }
  });
  return picture;
}

/// Share of the person's pixels that show the coat, where it is dark: 0 or 1 when nobody was cut.
double share_of_coat(const Image<float>& sphere, const test::Carpet& world, const Person& person) {
  int coat = 0, all = 0;
  for (int y = 0; y < sphere.height(); ++y) {
    for (int x = 0; x < sphere.width(); ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / sphere.width(), (y + 0.5) / sphere.height());
      if (!person.covers(d, 0.85) || world(d) < 4 * static_cast<double>(kCoat)) continue;
      ++all;
      coat += sphere(x, y, 1) < 2 * kCoat ? 1 : 0;
    }
  }
  return coat / static_cast<double>(std::max(1, all));
}

/// Median of |log2(sphere / world)| where nobody ever stood.
double median_off(const Image<float>& sphere, const test::Carpet& world, const std::vector<Person>& people) {
  std::vector<double> off;
  for (int y = 20; y < sphere.height() - 20; ++y) {
    for (int x = 0; x < sphere.width(); ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / sphere.width(), (y + 0.5) / sphere.height());
      bool clear = sphere(x, y, 1) > 0;
      for (const Person& person : people) clear &= !person.covers(d, 1.2);
      if (clear) off.push_back(std::abs(std::log2(sphere(x, y, 1) / world(d))));
    }
  }
  std::nth_element(off.begin(), off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2), off.end());
  return off[off.size() / 2];
}

bool whole(double share) {
  return share < 0.03 || share > 0.97;
}

TEST(Seam, SomebodyWhoWalksInTheOverlapOfPhotographsIsNotCutInTwo) {
  int cut_by_feather = 0;
  for (std::uint64_t seed = 1; seed < 1 + test::rounds(4); ++seed) {
    const test::Carpet world(seed);
    Random random(seed, 12);
    // Eight photographs, 45 degrees apart, of 80 degrees each; he stands in an overlap, and is elsewhere in it next.
    const Rectilinear lens{{400, 400}, 80};
    const Person here{towards(22.5 + 6 * random.uniform() - 3, -4)};
    const Person next{towards(22.5 + 12 + 4 * random.uniform(), -4)};
    std::vector<Image<float>> pictures;
    Stitch stitch;
    for (int k = 0; k < 8; ++k) {
      StitchedPhoto view;
      view.used = true;
      view.lens = lens;
      view.probe_from_view = rotation_from_degrees({0, -45.0 * k, 0});
      const double gain = std::exp2(random.uniform() - 0.5);
      view.gain = 1 / gain;
      const Moment moment{&world, {k == 0 ? here : next}};
      pictures.push_back(photograph(moment, lens, lens.size, view.probe_from_view, gain));
      stitch.photos.push_back(view);
    }
    std::vector<StitchPhoto> photos;
    for (const auto& picture : pictures) photos.push_back({picture});
    const Image<float> cut = merge_stitch(photos, stitch, 720, Mat3::Identity(), Seam::kCut).rgb;
    const Image<float> feathered = merge_stitch(photos, stitch, 720).rgb;
    EXPECT_PRED1(whole, share_of_coat(cut, world, here)) << "seed " << seed;
    EXPECT_PRED1(whole, share_of_coat(cut, world, next)) << "seed " << seed;
    cut_by_feather +=
        whole(share_of_coat(feathered, world, here)) && whole(share_of_coat(feathered, world, next)) ? 0 : 1;
    EXPECT_LT(median_off(cut, world, {here, next}), 0.02) << "the exposure is kept, seed " << seed;
  }
  EXPECT_GE(cut_by_feather, static_cast<int>(test::rounds(4) + 1) / 2) << "or else this test proves nothing";
}

TEST(Seam, SomebodyWhoWalksBetweenTwoFisheyesIsNotCutInTwo) {
  for (std::uint64_t seed = 1; seed < 1 + test::rounds(3); ++seed) {
    const test::Carpet world(seed + 10);
    Random random(seed, 13);
    const Size size{500, 500};
    const Fisheye lens{{250, 250, 245}, 220};
    FisheyePair pair;
    pair.views[0].lens = pair.views[1].lens = lens;
    pair.views[1].probe_from_view = rotation_from_degrees({0, 180, 0});
    const double gain = 1.4;
    pair.views[1].gain = 1 / gain;
    // The border of the two is 90 degrees from the axis.
    const Person here{towards(90 + 6 * random.uniform() - 3, 5), 6, 12}, next{towards(100, -40), 6, 12};
    const Image<float> front = photograph(Moment{&world, {here}}, lens, size, Mat3::Identity(), 1);
    const Image<float> back = photograph(Moment{&world, {next}}, lens, size, pair.views[1].probe_from_view, gain);
    const RadianceMap map = merge_fisheye_pair({front}, {back}, pair, 720, Mat3::Identity(), {Seam::kCut});
    EXPECT_PRED1(whole, share_of_coat(map.rgb, world, here)) << "seed " << seed;
    EXPECT_PRED1(whole, share_of_coat(map.rgb, world, next)) << "seed " << seed;
    EXPECT_LT(median_off(map.rgb, world, {here, next}), 0.02) << "seed " << seed;
    EXPECT_TRUE(map.alpha.empty()) << "two of 220 degrees show everything";
  }
}

// Layers that agree: the seam is where each is as near to its middle as the other, and all is shown.
TEST(Seam, WhereLayersAgreeTheirOwnCostDecides) {
  const Size size{64, 32};
  std::vector<internal::SeamLayer> layers;
  for (int k = 0; k < 2; ++k) {
    internal::SeamLayer layer{Image<float>(size, 3), Image<float>(size, 1), Image<float>(size, 1)};
    for (int y = 0; y < size.height; ++y) {
      std::fill_n(layer.rgb.row(y), 3 * size.width, 1.0f);
      for (int x = 0; x < size.width; ++x) {
        layer.shown(x, y) = y < 30 && (k == 1 || x < 40) ? 1.0f : 0.0f;
        layer.cost(x, y) = (x < 32) == (k == 0) ? 0.0f : 1.0f;
      }
    }
    layers.push_back(std::move(layer));
  }
  const internal::SeamCut cut(layers);
  EXPECT_EQ(cut.label(16, 15), 0);
  EXPECT_EQ(cut.label(50, 15), 1);
  EXPECT_EQ(cut.label(36, 31), -1);
  EXPECT_NEAR(cut.share(0, {16.5 / 64, 0.5}), 1, 1e-6);
  EXPECT_NEAR(cut.share(0, {32.0 / 64, 0.5}) + cut.share(1, {32.0 / 64, 0.5}), 1, 1e-6);
}

}  // namespace
}  // namespace hdr

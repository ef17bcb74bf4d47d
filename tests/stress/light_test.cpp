// Light under hostile maps: sampling, prefiltering, bounds, suns; poles, seams, denormals.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/lights.h"
#include "libhdr/light/prefilter.h"
#include "libhdr/light/restore_clipped.h"
#include "libhdr/light/sh.h"
#include "libhdr/light/sh_window.h"
#include "tests/stress/hostile.h"

namespace hdr::stress {
namespace {

constexpr double kBelowOne = 1 - 0x1p-53;

rc::Gen<double> share() {
  return rc::gen::map(rc::gen::oneOf(rc::gen::inRange(0, 1 << 30), rc::gen::element(0, 1 << 30)),
                      [](int k) { return std::min(std::ldexp(k, -30), kBelowOne); });
}

// What is drawn has light, a density that is finite and the pixel's own, and is where invert() says.
RC_GTEST_PROP(LightStress, WhatIsDrawnHasLight, ()) {
  const MapPlan plan = *any_latlong(64);
  const auto density = *rc::gen::element(Environment::Density::kLuminance, Environment::Density::kCompensated);
  const auto order = *rc::gen::element(Environment::Order::kInOrder, Environment::Order::kAlias);
  const Environment light(made(plan), density, order);
  for (int k = 0; k < 20; ++k) {
    const Vec2 u(*share(), *share());
    const Environment::Sample sample = light.sample(u);
    RC_ASSERT(std::abs(sample.dir.norm() - 1) < 1e-5f);
    RC_ASSERT(std::isfinite(sample.pdf) && sample.pdf > 0);
    RC_ASSERT(sample.radiance.isFinite().all() && (sample.radiance >= 0).all());
    RC_ASSERT(light.black() || sample.radiance.maxCoeff() > 0);
    const Vec2 back = light.invert(sample.dir);
    RC_ASSERT(back.x() >= 0 && back.x() < 1 && back.y() >= 0 && back.y() < 1);
  }
}

// Seams and poles are directions as others, and NaN is the caller's bug that must not become a wild read.
RC_GTEST_PROP(LightStress, EveryDirectionMeetsAPixel, ()) {
  const MapPlan plan = *any_latlong(64);
  const Image<float> map = made(plan);
  const double brightest = largest_of(map);
  const Environment light(map.clone());
  const Vec3f d = (*direction()).cast<float>();
  for (const Rgbf& value : {light.radiance(d), light.smooth_radiance(d)}) {
    RC_ASSERT(value.isFinite().all() && (value >= 0).all() &&
              (value <= static_cast<float>(brightest * (1 + 1e-6))).all());
  }
  RC_ASSERT(std::isfinite(light.pdf(d)));
}

// A mean lies between the least and the largest: of one value it is that value, for any roughness and at any pole.
RC_GTEST_PROP(LightStress, PrefilteredLightIsAMean, ()) {
  const MapPlan plan = *any_latlong(24);
  const Image<float> map = made(plan);
  const Prefilter prefilter(map);
  const double least = smallest_of(map), most = largest_of(map);
  const double roughness = *rc::gen::element(0.0, 1e-3, 0.05, 0.5, 1.0);
  const Lobe lobe = *rc::gen::element(Lobe::kGgx, Lobe::kPhong);
  const Rgb mean = prefilter.mean(*direction(), roughness, lobe, 32);
  RC_ASSERT(mean.isFinite().all());
  RC_ASSERT((mean >= least * (1 - 1e-6)).all() && (mean <= most * (1 + 1e-6)).all());
}

// A map that begins at another meridian is the same world, turned: between the last column and the first as between any
// others.
RC_GTEST_PROP(LightStress, PrefilteredLightHasNoSeam, ()) {
  const MapPlan plan = *any_latlong(24);
  const Image<float> map = made(plan);
  const int columns = *rc::gen::inRange(0, plan.width);
  Image<float> turned(map.size(), 3);
  for (int y = 0; y < map.height(); ++y) {
    for (int k = 0; k < 3 * map.width(); ++k) turned.row(y)[(k + 3 * columns) % (3 * map.width())] = map.row(y)[k];
  }
  const double v = *rc::gen::element(0.01, 0.3, 0.5, 0.9), most = largest_of(map);
  // Halfway between columns, where the two are one half each whatever was rounded.
  const int x = *rc::gen::inRange(1, plan.width + 1);
  const auto at = [&](const Image<float>& of, int column) {
    return Prefilter(of).mean(dir_from_latlong(1.0 * column / plan.width, v), 0, Lobe::kGgx, 1);
  };
  RC_ASSERT(((at(map, x) - at(turned, (x + columns) % plan.width)).abs() <= 1e-12 * most).all());
}

// The bound on what nine harmonics leave out holds against the sum over all pixels.
RC_GTEST_PROP(LightStress, TheBoundOfTheIrradianceHolds, ()) {
  const MapPlan plan = *any_latlong(24);
  const Image<float> map = made(plan);
  const int degree = *rc::gen::inRange(0, 5);
  const Sh sh = project(map, LatLong{map.size()}, degree);
  const double bound = irradiance_error_bound(map, LatLong{map.size()}, sh);
  RC_ASSERT(!std::isnan(bound) && bound >= 0);
  const Rgb least = least_irradiance(sh);
  RC_ASSERT(least.isFinite().all());
  const WindowedSh calm = windowed(sh, ShWindow::kAuto);
  Rgb largest = Rgb::Zero();
  for (int l = 0; l <= degree; ++l) {
    for (int m = -l; m <= l; ++m) largest = largest.max(sh(l, m).abs());
  }
  RC_ASSERT((least_irradiance(calm.sh) >= -1e-6 * largest).all());
}

// Clipped suns take what a meter says, and nothing else changes.
RC_GTEST_PROP(LightStress, RestoredSunsLeaveTheRestAlone, ()) {
  const MapPlan plan = *any_latlong(32);
  const Image<float> map = made(plan);
  const Image<std::uint8_t> clipped = clipped_mask(map);
  const Rgb measured = Rgb::Constant(*power_of_ten(-12, 12));
  try {
    const Restored restored = restore_clipped(map, clipped, {{*direction(), measured}});
    RC_ASSERT(fault_of(restored.rgb).empty());
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) {
        for (int c = 0; c < 3; ++c) {
          if (clipped(x, y) == 0) {
            RC_ASSERT(restored.rgb(x, y, c) == map(x, y, c));
          } else {
            RC_ASSERT(restored.rgb(x, y, c) >= map(x, y, c));
          }
        }
      }
    }
  } catch (const Error&) {
    RC_ASSERT(largest_of(map) == 0);  // only a black map has nothing clipped
  }
}

}  // namespace
}  // namespace hdr::stress

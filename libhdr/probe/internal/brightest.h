#pragma once

namespace hdr::internal {

/// value[k] = the largest sample of pixel k, of `count` pixels; returns the least sample of all, at most 0.
float brightest_channels(const float* pixels, int channels, int count, float* value);

}  // namespace hdr::internal

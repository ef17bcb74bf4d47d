#pragma once
// A radiance map on the page: a canvas with exposure, tone and false colour, masks that can be laid over, and a
// drawing.
#include <cstdint>
#include <string>
#include <vector>

#include "libhdr/core/image.h"
#include "tools/hdr/report/page.h"
#include "tools/hdr/report/plot.h"

namespace hdr::report {

/// Where something is: 0 nowhere, 255 surely. Of the picture's size, one channel.
struct Overlay {
  std::string name;
  View<const std::uint8_t> mask;
  Colour colour = Colour::kVermilion;  ///< of the named ones that stand out on pictures
  bool shown = false;                  ///< from the start
};

struct Picture {
  std::string id;         ///< letters, digits, dashes; once on a page
  View<const float> rgb;  ///< linear light, small enough to stand in a page: see reduced()
  double stops = 0;       ///< the exposure to start with
  std::vector<Overlay> overlays;
  std::string drawing;  ///< SVG elements over it, in pixels of `size`
  Size size;            ///< of the picture that `drawing` means; empty: of rgb
};

/// The canvas with its controls and data; the page gets the script.
std::string html_of(const Picture& picture, Page& page);

/// At most `pixels` pixels in all, means over areas; a copy where it is that small already.
Image<float> reduced(View<const float> rgb, int pixels);
/// The size that reduced() gives.
Size reduced_size(Size size, int pixels);
/// Of a mask: the largest value of each area, so that a lone pixel is seen.
Image<std::uint8_t> reduced(View<const std::uint8_t> mask, Size size);

}  // namespace hdr::report

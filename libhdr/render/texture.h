#pragma once
// A picture on a surface.
#include <span>

#include "libhdr/core/image.h"
#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"

namespace hdr {

using Vec2f = Eigen::Vector2f;

/// What lies beyond the picture's edge.
enum class Wrap { kRepeat, kMirror, kClamp };

struct Texture {
  Image<float> texels;  ///< three channels, linear
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;

  /// Bilinear; (0, 0) is the lower left corner, (1, 1) the upper right.
  Rgbf at(const Vec2f& uv) const;
};

/// How the numbers of an integer file are meant: colours are sRGB codes, other numbers (roughness) are as they are.
/// Float files are linear in either case.
enum class TextureMeaning { kColor, kNumbers };

/// Grey becomes three channels, alpha is dropped. Throws Error: missing, not a picture.
Texture read_texture(const Path& path, TextureMeaning meaning);
/// A PNG or JPEG file in memory, as glTF files hold them. `name` is for messages.
Texture texture_from_bytes(std::span<const unsigned char> file, TextureMeaning meaning, const std::string& name);

}  // namespace hdr

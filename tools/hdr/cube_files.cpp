#include "tools/hdr/cube_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <optional>

#include "libhdr/core/error.h"
#include "libhdr/probe/projection.h"

namespace hdr::tools {
namespace {

constexpr std::array<const char*, 6> kSuffixes = {"px", "nx", "py", "ny", "pz", "nz"};
constexpr std::array<const char*, 6> kLongSuffixes = {"posx", "negx", "posy", "negy", "posz", "negz"};

std::optional<std::size_t> face_of_name(const Path& path) {
  const std::string stem = path.stem().string();
  for (std::size_t k = 0; k < 6; ++k) {
    if (stem.ends_with(kSuffixes[k]) || stem.ends_with(kLongSuffixes[k])) return k;
  }
  return std::nullopt;
}

std::vector<Path> in_order(const std::vector<std::string>& paths) {
  std::vector<Path> ordered(6);
  for (const std::string& path : paths) {
    const auto face = face_of_name(path);
    if (!face || !ordered[*face].empty()) return {paths.begin(), paths.end()};
    ordered[*face] = path;
  }
  return ordered;
}

void copy_rows(View<const float> from, int from_row, View<float> to, int to_row, int rows) {
  for (int y = 0; y < rows; ++y) {
    std::memcpy(to.row(to_row + y), from.row(from_row + y),
                sizeof(float) * static_cast<std::size_t>(from.width()) * static_cast<std::size_t>(from.channels()));
  }
}

/// f(plane of a, plane of b) for the planes that a map may have.
template <class A, class B, class Work>
void for_planes(A& a, B& b, const Work& work) {
  work(a.rgb, b.rgb);
  work(a.alpha, b.alpha);
  work(a.stddev, b.stddev);
}

}  // namespace

std::vector<Path> cube_face_paths(const Path& output) {
  std::vector<Path> paths;
  for (const char* suffix : kSuffixes) {
    Path path = output;
    paths.push_back(path.replace_filename(output.stem().string() + "_" + suffix + output.extension().string()));
  }
  return paths;
}

void write_cube_faces(const Path& output, const RadianceMap& strip, const Provenance& provenance,
                      const WriteOptions& options) {
  const int n = strip.size().width;
  const std::vector<Path> paths = cube_face_paths(output);
  for (std::size_t k = 0; k < 6; ++k) {
    RadianceMap face;
    face.chromaticities = strip.chromaticities;
    face.white_luminance = strip.white_luminance;
    face.projection = strip.projection;
    for_planes(strip, face, [&](const Image<float>& from, Image<float>& to) {
      if (from.empty()) return;
      to = Image<float>(n, n, from.channels());
      copy_rows(from, static_cast<int>(k) * n, to, 0, n);
    });
    write_map(paths[k], face, provenance, options);
  }
}

bool are_cube_faces(const std::vector<std::string>& paths) {
  if (paths.size() == 6) return true;
  if (paths.size() != 1 || std::filesystem::exists(paths[0])) return false;
  const std::vector<Path> faces = cube_face_paths(paths[0]);
  return std::all_of(faces.begin(), faces.end(), [](const Path& p) { return std::filesystem::exists(p); });
}

ReadMap read_cube_faces(const std::vector<std::string>& paths) {
  const std::vector<Path> files = paths.size() == 6 ? in_order(paths) : cube_face_paths(paths[0]);
  ReadMap strip;
  for (std::size_t k = 0; k < 6; ++k) {
    ReadMap face = read_map(files[k]);
    const Size size = face.map.size();
    const int n = k == 0 ? size.width : strip.map.size().width;
    if (size != Size{n, n}) {
      throw Error(fmt::format("{}: {}x{} pixels, but six faces of a cube are squares of one size; crop or scale it",
                              files[k].string(), size.width, size.height));
    }
    if (k == 0) {
      strip.map.chromaticities = face.map.chromaticities;
      strip.map.white_luminance = face.map.white_luminance;
      strip.map.projection = face.map.projection;
    }
    for_planes(face.map, strip.map, [&](const Image<float>& from, Image<float>& to) {
      if (k == 0 && !from.empty()) to = Image<float>(n, 6 * n, from.channels());
      if (from.empty() || to.empty()) {
        to = {};
        return;
      }
      copy_rows(from, 0, to, static_cast<int>(k) * n, n);
    });
    for (std::string& warning : face.warnings) strip.warnings.push_back(std::move(warning));
  }
  if (!strip.map.projection.starts_with("cube-faces")) strip.map.projection = "cube-faces";
  return strip;
}

}  // namespace hdr::tools

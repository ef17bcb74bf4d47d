#include "libhdr/render/internal/mesh_file_check.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

void require_ply_header(const Path& path) {
  std::ifstream file(path, std::ios::binary);
  constexpr int kMostLines = 10000;
  std::string line;
  for (int k = 0; k < kMostLines && std::getline(file, line); ++k) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (k == 0 && line != "ply") break;
    if (line == "end_header") return;
  }
  throw Error(path.string() + ": not a PLY file, or cut off in its header; export it again");
}

// "data:image/png;base64,...": a slash before what ends the media type.
void require_media_types(const Path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  const std::string json = std::move(text).str();
  constexpr std::string_view kStart = "\"data:";
  for (std::size_t at = json.find(kStart); at != std::string::npos; at = json.find(kStart, at + 1)) {
    const std::size_t end = json.find_first_of(";,\"", at + kStart.size()), slash = json.find('/', at);
    if (end == std::string::npos || slash > end)
      throw Error(path.string() + ": a data URI in it names no media type; export it again");
  }
}

}  // namespace

std::string extension_of(const Path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void require_survivable(const Path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".ply") require_ply_header(path);
  if (extension == ".gltf" || extension == ".glb") require_media_types(path);
}

}  // namespace hdr

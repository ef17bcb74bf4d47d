#include "libhdr/render/obj.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <sstream>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

class Reader {
 public:
  explicit Reader(const std::string& source) : source_(source) {}

  Mesh read(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
      ++line_;
      std::istringstream words(line);
      std::string kind;
      words >> kind;
      if (kind == "v") places_.push_back(three(words));
      if (kind == "vn") normals_.push_back(three(words));
      if (kind == "f") face(words);
    }
    if (mesh_.indices.empty()) throw Error(source_ + ": no triangles in it; give a Wavefront OBJ file with faces");
    if (!all_normals_) mesh_.normals.clear();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(fmt::format("{}: line {}: {}; is this a Wavefront OBJ file?", source_, line_, what));
  }

  Vec3f three(std::istringstream& words) const {
    Vec3f v;
    if (!(words >> v.x() >> v.y() >> v.z()) || !v.allFinite()) refuse("three numbers are needed");
    return v;
  }

  std::size_t index(const std::string& text, std::size_t count) const {
    char* end = nullptr;
    const long value = std::strtol(text.c_str(), &end, 10);
    const long place = value > 0 ? value - 1 : static_cast<long>(count) + value;
    if (*end != 0 || value == 0 || place < 0 || place >= static_cast<long>(count))
      refuse(fmt::format("'{}' is no index of what came before", text));
    return static_cast<std::size_t>(place);
  }

  // "v", "v/vt", "v//vn", "v/vt/vn": each pair of place and normal becomes a vertex.
  std::uint32_t corner(const std::string& word) {
    const std::size_t slash = word.find('/'), last = word.rfind('/');
    const std::size_t place = index(word.substr(0, slash), places_.size());
    std::optional<std::size_t> normal;
    if (slash != last && last + 1 < word.size()) normal = index(word.substr(last + 1), normals_.size());
    all_normals_ = all_normals_ && normal.has_value();
    const auto [found, fresh] = vertices_.try_emplace({place, normal.value_or(std::numeric_limits<std::size_t>::max())},
                                                      static_cast<std::uint32_t>(mesh_.positions.size()));
    if (fresh) {
      mesh_.positions.push_back(places_[place]);
      const Vec3f n = normal ? normals_[*normal] : Vec3f(0, 1, 0);
      mesh_.normals.push_back(n.norm() > 0 ? Vec3f(n.normalized()) : Vec3f(0, 1, 0));
    }
    return found->second;
  }

  void face(std::istringstream& words) {
    std::vector<std::uint32_t> corners;
    for (std::string word; words >> word;) corners.push_back(corner(word));
    if (corners.size() < 3) refuse("a face has fewer than three corners");
    for (std::size_t k = 2; k < corners.size(); ++k)
      mesh_.indices.insert(mesh_.indices.end(), {corners[0], corners[k - 1], corners[k]});
  }

  std::string source_;
  int line_ = 0;
  std::vector<Vec3f> places_, normals_;
  std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> vertices_;
  bool all_normals_ = true;
  Mesh mesh_;
};

}  // namespace

Mesh mesh_from_obj(const std::string& text, const std::string& source) {
  return Reader(source).read(text);
}

}  // namespace hdr

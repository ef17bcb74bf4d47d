#include "tools/hdr/prt_file.h"

#include <fmt/format.h>

#include <cstring>

#include "libhdr/core/error.h"
#include "libhdr/io/output_file.h"

namespace hdr::tools {
namespace {

constexpr const char* kMagic = "hdr-prt 1\n";

template <class T>
void append(std::string& text, const T* data, std::size_t count) {
  text.append(reinterpret_cast<const char*>(data), count * sizeof(T));
}

template <class T>
void take(const std::string& text, std::size_t& at, T* data, std::size_t count) {
  std::memcpy(data, text.data() + at, count * sizeof(T));
  at += count * sizeof(T);
}

}  // namespace

void write_prt(const Path& path, const PrtMesh& prt) {
  const Mesh& mesh = prt.mesh;
  std::string text = kMagic;
  text += fmt::format("{} {} {}\n", mesh.positions.size(), mesh.indices.size(), prt.transfer.degree);
  for (const auto* list : {&mesh.positions, &mesh.normals})
    for (const Vec3f& v : *list) append(text, v.data(), 3);
  append(text, mesh.indices.data(), mesh.indices.size());
  for (Eigen::Index v = 0; v < prt.transfer.vectors.rows(); ++v) {
    const Eigen::RowVectorXf row = prt.transfer.vectors.row(v);
    append(text, row.data(), static_cast<std::size_t>(row.size()));
  }
  write_text(path, text);
}

PrtMesh read_prt(const Path& path) {
  const std::string text = read_text(path);
  const std::size_t line = text.find('\n', std::strlen(kMagic));
  std::size_t vertices = 0, indices = 0;
  int degree = -1;
  const bool known = text.rfind(kMagic, 0) == 0 && line != std::string::npos &&
                     std::sscanf(text.c_str() + std::strlen(kMagic), "%zu %zu %d", &vertices, &indices, &degree) == 3;
  if (!known || degree < 0 || degree > kMaxShDegree || vertices > text.size() || indices > text.size()) {
    throw Error(path.string() + ": not a file of `hdr prt`; make one with  hdr prt MESH -o mesh.prt");
  }
  const auto count = static_cast<std::size_t>((degree + 1) * (degree + 1));
  std::size_t at = line + 1;
  if (text.size() != at + 4 * (vertices * (6 + count) + indices)) {
    throw Error(path.string() + ": is cut off; make it again with `hdr prt`");
  }
  PrtMesh prt;
  prt.transfer.degree = degree;
  for (auto* list : {&prt.mesh.positions, &prt.mesh.normals}) {
    list->resize(vertices);
    for (Vec3f& v : *list) take(text, at, v.data(), 3);
  }
  prt.mesh.indices.resize(indices);
  take(text, at, prt.mesh.indices.data(), indices);
  for (const std::uint32_t index : prt.mesh.indices)
    if (index >= vertices) throw Error(path.string() + ": is damaged (an index beyond its vertices); make it again");
  prt.transfer.vectors.resize(static_cast<Eigen::Index>(vertices), static_cast<Eigen::Index>(count));
  for (std::size_t v = 0; v < vertices; ++v) {
    Eigen::RowVectorXf row(static_cast<Eigen::Index>(count));
    take(text, at, row.data(), count);
    prt.transfer.vectors.row(static_cast<Eigen::Index>(v)) = row;
  }
  return prt;
}

}  // namespace hdr::tools

#include "libhdr/render/scene_file.h"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>

#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/mesh_file_check.h"
#include "libhdr/render/internal/mesh_tools.h"
#include "libhdr/render/internal/scene_materials.h"

namespace hdr {
namespace {

constexpr double kCreaseDegrees = 40;

Mat4 matrix_of(const aiMatrix4x4& m) {
  Mat4 matrix;
  matrix << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  return matrix;
}

Vec3 vector_of(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

Vec3 point_through(const Mat4& to_world, const Vec3& p) {
  return to_world.topLeftCorner<3, 3>() * p + to_world.topRightCorner<3, 1>();
}

class Reader {
 public:
  Reader(const aiScene& from, const Path& path, const ReadSceneOptions& options, SceneFile& file)
      : from_(from), path_(path), options_(options), file_(file), materials_(from, path, file.warnings) {
    smooth_ =
        options.shading == Shading::kSmooth || (options.shading == Shading::kAuto && extension_of(path) == ".obj");
  }

  void read() {
    Mat4 ours_from_file = Mat4::Identity();
    if (options_.z_up) ours_from_file.topLeftCorner<3, 3>() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    if (from_.mRootNode) walk(*from_.mRootNode, ours_from_file);
    if (file_.triangles == 0) {
      throw Error(fmt::format("{}: no triangles in it{}; give a mesh with faces", path_.string(),
                              file_.degenerate > 0 ? fmt::format(" but {} without area", file_.degenerate) : ""));
    }
    if (file_.degenerate > 0) {
      file_.warnings.push_back(fmt::format("{}: {} triangles without area were dropped, {} stay", path_.string(),
                                           file_.degenerate, file_.triangles));
    }
    if (from_.mNumLights > 0)
      file_.warnings.push_back(path_.string() + ": its lights are left out; the probe is the light");
  }

 private:
  void walk(const aiNode& node, const Mat4& parent) {
    const Mat4 to_world = parent * matrix_of(node.mTransformation);
    for (unsigned k = 0; k < node.mNumMeshes; ++k) add(*from_.mMeshes[node.mMeshes[k]], to_world);
    for (unsigned k = 0; k < from_.mNumCameras && !file_.vertical_fov_degrees; ++k)
      if (from_.mCameras[k]->mName == node.mName) take(*from_.mCameras[k], to_world);
    for (unsigned k = 0; k < node.mNumChildren; ++k) walk(*node.mChildren[k], to_world);
  }

  // assimp 5.2 gives glTF's vertical field times the aspect ratio, or the field itself where there is no ratio; and the
  // node's place once more as the camera's own.
  void take(const aiCamera& camera, const Mat4& to_world) {
    const double fov = camera.mHorizontalFOV / (camera.mAspect > 0 ? camera.mAspect : 1.0f);
    const std::string extension = extension_of(path_);
    const bool gltf = extension == ".gltf" || extension == ".glb";
    const Vec3 eye = point_through(to_world, gltf ? Vec3(Vec3::Zero()) : vector_of(camera.mPosition));
    const Vec3 ahead = to_world.topLeftCorner<3, 3>() * vector_of(camera.mLookAt);
    const Vec3 up = to_world.topLeftCorner<3, 3>() * vector_of(camera.mUp);
    const bool usable = fov > 0 && fov < kPi && eye.allFinite() && ahead.norm() > 0 && ahead.cross(up).norm() > 0;
    if (!usable) {
      file_.warnings.push_back(path_.string() + ": its camera is not a perspective one, and is left out");
      return;
    }
    file_.scene.camera.eye = eye.cast<float>();
    file_.scene.camera.look = (eye + ahead.normalized()).cast<float>();
    file_.scene.camera.up = up.normalized().cast<float>();
    file_.vertical_fov_degrees = fov / kDegree;
  }

  void add(const aiMesh& from, const Mat4& to_world) {
    Mesh mesh;
    const SceneMaterials::Read material = materials_.read(from.mMaterialIndex);
    mesh.material = material.material;
    take_vertices(from, to_world, mesh);
    take_faces(from, to_world.topLeftCorner<3, 3>().determinant() < 0, mesh);
    take_texcoords(from, material.uv_set, mesh);
    file_.degenerate += drop_degenerate(mesh);
    if (mesh.indices.empty()) return;
    // OBJ and flat files come with three vertices a triangle of their own.
    if (mesh.positions.size() > 2 * mesh.indices.size() / 3) join_vertices(mesh);
    if (mesh.normals.empty() && smooth_) smooth_with_creases(mesh, kCreaseDegrees);
    file_.triangles += static_cast<std::int64_t>(mesh.indices.size() / 3);
    file_.scene.meshes.push_back(std::move(mesh));
  }

  void take_vertices(const aiMesh& from, const Mat4& to_world, Mesh& mesh) const {
    const bool identity = to_world.isIdentity(0);
    constexpr double kFarthest = 1e15;  // squares of squares are floats
    std::int64_t bad = 0;
    mesh.positions.reserve(from.mNumVertices);
    for (unsigned k = 0; k < from.mNumVertices; ++k) {
      const aiVector3D& v = from.mVertices[k];
      const Vec3 p = identity ? vector_of(v) : point_through(to_world, vector_of(v));
      bad += !(p.cwiseAbs().maxCoeff() < kFarthest && p.allFinite());
      mesh.positions.push_back(p.cast<float>());
    }
    if (bad > 0) {
      throw Error(fmt::format("{}: {} of {} vertices are not finite numbers below 1e15; export the mesh again",
                              path_.string(), bad, from.mNumVertices));
    }
    if (!from.HasNormals() || options_.shading != Shading::kAuto) return;
    // Normals go by the inverse transpose: what is perpendicular stays perpendicular.
    const Mat3 linear = to_world.topLeftCorner<3, 3>();
    const bool flat = std::abs(linear.determinant()) < 1e-30;
    const Mat3 turn = flat ? linear : Mat3(linear.inverse().transpose());
    for (unsigned k = 0; k < from.mNumVertices; ++k) {
      const Vec3 n = turn * vector_of(from.mNormals[k]);
      if (!(n.norm() > 0) || !n.allFinite()) {  // one bad normal: the facets know better
        mesh.normals.clear();
        return;
      }
      mesh.normals.push_back(n.normalized().cast<float>());
    }
  }

  // Polygons are cut into fans; of a quadrangle with a dent, along the diagonal that lies inside. assimp's own step for
  // this stops the program at some damaged files.
  void take_faces(const aiMesh& from, bool mirrored, Mesh& mesh) const {
    mesh.indices.reserve(3 * std::size_t{from.mNumFaces});
    for (unsigned k = 0; k < from.mNumFaces; ++k) {
      const aiFace& face = from.mFaces[k];
      for (unsigned c = 0; c < face.mNumIndices; ++c) {
        if (face.mIndices[c] >= from.mNumVertices)
          throw Error(path_.string() + ": a face names a vertex that does not exist; export it again");
      }
      const unsigned count = face.mNumIndices;
      const unsigned first = count == 4 && is_dented_at_odd_corner(mesh, face) ? 1 : 0;
      for (unsigned c = 1; c + 1 < count; ++c) {
        const unsigned a = face.mIndices[first], b = face.mIndices[(first + c) % count],
                       d = face.mIndices[(first + c + 1) % count];
        mesh.indices.insert(mesh.indices.end(), {mirrored ? d : a, b, mirrored ? a : d});
      }
    }
  }

  static bool is_dented_at_odd_corner(const Mesh& mesh, const aiFace& quad) {
    Vec3 p[4], sum = Vec3::Zero(), turn[4];
    for (unsigned c = 0; c < 4; ++c) p[c] = mesh.positions[quad.mIndices[c]].cast<double>();
    for (unsigned c = 0; c < 4; ++c) sum += turn[c] = (p[c] - p[(c + 3) % 4]).cross(p[(c + 1) % 4] - p[c]);
    return turn[1].dot(sum) < 0 || turn[3].dot(sum) < 0;
  }

  void take_texcoords(const aiMesh& from, unsigned set, Mesh& mesh) const {
    if (!mesh.material.color_texture && !mesh.material.surface_texture) return;
    if (set >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !from.HasTextureCoords(set)) {
      file_.warnings.push_back(path_.string() +
                               ": a mesh has a texture but no texture coordinates; its plain colour is used");
      return;
    }
    for (unsigned k = 0; k < from.mNumVertices; ++k)
      mesh.texcoords.emplace_back(from.mTextureCoords[set][k].x, from.mTextureCoords[set][k].y);
  }

  const aiScene& from_;
  Path path_;
  ReadSceneOptions options_;
  SceneFile& file_;
  SceneMaterials materials_;
  bool smooth_ = false;
};

// "OBJ: vertex index out of range" and the like: the first line, without a full stop.
std::string message_of(const Assimp::Importer& importer) {
  std::string message = importer.GetErrorString();
  message = message.substr(0, message.find('\n'));
  while (!message.empty() && (message.back() == '.' || message.back() == ' ')) message.pop_back();
  return message.empty() ? "no reader for it" : message;
}

}  // namespace

SceneFile read_scene(const Path& path, const ReadSceneOptions& options) {
  if (!std::filesystem::exists(path)) throw Error(path.string() + ": no such file; check the name");
  if (!std::filesystem::is_regular_file(path)) throw Error(path.string() + ": not a file; give a mesh");
  require_survivable(path);
  Assimp::Importer importer;
  const aiScene* from = importer.ReadFile(path.string(), 0);
  if (!from) {
    throw Error(fmt::format("{}: not a mesh that can be read ({}); give OBJ, PLY, glTF or GLB", path.string(),
                            message_of(importer)));
  }
  SceneFile file;
  Reader(*from, path, options, file).read();
  return file;
}

}  // namespace hdr

// Files of meshes: what becomes of their triangles, normals, materials and cameras, and of those that are damaged.
#include "libhdr/render/scene_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libhdr/core/color.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/prt.h"
#include "tests/support/support.h"
#include "tests/unit/render/scene_files.h"

namespace hdr {
namespace {

using test::GltfSquare;
using test::write_file;

class SceneFiles : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, const std::string& bytes) const {
    write_file(scratch_ / name, bytes);
    return scratch_ / name;
  }
  SceneFile read(const std::string& name, const std::string& bytes, const ReadSceneOptions& options = {}) const {
    return read_scene(file(name, bytes), options);
  }
  /// The message of the refusal, which names the file.
  std::string refusal(const std::string& name, const std::string& bytes) const {
    const auto path = file(name, bytes);
    try {
      read_scene(path);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).rfind(path.string() + ": ", 0), 0u) << error.what();
      return error.what();
    }
    ADD_FAILURE() << name << " was read: " << bytes.substr(0, 80);
    return "";
  }

  test::ScratchDir scratch_;
};

Vec3 facing(const Mesh& mesh, std::size_t triangle) {
  const auto p = [&](std::size_t k) { return Vec3(mesh.positions[mesh.indices[3 * triangle + k]].cast<double>()); };
  return (p(1) - p(0)).cross(p(2) - p(0)).normalized();
}

TEST_F(SceneFiles, ObjPolygonsNormalsAndIndicesFromTheEnd) {
  const Scene square = read("square.obj", "# a square\nv 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 0 -1\nf 1 2 3 4\n").scene;
  ASSERT_EQ(square.meshes.size(), 1u);
  const Mesh& mesh = square.meshes[0];
  EXPECT_EQ(mesh.positions.size(), 4u) << "corners that are one vertex are shared";
  ASSERT_EQ(mesh.indices.size(), 6u);
  for (std::size_t t = 0; t < 2; ++t) EXPECT_GT(facing(mesh, t).y(), 0.999);
  ASSERT_EQ(mesh.normals.size(), 4u) << "OBJ without normals is smooth";
  for (const Vec3f& n : mesh.normals) EXPECT_LT((n - Vec3f(0, 1, 0)).norm(), 1e-6f);
  EXPECT_EQ(mesh.material.kind, MaterialKind::kDiffuse);
  EXPECT_FLOAT_EQ(mesh.material.color[0], 0.5f) << "no material is grey";
  const Mesh named = read("n.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nf -3//1 -2//1 -1//-1\n").scene.meshes.at(0);
  ASSERT_EQ(named.normals.size(), 3u);
  EXPECT_LT((named.normals[2] - Vec3f(0, 0, 1)).norm(), 1e-6f);
}

TEST_F(SceneFiles, SmoothNormalsStopAtSharpEdges) {
  std::string cube;
  for (int k = 0; k < 8; ++k)
    cube += "v " + std::to_string(k & 1) + " " + std::to_string(k >> 1 & 1) + " " + std::to_string(k >> 2) + "\n";
  cube += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  const Mesh mesh = read("cube.obj", cube).scene.meshes.at(0);
  ASSERT_EQ(mesh.positions.size(), 24u) << "each corner has a normal for each of its faces";
  for (std::size_t t = 0; t < 12; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_GT(mesh.normals[mesh.indices[3 * t + k]].cast<double>().dot(facing(mesh, t)), 0.9999);
  // A fine sphere is smooth all over: its normals are its places.
  const Mesh ball = sphere_mesh({0, 0, 0}, 1, {}, 48);
  std::string text;
  for (const Vec3f& p : ball.positions)
    text += "v " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
  for (std::size_t k = 0; k < ball.indices.size(); k += 3)
    text += "f " + std::to_string(ball.indices[k] + 1) + " " + std::to_string(ball.indices[k + 1] + 1) + " " +
            std::to_string(ball.indices[k + 2] + 1) + "\n";
  const Mesh smooth = read("ball.obj", text).scene.meshes.at(0);
  ASSERT_EQ(smooth.positions.size(), ball.positions.size());
  for (std::size_t v = 0; v < smooth.positions.size(); ++v)
    EXPECT_GT(smooth.normals[v].dot(smooth.positions[v].normalized()), 0.999f);
}

const char* const kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
    "property list uchar int vertex_indices\nend_header\n";

TEST_F(SceneFiles, PlyShowsFacetsUnlessAskedOtherwise) {
  const std::string text = std::string(kPly) + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
  const Mesh flat = read("a.ply", text).scene.meshes.at(0);
  EXPECT_TRUE(flat.normals.empty());
  EXPECT_GT(facing(flat, 1).z(), 0.999);
  EXPECT_EQ(read("a.ply", text, {Shading::kSmooth}).scene.meshes.at(0).normals.size(), 4u);
  const Mesh stood = read("a.ply", text, {Shading::kAuto, true}).scene.meshes.at(0);
  EXPECT_GT(facing(stood, 0).y(), 0.999) << "--up z: its +Z is our +Y";
  EXPECT_FLOAT_EQ(flat.material.color[1], 0.5f);
}

TEST_F(SceneFiles, GltfHasNodesMaterialAndCamera) {
  for (const bool binary : {false, true}) {
    const GltfSquare square;
    const SceneFile file = binary ? read("a.glb", square.glb()) : read("a.gltf", square.gltf());
    ASSERT_EQ(file.scene.meshes.size(), 1u);
    EXPECT_EQ(file.triangles, 2);
    const Mesh& mesh = file.scene.meshes[0];
    for (const Vec3f& p : mesh.positions) EXPECT_FLOAT_EQ(p.y(), 1) << "the node's place";
    EXPECT_GT(facing(mesh, 0).y(), 0.999) << "a node that mirrors turns the winding";
    EXPECT_FLOAT_EQ(mesh.positions[mesh.indices[2]].x(), 1);
    EXPECT_TRUE(mesh.normals.empty()) << "glTF without normals is flat";
    EXPECT_EQ(mesh.material.kind, MaterialKind::kMetallicRough);
    EXPECT_LT((mesh.material.color - Rgbf(0.8f, 0.5f, 0.25f)).abs().maxCoeff(), 1e-6f);
    EXPECT_FLOAT_EQ(mesh.material.metallic, 0.25f);
    EXPECT_FLOAT_EQ(mesh.material.roughness, 0.5f);
    ASSERT_TRUE(file.vertical_fov_degrees.has_value());
    EXPECT_NEAR(*file.vertical_fov_degrees, 0.6 / kDegree, 1e-4);
    const Camera& camera = file.scene.camera;
    EXPECT_LT((camera.eye - Vec3f(0, 3, 5)).norm(), 1e-6f);
    EXPECT_LT((camera.look - camera.eye - Vec3f(0, -0.5f, -std::sqrt(0.75f))).norm(), 1e-5f);
    EXPECT_LT((camera.up - Vec3f(0, std::sqrt(0.75f), -0.5f)).norm(), 1e-5f);
  }
  GltfSquare no_aspect;
  no_aspect.camera = R"({"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}})";
  EXPECT_NEAR(read("b.gltf", no_aspect.gltf()).vertical_fov_degrees.value_or(0), 0.6 / kDegree, 1e-4);
}

TEST_F(SceneFiles, TexturesAreLinearAndTheRightWayUp) {
  GltfSquare square;
  square.material = R"({"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 1, 1], "baseColorTexture": {"index": 0},
      "metallicRoughnessTexture": {"index": 0}, "roughnessFactor": 0.5}})";
  square.node = R"("scale": [1, 1, 1])";
  // Upper left red, upper right green, lower left blue, lower right grey 188 (.5 in light, .737 as a number).
  const std::string picture = test::png(2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 188, 188, 188});
  square.image = "data:image/png;base64," + test::base64(picture);
  const Mesh inside = read("inside.gltf", square.gltf()).scene.meshes.at(0);
  square.image = "beside.png";
  write_file(scratch_ / "beside.png", picture);
  const Mesh beside = read("beside.gltf", square.gltf()).scene.meshes.at(0);
  for (const Mesh* mesh : {&inside, &beside}) {
    ASSERT_EQ(mesh->texcoords.size(), 4u);
    // The middle of each quarter of the square, seen from above with -z at the top.
    const auto at = [&](float x, float z) {
      for (std::uint32_t t = 0; t < 2; ++t) {
        Eigen::Matrix3f corners;
        for (int k = 0; k < 3; ++k) {
          const Vec3f& p = mesh->positions[mesh->indices[3 * t + static_cast<std::uint32_t>(k)]];
          corners.col(k) = Vec3f(p.x(), p.z(), 1);
        }
        const Vec3f w = corners.inverse() * Vec3f(x, z, 1);
        if (w.minCoeff() >= -1e-5f) return material_at(*mesh, t, {w[0], w[1], w[2]});
      }
      return Material{};
    };
    EXPECT_LT((at(-0.5f, -0.5f).color - Rgbf(1, 0, 0)).abs().maxCoeff(), 1e-5f);
    EXPECT_LT((at(0.5f, -0.5f).color - Rgbf(0, 0.5f, 0)).abs().maxCoeff(), 1e-5f);
    EXPECT_LT((at(-0.5f, 0.5f).color - Rgbf(0, 0, 1)).abs().maxCoeff(), 1e-5f);
    const Material grey = at(0.5f, 0.5f);
    EXPECT_NEAR(grey.color[0], linear_from_srgb(188 / 255.0), 1e-5);
    EXPECT_NEAR(grey.roughness, 0.5 * 188 / 255, 1e-5) << "numbers are no codes";
    EXPECT_NEAR(grey.metallic, 188 / 255.0, 1e-5);
    EXPECT_EQ(grey.color_texture, nullptr);
  }
  square.image = "nowhere.png";
  const SceneFile missing = read("missing.gltf", square.gltf());
  ASSERT_FALSE(missing.warnings.empty());
  EXPECT_NE(missing.warnings[0].find("nowhere.png"), std::string::npos);
  EXPECT_FLOAT_EQ(missing.scene.meshes.at(0).material.color[1], 0.5f) << "the plain colour stays";
}

TEST_F(SceneFiles, MtlIsReadAsFarAsItKeepsEnergy) {
  const std::string triangle = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
  const auto material = [&](const std::string& lines) {
    write_file(scratch_ / "a.mtl", "newmtl m\n" + lines);
    return read("a.obj", triangle).scene.meshes.at(0).material;
  };
  const Material matte = material("Kd 0.2 0.4 0.6\n");
  EXPECT_EQ(matte.kind, MaterialKind::kDiffuse);
  EXPECT_LT((matte.color - Rgbf(0.2f, 0.4f, 0.6f)).abs().maxCoeff(), 1e-6f);
  const Material phong = material("Kd 0.2 0.4 0.6\nKs 0.3 0.3 0.3\nNs 40\nillum 2\n");
  EXPECT_EQ(phong.kind, MaterialKind::kPhong);
  EXPECT_FLOAT_EQ(phong.exponent, 40);
  EXPECT_FLOAT_EQ(phong.diffuse[2], 0.6f);
  EXPECT_EQ(material("Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 250\n").kind, MaterialKind::kDiffuse);
  const Material rough = material("Kd 0.8 0.6 0.4\nPr 0.3\nPm 1\n");
  EXPECT_EQ(rough.kind, MaterialKind::kMetallicRough);
  EXPECT_FLOAT_EQ(rough.metallic, 1);
  EXPECT_FLOAT_EQ(rough.roughness, 0.3f);
  EXPECT_FLOAT_EQ(rough.color[1], 0.6f);
}

TEST_F(SceneFiles, TrianglesWithoutAreaAreDroppedAndSaid) {
  const SceneFile file = read("d.obj",
                              "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 1e6 1e6 1e6\nf 1 2 3\nf 1 2 2\nf 1 2 4\nf 5 5 5\n"
                              "f 1 3 4\n");
  EXPECT_EQ(file.triangles, 2);
  EXPECT_EQ(file.degenerate, 3);
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_NE(file.warnings[0].find("3 triangles without area"), std::string::npos);
  EXPECT_NE(refusal("e.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").find("1 without area"), std::string::npos);
}

TEST_F(SceneFiles, WhatIsNoMeshIsRefusedInALine) {
  EXPECT_NE(refusal("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").find("not finite"), std::string::npos);
  EXPECT_NE(refusal("inf.obj", "v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").find("1 of 3"), std::string::npos);
  for (const char* bad :
       {"", "v 1 2\n", "v 0 0 0\nf 1 2 3\n", "v 0 0 0\nv 1 0 0\nf 1 2\n", "v 0 0 0\nf 0 1 1\n", "v a b c\n",
        "this is a letter, not a mesh\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1\nl 1 2\n"})
    refusal("bad.obj", bad);
  refusal("bad.ply", std::string(kPly) + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 7\n3 0 2 9\n");
  refusal("short.ply", std::string(kPly) + "0 0 0\n1 0 0\n");
  refusal("head.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4\n");
  refusal("no.gltf", "{\"asset\": 3");
  refusal("no.glb", "glTF\2\0\0\0");
  refusal("text.xyz", "1 2 3\n");
  GltfSquare typeless;
  typeless.material = R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})";
  typeless.image = "data:imagexpng;base64,AAAA";
  EXPECT_NE(refusal("typeless.gltf", typeless.gltf()).find("media type"), std::string::npos);
  const GltfSquare square;
  for (const double share : {0.1, 0.5, 0.9, 0.97})
    refusal("cut.glb",
            square.glb().substr(0, static_cast<std::size_t>(share * static_cast<double>(square.glb().size()))));
  EXPECT_THROW(read_scene(scratch_ / "nothing.obj"), Error);
  EXPECT_THROW(read_scene(scratch_.path()), Error);
}

}  // namespace
}  // namespace hdr

// Scenes and cameras on the command line: good input, and what is said of bad one.
#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"
#include "tests/unit/render/scene_files.h"

namespace hdr::test {
namespace {

const char* const kRoof =
    "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\nf 1 2 3 4\n";

class Scenes : public ::testing::Test {
 protected:
  void SetUp() override { write_world(scratch_ / "world.exr", 64); }
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }
  std::string file(const std::string& name, const std::string& bytes) const {
    write_file(scratch_ / name, bytes);
    return at(name);
  }
  std::vector<std::string> render_of(const std::string& scene, std::vector<std::string> more = {}) const {
    std::vector<std::string> line{"render", "--probe", at("world.exr"), "--scene", scene, "--size",
                                  "32x24",  "-o",      at("out.exr")};
    if (std::find(more.begin(), more.end(), "--samples") == more.end()) line.insert(line.end(), {"--samples", "4"});
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }
  RadianceMap picture() const { return read_map(scratch_ / "out.exr").map; }

  ScratchDir scratch_;
};

// How much of the picture is covered, and whether its border is.
struct Cover {
  double share = 0, border = 0;
};
Cover cover_of(const RadianceMap& map) {
  Cover cover;
  const int w = map.alpha.width(), h = map.alpha.height();
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      cover.share += map.alpha(x, y) / (w * h);
      if (x == 0 || y == 0 || x == w - 1 || y == h - 1) cover.border += map.alpha(x, y);
    }
  }
  return cover;
}

TEST_F(Scenes, MeshesAreFramedWhateverTheirSizeAndPlace) {
  for (const double scale : {1e-4, 1.0, 1e5}) {
    std::string text;
    std::istringstream lines(kRoof);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string kind;
      double x = 0, y = 0, z = 0;
      words >> kind >> x >> y >> z;
      text += kind == "v" ? "v " + std::to_string(scale * (x + 7)) + " " + std::to_string(scale * y) + " " +
                                std::to_string(scale * (z - 3)) + "\n"
                          : line + "\n";
    }
    const Json answer = answer_of(render_of(file("roof.obj", text)));
    if (scale > 1e-3) {
      EXPECT_EQ(answer["triangles"], 6);
    }
    const Cover cover = cover_of(picture());
    EXPECT_GT(cover.share, 0.25) << scale;
    EXPECT_EQ(cover.border, 0) << scale;
  }
}

TEST_F(Scenes, GltfBringsItsCameraAndItsMaterial) {
  GltfSquare square;
  square.node = R"("translation": [0, 0, 0])";
  square.material = R"({"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.1, 0.1, 1], "metallicFactor": 0}})";
  answer_of(render_of(file("square.glb", square.glb()), {"--samples", "64"}));
  const RadianceMap own = picture();
  EXPECT_GT(cover_of(own).share, 0.05);
  const float* middle = own.rgb.pixel(16, 13);
  EXPECT_GT(middle[0], 3 * middle[1]) << "the file's red";
  answer_of(render_of(at("square.glb"),
                      {"--material", "diffuse:0.5", "--eye", "0,4,0.01", "--look", "0,0,0", "--fov", "20"}));
  const RadianceMap other = picture();
  EXPECT_EQ(other.alpha(0, 12), 1) << "flags win over the file's camera";
  EXPECT_LT(other.rgb(16, 12, 0), 2 * other.rgb(16, 12, 1)) << "and --material over its material";
}

TEST_F(Scenes, InsideAnObjectIsAPicture) {
  const Json answer = answer_of(render_of(file("roof.obj", kRoof), {"--eye", "0,0.3,0", "--look", "1,0.3,0"}));
  EXPECT_NEAR(cover_of(picture()).share, 1, 1e-6);
  EXPECT_EQ(answer_of({"info", at("out.exr")})["files"][0]["nan"], 0);
}

TEST_F(Scenes, BadMeshesAreRefusedInALine) {
  expect_refusal(render_of(at("nothing.obj")), {"nothing.obj", "no such file"});
  expect_refusal(render_of("castle"), {"castle", ".gltf"});
  expect_refusal(render_of(file("letter.obj", "Dear all,\nthis is no mesh.\n")), {"letter.obj", "give"});
  expect_refusal(render_of(file("empty.ply", "")), {"empty.ply", "PLY"});
  expect_refusal(render_of(file("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")), {"points.obj", "no triangles"});
  expect_refusal(render_of(file("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), {"nan.obj", "not finite"});
  expect_refusal(render_of(file("cut.glb", GltfSquare{}.glb().substr(0, 300))), {"cut.glb"});
  expect_refusal(render_of(file("roof.obj", kRoof), {"--fov", "180"}), {"--fov"});
  expect_refusal(render_of(at("roof.obj"), {"--eye", "1,1,1", "--look", "1,1,1"}), {"--eye", "--look"});
  expect_refusal(render_of(at("roof.obj"), {"--material", "phong:x"}), {"phong:x", "phong:EXPONENT"});
  expect_refusal({"prt", at("nothing.ply"), "-o", at("a.prt")}, {"nothing.ply"});
}

TEST_F(Scenes, WhatIsLeftOutIsSaid) {
  GltfSquare square;
  square.material = R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})";
  square.image = "nowhere.png";
  const Json answer = answer_of(render_of(file("square.gltf", square.gltf())));
  ASSERT_EQ(answer["warnings"].size(), 1u);
  EXPECT_NE(answer["warnings"][0].get<std::string>().find("nowhere.png"), std::string::npos);
  const Json dropped = answer_of(render_of(file("d.obj", std::string(kRoof) + "f 1 1 2\n")));
  EXPECT_EQ(dropped["degenerate"], 1);
  EXPECT_FALSE(dropped["warnings"].empty());
}

}  // namespace
}  // namespace hdr::test

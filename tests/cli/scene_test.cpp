// Scenes, cameras, layers and composites on the command line: good input, and what is said of bad one.
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

TEST_F(Scenes, PicturesToLookAtAreMetered) {
  for (const std::string name : {"a.png", "a.jpg"}) {
    const Json answer =
        answer_of({"render", "--probe", at("world.exr"), "--size", "32x24", "--samples", "4", "-o", at(name)});
    EXPECT_TRUE(answer.contains("stops"));
    EXPECT_EQ(answer_of({"info", at(name)})["files"][0]["width"], 32);
  }
  const Json given = answer_of({"render", "--probe", at("world.exr"), "--size", "32x24", "--samples", "4", "--stops",
                                "-2", "--transparent", "-o", at("b.png")});
  EXPECT_EQ(given["stops"], -2);
  EXPECT_EQ(answer_of({"info", at("b.png")})["files"][0]["channels"], 4);
  expect_refusal(render_of("sphere", {"--stops", "1"}), {"--stops"});
}

TEST_F(Scenes, LayersOfAnExr) {
  answer_of(render_of("sphere", {"--layers", "ao,normal,albedo,depth,variance,stddev", "--samples", "16"}));
  const CommandResult list = run_command({"oiiotool", "--info", "-v", at("out.exr")});
  if (list.exit_code == 0) {
    for (const std::string channel : {"ao", "normal.X", "normal.Z", "albedo.G", "depth", "variance", "stddev"})
      EXPECT_NE(list.out.find(channel), std::string::npos) << channel;
  }
  EXPECT_EQ(picture().rgb.width(), 32) << "and still a map";
  expect_refusal({"render", "--probe", at("world.exr"), "--layers", "normal", "-o", at("a.png")},
                 {"a.png", "--layers"});
}

TEST_F(Scenes, LightGoesFromSurfaceToSurface) {
  const std::string roof = file("roof.obj", kRoof);
  for (const std::string method : {"auto", "cache"}) {
    const Json answer = answer_of(render_of(roof, {"--method", method, "--bounces", "1"}));
    EXPECT_GT(answer["rays"].get<double>(), 0);
    EXPECT_GT(cover_of(picture()).share, 0.05) << method;
  }
  expect_refusal(render_of(roof, {"--method", "sh", "--bounces", "1"}), {"sh", "--bounces"});
}

TEST_F(Scenes, OpennessByDepthMaps) {
  const std::string roof = file("roof.obj", kRoof);
  const Json answer = answer_of(render_of(roof, {"--method", "ao", "--depth-maps", "32"}));
  EXPECT_EQ(answer["samples_per_pixel"], 32);
  expect_refusal(render_of(roof, {"--method", "mis", "--depth-maps", "32"}), {"mis", "--depth-maps"});
}

TEST_F(Scenes, TheColourChartStandsOnGroundThatOnlyShowsItsShadows) {
  answer_of(render_of("macbeth", {"--samples", "64"}));
  const RadianceMap map = picture();
  const Cover cover = cover_of(map);
  EXPECT_GT(cover.share, 0.15);
  EXPECT_LT(cover.share, 0.7) << "the plane is not there, its shadows are";
}

class Composites : public Scenes {
 protected:
  void SetUp() override {
    Scenes::SetUp();
    // The photograph: a render of grey ground, as a picture of codes.
    answer_of({"render",
               "--probe",
               at("world.exr"),
               "--scene",
               file("ground.obj", kGround),
               "--material",
               "diffuse:0.4",
               "--eye",
               "0,2,5",
               "--look",
               "0,0.3,0",
               "--fov",
               "50",
               "--size",
               "48x36",
               "--samples",
               "64",
               "--stops",
               "-1",
               "-o",
               at("photo.png")});
  }
  std::vector<std::string> composite_of(std::vector<std::string> more) const {
    std::vector<std::string> line{"composite", "--background", at("photo.png"), "--probe", at("world.exr")};
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }
  static constexpr const char* kGround = "v -30 0 -30\nv -30 0 30\nv 30 0 30\nv 30 0 -30\nf 1 2 3 4\n";
  const std::vector<std::string> camera_{"--eye", "0,2,5", "--look", "0,0.3,0", "--fov", "50"};
  std::vector<std::string> with_camera(std::vector<std::string> more) const {
    more.insert(more.end(), camera_.begin(), camera_.end());
    return composite_of(more);
  }
};

TEST_F(Composites, AnObjectThatIsNotSeenLeavesThePhotographToTheBit) {
  answer_of(
      with_camera({"--objects", file("roof.obj", kRoof), "--place", "0,-5,0", "--samples", "4", "-o", at("same.png")}));
  EXPECT_EQ(answer_of({"diff", at("photo.png"), at("same.png")})["max_abs"], 0);
  // Through a response as well as through sRGB.
  answer_of(with_camera({"--objects", at("roof.obj"), "--place", "0,-5,0", "--samples", "4", "--response", "gamma:2.2",
                         "-o", at("same.png")}));
  EXPECT_EQ(answer_of({"diff", at("photo.png"), at("same.png")})["max_abs"], 0);
}

TEST_F(Composites, AnObjectIsLitAndThrowsItsShadow) {
  const Json answer =
      answer_of(with_camera({"--objects", file("roof.obj", kRoof), "--place", "0,0,0", "--samples", "64",
                             "--ground-albedo", "0.4", "-o", at("out.png"), "--cut-out", at("cut.exr")}));
  EXPECT_TRUE(answer.contains("seconds"));
  EXPECT_NEAR(answer["ground_albedo"][1].get<double>(), 0.4, 1e-6);
  const Json diff = answer_of({"diff", at("photo.png"), at("out.png")});
  EXPECT_GT(diff["max_abs"].get<double>(), 0.05);
  const RadianceMap before = read_map(at("photo.png")).map, after = read_map(at("out.png")).map;
  int same = 0;
  for (int x = 0; x < 48; ++x) same += before.rgb(x, 0, 1) == after.rgb(x, 0, 1);
  EXPECT_GT(same, 40) << "far from it the photograph is as it was";
  EXPECT_GT(cover_of(read_map(at("cut.exr")).map).share, 0.05);
}

TEST_F(Composites, TheCameraComesFromARectangle) {
  const Json answer = answer_of(
      composite_of({"--objects", "sphere", "--place", "0,0,0", "--scale", "0.5", "--samples", "4", "--corners",
                    "12.38,25.04,35.62,25.04,32.14,17.69,15.86,17.69", "--rectangle", "2x2", "-o", at("out.exr")}));
  EXPECT_LT(answer["camera"]["residual_px"].get<double>(), 1);
  EXPECT_NEAR(answer["camera"]["eye"][1].get<double>(), 2, 0.05);
  EXPECT_NEAR(answer["camera"]["eye"][2].get<double>(), 5, 0.1);
  EXPECT_NEAR(answer["camera"]["fov"].get<double>(), 50, 1);
  expect_refusal(
      composite_of({"--objects", "sphere", "--corners", "1,2,3,4", "--rectangle", "2x2", "-o", at("out.exr")}),
      {"--corners", "eight"});
  expect_refusal(composite_of({"--objects", "sphere", "--corners", "14,25,33,25,30,18,17,18", "-o", at("out.exr")}),
                 {"--rectangle"});
}

TEST_F(Composites, WhatIsMissingIsSaid) {
  expect_refusal(composite_of({"--objects", "sphere", "-o", at("out.exr")}), {"--eye", "--corners"});
  expect_refusal(with_camera({"--objects", at("nothing.obj"), "-o", at("out.exr")}), {"nothing.obj"});
  expect_refusal({"composite", "--background", at("nothing.jpg"), "--probe", at("world.exr"), "--objects", "sphere",
                  "-o", at("out.exr")},
                 {"nothing.jpg"});
  EXPECT_EQ(run_hdr(with_camera({"--objects", "sphere", "--gain", "1", "--ground-albedo", "0.3", "-o", at("out.exr")}))
                .exit_code,
            2);
  // Units that do not fit are said.
  const Json bright =
      answer_of(with_camera({"--objects", "sphere", "--gain", "0.01", "--samples", "4", "-o", at("out.exr")}));
  ASSERT_FALSE(bright["warnings"].empty());
  EXPECT_NE(bright["warnings"][0].get<std::string>().find("--ground-albedo"), std::string::npos);
}

}  // namespace
}  // namespace hdr::test

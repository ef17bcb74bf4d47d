#include "libhdr/render/colour_chart.h"

#include "libhdr/core/color.h"

namespace hdr {
namespace {

constexpr std::array<std::array<int, 3>, 24> kSrgb = {
    {{115, 82, 68},   {194, 150, 130}, {98, 122, 157},  {87, 108, 67},   {133, 128, 177}, {103, 189, 170},
     {214, 126, 44},  {80, 91, 166},   {193, 90, 99},   {94, 60, 108},   {157, 188, 64},  {224, 163, 46},
     {56, 61, 150},   {70, 148, 73},   {175, 54, 60},   {231, 199, 31},  {187, 86, 149},  {8, 133, 161},
     {243, 243, 242}, {200, 200, 200}, {160, 160, 160}, {122, 122, 121}, {85, 85, 85},    {52, 52, 52}}};

Material matte(const Rgbf& albedo) {
  return {MaterialKind::kDiffuse, albedo, 1};
}

// A rectangle that faces +X, given by its side towards the viewer's left (+Z), its lower edge, and its size.
Mesh facing_x(float x, float left, float bottom, float width, float height, const Rgbf& albedo) {
  Mesh mesh;
  mesh.positions = {
      {x, bottom, left}, {x, bottom, left - width}, {x, bottom + height, left - width}, {x, bottom + height, left}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.material = matte(albedo);
  return mesh;
}

// As large as the balls, so that its patches are seen; its front is at x.
void add_chart(Scene& scene, float x) {
  constexpr float kPatch = 0.26f, kGap = 0.04f, kThick = 0.03f;
  constexpr float kWidth = 6 * kPatch + 7 * kGap, kHeight = 4 * kPatch + 5 * kGap, kLeft = 0.5f * kWidth;
  const Rgbf frame = Rgbf::Constant(0.04f);
  Mesh board;
  for (const float back : {x, x - kThick})
    for (const float y : {0.0f, kHeight})
      for (const float z : {kLeft, -kLeft}) board.positions.emplace_back(back, y, z);
  // Corners: bit 2 is the back, bit 1 the top, bit 0 the viewer's right.
  board.indices = {0, 1, 3, 0, 3, 2, 5, 4, 6, 5, 6, 7, 4, 0, 2, 4, 2, 6,
                   1, 5, 7, 1, 7, 3, 2, 3, 7, 2, 7, 6, 4, 5, 1, 4, 1, 0};
  board.material = matte(frame);
  scene.meshes.push_back(board);
  const std::array<Rgbf, 24> patches = colour_checker();
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const auto row = static_cast<float>(k / 6), column = static_cast<float>(k % 6);
    const float left = kLeft - kGap - column * (kPatch + kGap), bottom = kHeight - (row + 1) * (kPatch + kGap);
    scene.meshes.push_back(facing_x(x + 0.002f, left, bottom, kPatch, kPatch, patches[k]));
  }
}

}  // namespace

std::array<Rgbf, 24> colour_checker() {
  std::array<Rgbf, 24> linear;
  for (std::size_t k = 0; k < linear.size(); ++k)
    for (int c = 0; c < 3; ++c)
      linear[k][c] = static_cast<float>(linear_from_srgb(kSrgb[k][static_cast<std::size_t>(c)] / 255.0));
  return linear;
}

Scene colour_chart_set() {
  constexpr float kRadius = 0.6f, kApart = 1.75f;
  Scene scene;
  Material ground = matte(Rgbf::Constant(0.4f));
  ground.shadow_catcher = true;
  scene.meshes.push_back(plane_mesh(8, 0, ground));
  scene.meshes.push_back(sphere_mesh({0, kRadius, kApart}, kRadius, matte(Rgbf::Constant(0.18f))));
  scene.meshes.push_back(
      sphere_mesh({0, kRadius, -kApart}, kRadius, {MaterialKind::kMirror, Rgbf::Constant(0.95f), 0}));
  add_chart(scene, -0.2f);
  scene.camera.eye = {7, 1.6f, 0};
  scene.camera.look = {0, 0.65f, 0};
  scene.camera.fov_degrees = 40;
  return scene;
}

}  // namespace hdr

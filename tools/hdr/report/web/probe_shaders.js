// What the probe's viewer draws with. Directions as in libhdr/core/sphere.h: +Y up, a lat-long's centre is +Z, +X to
// the left of it.
'use strict';
const hdrShaders = (() => {
  const head = '#version 300 es\nprecision highp float;\nprecision highp sampler2D;\nprecision highp sampler2DArray;\n';

  const vertex = head + `
in vec2 corner;
out vec2 place;   // -1 .. 1, y up
void main() { place = corner; gl_Position = vec4(corner, 0.0, 1.0); }`;

  const scene = head + `
in vec2 place;
out vec4 colour;
uniform sampler2D probe;          // lat-long, radiance / scale
uniform sampler2DArray levels;    // GGX levels over the roughness that follow
uniform sampler2D table;          // the split sum: A, B over (n.v, roughness)
uniform float probe_scale, level_scale;
uniform float roughness_of[8];
uniform int level_count;
uniform mat4 irradiance[3];       // E = (n,1)^T M (n,1), one a channel
uniform mat3 camera;              // columns: right, up, forward
uniform vec2 extent;              // tan of half the field of view, x and y
uniform float distance_;          // of the camera from the middle, in radii
uniform int view;                 // 0 inside, 1 outside, 2 objects
uniform float roughness, gain;
const float kPi = 3.14159265358979;

vec2 place_of(vec3 d) {
  float v = acos(clamp(d.y, -1.0, 1.0)) / kPi;
  return vec2(0.5 - atan(d.x, d.z) / (2.0 * kPi), v);
}

// The seam is no edge: what jumps by a turn there is taken back before the derivatives choose a mip level.
vec3 light(vec3 d) {
  vec2 at = place_of(d);
  vec2 dx = dFdx(at), dy = dFdy(at);
  dx.x -= round(dx.x);
  dy.x -= round(dy.x);
  return textureGrad(probe, at, dx, dy).rgb * probe_scale;
}

vec3 glossy_light(vec3 d, float r) {
  vec2 at = place_of(d);
  int k = 0;
  while (k + 2 < level_count && roughness_of[k + 1] <= r) ++k;
  float share = clamp((r - roughness_of[k]) / (roughness_of[k + 1] - roughness_of[k]), 0.0, 1.0);
  return mix(textureLod(levels, vec3(at, float(k)), 0.0).rgb, textureLod(levels, vec3(at, float(k + 1)), 0.0).rgb, share)
      * level_scale;
}

vec3 diffuse_light(vec3 n) {
  vec4 h = vec4(n, 1.0);
  return max(vec3(dot(h, irradiance[0] * h), dot(h, irradiance[1] * h), dot(h, irradiance[2] * h)), 0.0);
}

const vec3 kCentres[3] = vec3[3](vec3(-2.25, 0.0, 0.0), vec3(0.0), vec3(2.25, 0.0, 0.0));

// Nearest of the unit spheres: its number and the ray's length, or -1.
int hit(vec3 o, vec3 d, out float t) {
  int which = -1;
  t = 1e9;
  for (int k = 0; k < 3; ++k) {
    vec3 oc = o - kCentres[k];
    float b = dot(oc, d), h = b * b - dot(oc, oc) + 1.0;
    float at = -b - sqrt(max(h, 0.0));
    if (h > 0.0 && at > 1e-3 && at < t) { t = at; which = k; }
  }
  return which;
}

vec3 gold(float nv, float r) {
  const vec3 f0 = vec3(1.0, 0.78, 0.34);
  vec2 ab = texture(table, vec2(nv, r)).rg;
  return f0 * ab.x + ab.y;
}

// Radiance of sphere k at n towards -d, but for what a mirror shows.
vec3 shaded(int k, vec3 n, vec3 d) {
  if (k == 0) return 0.8 / kPi * diffuse_light(n);
  vec3 r = reflect(d, n);
  return glossy_light(r, roughness) * gold(clamp(-dot(n, d), 0.0, 1.0), roughness);
}

vec3 objects(vec3 o, vec3 d) {
  vec3 back = light(d);   // before any branch: derivatives need neighbours
  float t;
  int k = hit(o, d, t);
  vec3 p = o + t * d, n = k >= 0 ? p - kCentres[max(k, 0)] : vec3(0.0, 1.0, 0.0);
  vec3 r = k == 2 ? reflect(d, n) : d;
  vec3 mirrored = light(r);
  if (k < 0) return back;
  if (k < 2) return shaded(k, n, d);
  float t2;
  int other = hit(p, r, t2);
  if (other == 0 || other == 1) return 0.97 * shaded(other, p + t2 * r - kCentres[other], r);
  return 0.97 * mirrored;
}

vec3 outside(vec3 o, vec3 d) {
  float b = dot(o, d), h = b * b - dot(o, o) + 1.0;
  vec3 n = h > 0.0 ? normalize(o + (-b - sqrt(max(h, 0.0))) * d) : d;
  vec3 seen = light(n);
  return h > 0.0 ? seen : vec3(0.0);
}

void main() {
  vec3 sum = vec3(0.0);
  int count = view == 0 ? 1 : 4;
  vec2 pixel = vec2(dFdx(place.x), dFdy(place.y));
  for (int k = 0; k < count; ++k) {   // a turned grid of four: edges of spheres
    vec2 at = place + (count == 1 ? vec2(0.0) : pixel * (vec2(k & 1, k >> 1) * 0.5 - 0.25));
    vec3 d = normalize(camera * vec3(at * extent, 1.0));
    vec3 o = -distance_ * camera[2];
    vec3 seen = view == 0 ? light(d) : view == 1 ? outside(o, d) : objects(o, d);
    sum += min(seen * gain, 60000.0) / float(count);
  }
  colour = vec4(sum, 1.0);
}`;

  // The bright parts: what is above white, without a step where it begins.
  const bright = head + `
in vec2 place;
out vec4 colour;
uniform sampler2D source;
void main() {
  vec3 c = texture(source, 0.5 * place + 0.5).rgb;
  float most = max(c.r, max(c.g, c.b));
  colour = vec4(c * max(most - 1.0, 0.0) / max(most, 1e-6), 1.0);
}`;

  // Half the size, or twice: a tent over the source's pixels.
  const resample = head + `
in vec2 place;
out vec4 colour;
uniform sampler2D source;
uniform vec2 step_;
void main() {
  vec2 at = 0.5 * place + 0.5;
  vec3 sum = 4.0 * texture(source, at).rgb;
  for (int k = 0; k < 4; ++k) sum += texture(source, at + step_ * (vec2(k & 1, k >> 1) * 2.0 - 1.0)).rgb * 2.0;
  for (int k = -1; k < 2; k += 2) {
    sum += texture(source, at + step_ * vec2(k, 0)).rgb + texture(source, at + step_ * vec2(0, k)).rgb;
  }
  colour = vec4(sum / 16.0, 1.0);
}`;

  // A streak: each pass reaches four times as far as the one before it [Kawase03].
  const streak = head + `
in vec2 place;
out vec4 colour;
uniform sampler2D source;
uniform vec2 step_;
uniform float fade;
void main() {
  vec2 at = 0.5 * place + 0.5;
  vec3 sum = vec3(0.0);
  float weight = 1.0, total = 0.0;
  for (int k = 0; k < 4; ++k) {
    sum += weight * texture(source, at + float(k) * step_).rgb;
    total += weight;
    weight *= fade;
  }
  colour = vec4(sum / total, 1.0);
}`;

  // What the eye and the lens add: halos and streaks of what is above white; then the tone and sRGB.
  const display = head + `
in vec2 place;
out vec4 colour;
uniform sampler2D source, halo, star;
uniform float glare;
uniform int tone;   // 0 filmic, 1 clip
float hable(float x) { return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3; }
float shown(float x) {
  x = tone == 0 ? hable(2.0 * x) / hable(11.2) : x;
  x = clamp(x, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}
void main() {
  vec2 at = 0.5 * place + 0.5;
  vec3 c = texture(source, at).rgb;
  if (glare > 0.0) c += glare * (texture(halo, at).rgb + texture(star, at).rgb);
  colour = vec4(shown(c.r), shown(c.g), shown(c.b), 1.0);
}`;

  return { vertex, scene, bright, resample, streak, display };
})();

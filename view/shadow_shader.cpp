#include "view/shadow_shader.h"

#include "view/shaders.h"

namespace fascia::view {

namespace {

// Percentage-closer soft shadows: Fernando 2005. Also how thick the stuff before the light is.
const char* shadow_source = R"(
uniform bool has_shadows;
uniform sampler2D shadow_map;
uniform mat4 to_light;
uniform float light_span, light_range;   // metres
uniform float key_size;
uniform float turn;                      // 0..1, another for each round of samples
const mat2 golden_turn = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);   // by pi (3 - sqrt 5)
float grain(vec2 at) { return fract(52.9829189 * fract(dot(floor(at), vec2(0.06711056, 0.00583715)))); }
float lit_share(vec3 p, vec3 n, out float thickness) {
  thickness = 1.0;
  if (!has_shadows) return 1.0;
  vec3 at = (to_light * vec4(p + 0.0011 * n, 1.0)).xyz * 0.5 + 0.5;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  float angle = 6.2831853 * (grain(gl_FragCoord.xy) + turn);
  vec2 first = vec2(cos(angle), sin(angle)), toward = first;   // turned on tap by tap: no sine for each
  float texel = 1.0 / float(textureSize(shadow_map, 0).x), bias = 0.0006 / light_range;
  float reach = max(key_size * 0.022 / light_span, 2.0 * texel), found = 0.0, sum = 0.0, through = 0.0;
  for (int i = 0; i < SEARCHES; ++i) {
    float share = (float(i) + 0.5) / float(SEARCHES);
    float depth = texture(shadow_map, at.xy + reach * sqrt(share) * toward).r;
    toward = golden_turn * toward;
    through += max(at.z - depth, 0.0);
    if (depth < at.z - bias) { found += 1.0; sum += depth; }
  }
  thickness = through / float(SEARCHES) * light_range;
  if (found == 0.0) return 1.0;
  float gap = (at.z - sum / found) * light_range;
  float width = clamp(gap * key_size / light_span, 1.5 * texel, 0.06), lit = 0.0;
  toward = first;
  for (int i = 0; i < TAPS; ++i) {
    float share = (float(i) + 0.5) / float(TAPS);
    float depth = texture(shadow_map, at.xy + width * sqrt(share) * toward).r;
    toward = golden_turn * toward;
    lit += depth < at.z - bias * (1.0 + 2.0 * width / texel * 0.15) ? 0.0 : 1.0;
  }
  return lit / float(TAPS);
}
)";

// Ambient occlusion: McGuire, Mara & Luebke 2012, Scalable ambient obscurance, equation 1.
const char* screen_light_source = R"(uniform sampler2D geometry;
uniform vec2 size;        // pixels
uniform vec2 scale;       // eye coordinates at distance 1, from the picture's middle to its edge
uniform float radius;     // metres
uniform bool has_occlusion;
uniform mat4 from_eye;
out vec4 result;
vec3 eye_position(vec2 at, float distance) {
  return vec3((2.0 * at / size - 1.0) * scale * distance, -distance);
}
float open_share(vec3 p, vec3 n, float distance_here) {
  float reach = radius / distance_here / scale.y * 0.5 * size.y;
  float turn = 6.2831853 * grain(gl_FragCoord.xy);
  float sum = 0.0;
  const int count = 16;
  const mat2 on = mat2(-0.92387953, 0.38268343, -0.38268343, -0.92387953);   // by 7/16 of a turn
  vec2 toward = vec2(cos(turn + 1.3744468), sin(turn + 1.3744468));          // half of that, from a chance start
  for (int i = 0; i < count; ++i) {
    float share = (float(i) + 0.5) / float(count);
    vec2 at = gl_FragCoord.xy + max(reach * share, 1.0 + float(i) * 0.2) * toward;
    toward = on * toward;
    if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, size))) continue;
    float distance = texelFetch(geometry, ivec2(at), 0).w;
    if (distance <= 0.0) continue;
    vec3 v = eye_position(at, distance) - p;
    float vv = dot(v, v), vn = dot(v, n) - 0.0004;
    float f = max(radius * radius - vv, 0.0) / (radius * radius);
    sum += f * f * f * max(vn / (vv + 1e-7), 0.0);
  }
  return clamp(1.0 - 2.6 * radius * sum / float(count), 0.0, 1.0);
}
void main() {
  vec4 here = texelFetch(geometry, ivec2(gl_FragCoord.xy), 0);
  if (here.w <= 0.0) { result = vec4(1.0, 0.0, 1.0, 1.0); return; }
  vec3 p = eye_position(gl_FragCoord.xy, here.w), n = normalize(here.xyz);
  float thickness, lit = lit_share((from_eye * vec4(p, 1.0)).xyz, mat3(from_eye) * n, thickness);
  result = vec4(has_occlusion ? open_share(p, n, here.w) : 1.0, here.w, lit, thickness);
})";

}  // namespace

std::string soft_shadow_source(int searches, int taps) {
  return "#define SEARCHES " + std::to_string(searches) + "\n#define TAPS " + std::to_string(taps) + "\n" +
         shadow_source;
}

std::string screen_light_fragment_shader() {
  return "#version 330 core\n" + soft_shadow_source(5, 8) + screen_light_source;
}

}  // namespace fascia::view

#include "view/shaders.h"

namespace fascia::view {

std::string line_fragment_shader() {
  return R"(#version 330 core
in vec3 base;
out vec4 pixel;
void main() { pixel = vec4(base, 1.0); })";
}

std::string depth_fragment_shader() {
  return R"(#version 330 core
in vec2 uv;
in vec3 place;
uniform bool has_holes;
uniform float cutoff;
uniform vec4 cut;
uniform sampler2D colour_map;
void main() {
  if (dot(cut.xyz, place) > cut.w) discard;
  if (has_holes && texture(colour_map, uv).a < cutoff) discard;
})";
}

std::string geometry_fragment_shader() {
  return R"(#version 330 core
in vec3 place;
in vec3 facing;
uniform mat4 to_eye;
uniform vec4 cut;
out vec4 geometry;
void main() {
  if (dot(cut.xyz, place) > cut.w) discard;
  vec3 n = mat3(to_eye) * normalize(facing);
  vec3 p = (to_eye * vec4(place, 1.0)).xyz;
  if (dot(n, p) > 0.0) n = -n;
  geometry = vec4(n, -p.z);
})";
}

std::string screen_vertex_shader() {
  return R"(#version 330 core
out vec2 place;
void main() {
  place = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
})";
}

std::string occlusion_fragment_shader() {
  return R"(#version 330 core
uniform sampler2D geometry;
uniform vec2 size;        // pixels
uniform vec2 scale;       // eye coordinates at distance 1, from the picture's middle to its edge
uniform float radius;     // metres
out vec2 result;
vec3 eye_position(vec2 at, float distance) {
  return vec3((2.0 * at / size - 1.0) * scale * distance, -distance);
}
void main() {
  vec4 here = texelFetch(geometry, ivec2(gl_FragCoord.xy), 0);
  if (here.w <= 0.0) { result = vec2(1.0, 0.0); return; }
  vec3 p = eye_position(gl_FragCoord.xy, here.w), n = here.xyz;
  float reach = radius / here.w / scale.y * 0.5 * size.y;
  float turn = 6.2831853 * fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  float sum = 0.0;
  const int count = 16;
  for (int i = 0; i < count; ++i) {
    float share = (float(i) + 0.5) / float(count);
    float angle = turn + 6.2831853 * 7.0 * share;
    vec2 at = gl_FragCoord.xy + max(reach * share, 1.0 + float(i) * 0.2) * vec2(cos(angle), sin(angle));
    float distance = texelFetch(geometry, ivec2(clamp(at, vec2(0.0), size - 1.0)), 0).w;
    if (distance <= 0.0) continue;
    vec3 v = eye_position(at, distance) - p;
    float vv = dot(v, v), vn = dot(v, n) - 0.0004;
    float f = max(radius * radius - vv, 0.0) / (radius * radius);
    sum += f * f * f * max(vn / (vv + 1e-7), 0.0);
  }
  result = vec2(clamp(1.0 - 2.6 * radius * sum / float(count), 0.0, 1.0), here.w);
})";
}

std::string occlusion_blur_fragment_shader() {
  return R"(#version 330 core
uniform sampler2D occlusion;
out vec2 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(occlusion, 0) - 1;
  vec2 here = texelFetch(occlusion, at, 0).xy;
  vec2 sum = vec2(0.0);
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      vec2 other = texelFetch(occlusion, clamp(at + ivec2(x, y), ivec2(0), last), 0).xy;
      float weight = abs(other.y - here.y) < 0.004 ? 1.0 : 0.0;
      sum += weight * vec2(other.x, 1.0);
    }
  result = vec2(sum.y > 0.0 ? sum.x / sum.y : here.x, here.y);
})";
}

std::string backdrop_fragment_shader() {
  return R"(#version 330 core
in vec2 place;
uniform vec3 background;
uniform float aspect;
out vec4 pixel;
void main() {
  vec2 from = (place - vec2(0.5, 0.56)) * vec2(min(aspect, 1.6), 1.0);
  float light = mix(1.45, 0.50, smoothstep(0.0, 0.95, length(from)));
  pixel = vec4(background * light, 1.0);
})";
}

std::string copy_fragment_shader() {
  return R"(#version 330 core
in vec2 place;
uniform sampler2D picture;
uniform float grain;
out vec4 pixel;
void main() {
  float noise = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  pixel = vec4(texture(picture, place).rgb + grain * (noise - 0.5) / 255.0, 1.0);
})";
}

}  // namespace fascia::view

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
in vec2 uv;
in vec3 place;
in vec3 facing;
uniform bool has_holes;
uniform float cutoff;
uniform mat4 to_eye;
uniform vec4 cut;
uniform sampler2D colour_map;
out vec4 geometry;
void main() {
  if (dot(cut.xyz, place) > cut.w) discard;
  if (has_holes && texture(colour_map, uv).a < cutoff) discard;
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

std::string screen_blur_fragment_shader() {
  return R"(#version 330 core
uniform sampler2D light;
out vec4 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(light, 0) - 1;
  vec4 here = texelFetch(light, at, 0), sum = vec4(0.0);
  float weights = 0.0;
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      vec4 other = texelFetch(light, clamp(at + ivec2(x, y), ivec2(0), last), 0);
      float weight = abs(other.y - here.y) < 0.004 ? 1.0 : 0.0;
      sum += weight * other;
      weights += weight;
    }
  result = vec4(weights > 0.0 ? sum / weights : here);
  result.y = here.y;
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
uniform vec2 spread;   // from the pixel's middle to the four places that are averaged
out vec4 pixel;
void main() {
  float noise = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  vec3 colour = texture(picture, place).rgb;
  if (spread.x > 0.0)
    colour = 0.25 * (texture(picture, place + spread).rgb + texture(picture, place - spread).rgb +
                     texture(picture, place + vec2(spread.x, -spread.y)).rgb +
                     texture(picture, place + vec2(-spread.x, spread.y)).rgb);
  pixel = vec4(colour + grain * (noise - 0.5) / 255.0, 1.0);
})";
}

}  // namespace fascia::view

#include "view/shaders.h"
#include "view/shadow_shader.h"

namespace fascia::view {

namespace {

const char* declarations = R"(
in vec3 place;
in vec3 facing;
in vec3 base;
in vec2 uv;
in vec3 eye_place;
uniform vec3 camera;
uniform float opacity, roughness, metalness, specular, normal_strength, cutoff, exposure;
uniform bool has_colour_map, has_normal_map, has_surface_map, is_blended, is_drawn_eye;
uniform vec3 glow;
uniform vec4 cut;
uniform sampler2D colour_map, normal_map, surface_map;
uniform vec3 key_direction, key_irradiance;
uniform vec3 harmonics[9];
uniform samplerCube reflections;
uniform float reflection_levels;
uniform sampler2D screen_map;   // openness, distance, share of the key's light, thickness (screen_light_source)
uniform bool has_screen_map;    // else every place is open and lit
uniform float screen_scale;     // its pixels to one of the picture's
uniform vec3 view_direction;    // along which its distances are measured
out vec4 pixel;

vec3 to_linear(vec3 c) { return pow(max(c, 0.0), vec3(2.2)); }

// The shoulder and toe of film: Uchimura 2017, HDR theory and practice (Gran Turismo).
vec3 filmic(vec3 x) {
  const float m = 0.22, a = 1.0, c = 1.33, l = 0.4, top = 1.0;
  float l0 = (top - m) * l / a, s0 = m + l0, s1 = m + a * l0, c2 = a * top / (top - s1);
  vec3 toe = m * pow(max(x, 1e-6) / m, vec3(c)), line = m + a * (x - m);
  vec3 shoulder = top - (top - s1) * exp(-c2 * (x - s0) / top);
  vec3 w0 = 1.0 - smoothstep(vec3(0.0), vec3(m), x), w2 = step(vec3(m + l0), x);
  return toe * w0 + line * (1.0 - w0 - w2) + shoulder * w2;
}
vec3 finished(vec3 light) { return pow(clamp(filmic(light * exposure), 0.0, 1.0), vec3(1.0 / 2.2)); }

vec3 irradiance(vec3 n) {
  return max(harmonics[0] + harmonics[1] * n.y + harmonics[2] * n.z + harmonics[3] * n.x +
             harmonics[4] * n.x * n.y + harmonics[5] * n.y * n.z + harmonics[6] * (3.0 * n.z * n.z - 1.0) +
             harmonics[7] * n.x * n.z + harmonics[8] * (n.x * n.x - n.y * n.y), 0.0);
}
vec3 reflected(vec3 direction, float rough) {
  return textureLod(reflections, direction, rough * reflection_levels).rgb;
}
)";

// The screen's light brought up to the picture's size along surfaces only.
const char* screen_source = R"(
vec4 screen_light(vec3 p) {
  float distance = dot(p - camera, view_direction);
  vec2 at = gl_FragCoord.xy * screen_scale;
  ivec2 nearest = ivec2(floor(at)), last = textureSize(screen_map, 0) - 1;
  vec4 sum = vec4(0.0);
  float weights = 0.0;
  // The pixel at the place itself may show another surface, where one ends before the other: its neighbours count
  // a little always, and more the better their distance fits.
  for (int k = 0; k < 5; ++k) {
    ivec2 o = k == 0 ? ivec2(0) : k == 1 ? ivec2(1, 0) : k == 2 ? ivec2(-1, 0) : k == 3 ? ivec2(0, 1) : ivec2(0, -1);
    vec4 one = texelFetch(screen_map, clamp(nearest + o, ivec2(0), last), 0);
    vec2 off = max(1.0 - abs(at - (vec2(nearest + o) + 0.5)), 0.0);
    float w = (off.x * off.y + 0.05) / (0.0002 + abs(one.y - distance));
    sum += w * one;
    weights += w;
  }
  return weights > 0.0 ? sum / weights : vec4(1.0);
}
)";

// The share of the room that is left in a mirror inside a mouth: 0 where lips, teeth or cheeks stand before
// it. Followed along the ray over the picture's distances (McGuire & Mara 2014, Efficient GPU screen-space
// ray tracing, in even steps).
const char* mirror_source = R"(
uniform mat4 to_clip;
float mirrored_share_of_room(vec3 p, vec3 direction) {
  const int count = 10;
  ivec2 size = textureSize(screen_map, 0);
  float share = 1.0, offset = grain(gl_FragCoord.xy);
  for (int i = 0; i < count; ++i) {
    float along = (float(i) + offset + 0.2) / float(count);
    vec3 q = p + 0.07 * along * sqrt(along) * direction;
    vec4 c = to_clip * vec4(q, 1.0);
    ivec2 at = ivec2(floor((0.5 + 0.5 * c.xy / c.w) * vec2(size)));
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) break;
    float there = texelFetch(screen_map, at, 0).y;
    if (there > 0.0) share = min(share, 1.0 - smoothstep(0.0005, 0.004, dot(q - camera, view_direction) - there));
  }
  return share;
}
)";

// The lobes: Burley 2012 (GGX), Karis 2014 (the split sum's second factor by polynomials).
const char* light_source = R"(
float lobe(vec3 n, vec3 v, vec3 l, float rough) {
  float a = clamp(rough * rough + 0.35 * key_size, 0.002, 1.0), a2 = a * a;
  vec3 h = normalize(v + l);
  float nh = max(dot(n, h), 0.0), nl = max(dot(n, l), 0.0), nv = max(dot(n, v), 1e-3);
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float shape = rough * rough / a;   // a larger source is a weaker one
  return shape * shape * a2 / (d * d) / max(4.0 * mix(nl, 1.0, a * 0.5) * mix(nv, 1.0, a * 0.5), 0.05) * nl;
}
vec3 fresnel(vec3 f0, float cosine) {
  float c = 1.0 - clamp(cosine, 0.0, 1.0), c2 = c * c;
  return f0 + (1.0 - f0) * (c2 * c2 * c);
}
vec3 mirrored_share(vec3 f0, float rough, float nv) {
  vec4 r = rough * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
  vec2 ab = vec2(-1.04, 1.04) * a + r.zw;
  return f0 * ab.x + ab.y;
}
vec3 key_gloss(vec3 n, vec3 v, vec3 f0, float rough, float lit) {
  vec3 l = key_direction, h = normalize(l + v);
  return key_irradiance * lit * fresnel(f0, dot(v, h)) * lobe(n, v, l, rough);
}
vec3 room_gloss(vec3 n, vec3 v, vec3 f0, float rough, float open) {
  float nv = max(dot(n, v), 1e-3);
  vec3 r = reflect(-v, n);
  float room = clamp(pow(nv + open, exp2(-16.0 * rough - 1.0)) - 1.0 + open, 0.0, 1.0);   // Lagarde 2014
  return reflected(r, rough) * mirrored_share(f0, rough, nv) * room;
}
// Light from the key and from the room off a surface of one roughness.
vec3 gloss(vec3 n, vec3 v, vec3 f0, float rough, float lit, float open) {
  return key_gloss(n, v, f0, rough, lit) + room_gloss(n, v, f0, rough, open);
}
// Occlusion as coloured stuff sees it: Jimenez et al. 2016, Practical realtime strategies for accurate
// indirect occlusion, equation 10.
vec3 tinted(float open, vec3 albedo) {
  vec3 a = 2.0404 * albedo - 0.3324, b = -4.7951 * albedo + 0.6417, c = 2.7552 * albedo + 0.6903;
  return max(vec3(open), ((open * a + b) * open + c) * open);
}
vec3 mapped_normal(vec3 n) {
  if (!has_normal_map) return n;
  vec3 bump = texture(normal_map, uv).xyz * 2.0 - 1.0;
  vec3 px = dFdx(place), py = dFdy(place);
  vec2 ux = dFdx(uv), uy = dFdy(uv);
  vec3 across = cross(py, n), along = cross(n, px);
  vec3 t = across * ux.x + along * uy.x, b = across * ux.y + along * uy.y;
  float largest = max(dot(t, t), dot(b, b));
  if (largest < 1e-20) return n;
  return normalize(inversesqrt(largest) * (t * bump.x - b * bump.y) * normal_strength + n * max(bump.z, 0.05));
}
)";

// An iris and a pupil drawn by the angle from the gaze, seen through the cornea.
const char* eye_source = R"(
float hash(float x) { return fract(sin(x * 127.1) * 43758.5453); }
float wave(float x, float period) {
  float i = floor(x), f = fract(x);
  f = f * f * (3.0 - 2.0 * f);
  return mix(hash(mod(i, period)), hash(mod(i + 1.0, period)), f);
}
vec3 drawn_eye(vec3 white, vec3 n, vec3 v, out float iris_share) {
  vec3 d = normalize(eye_place);
  float angle = degrees(acos(clamp(d.z, -1.0, 1.0)));
  // The iris lies behind the cornea: looked at from aside it seems shifted toward the onlooker.
  vec2 at = d.xy / max(length(d.xy), 1e-5) * angle;
  float around = atan(at.y, at.x) / 6.2831853 + 0.5, r = angle / 27.5;
  float soft = max(fwidth(r), 0.012);
  iris_share = 1.0 - smoothstep(1.0 - 0.5 * soft - 0.035, 1.0 + 0.5 * soft + 0.02, r);
  float fibres = 0.55 * wave(around * 90.0, 90.0) + 0.30 * wave(around * 211.0 + 7.0 * r, 211.0) +
                 0.15 * wave(around * 37.0 - 3.0 * r, 37.0);
  vec3 outer = mix(vec3(0.085, 0.13, 0.17), vec3(0.30, 0.40, 0.45), fibres);
  vec3 inner = mix(vec3(0.20, 0.15, 0.08), vec3(0.42, 0.34, 0.20), fibres);
  vec3 iris = mix(inner, outer, smoothstep(0.36, 0.66, r + 0.10 * (fibres - 0.5)));
  iris *= mix(1.0, 0.22, smoothstep(0.78, 1.0, r));
  iris *= mix(0.02, 1.0, smoothstep(0.335 - 0.5 * soft, 0.365 + 0.5 * soft, r));
  float veins = wave(around * 61.0 + 2.5 * wave(r * 6.0, 64.0), 61.0) * wave(around * 29.0 + 1.7 * r, 29.0);
  vec3 sclera = white * mix(vec3(1.0), vec3(1.0, 0.80, 0.76), 0.55 * smoothstep(1.1, 2.4, r));
  sclera *= mix(vec3(1.0), vec3(0.98, 0.70, 0.66), 0.55 * smoothstep(0.45, 0.8, veins) * smoothstep(1.2, 2.2, r));
  sclera *= mix(0.62, 1.0, smoothstep(0.98, 1.14, r));
  return mix(sclera, iris, iris_share);
}
)";

const char* main_source = R"(
void main() {
#if HOLES
  if (dot(cut.xyz, place) > cut.w) discard;
#endif
  vec3 v = normalize(camera - place), n = normalize(facing);
  bool is_back = !gl_FrontFacing;
  if (is_back) n = -n;
  vec4 painted = has_colour_map ? texture(colour_map, uv) : vec4(1.0);
#if HOLES
  if (cutoff >= 0.0 && painted.a < cutoff) discard;
#endif
  vec3 colour = to_linear(base * painted.rgb);
  float alpha = opacity * (is_blended ? painted.a : 1.0);
  float rough = roughness, metal = metalness;
  if (has_surface_map) { vec2 s = texture(surface_map, uv).gb; rough *= s.x; metal *= s.y; }
  rough = clamp(rough, 0.05, 1.0);

#if DATA
  float form = 0.80 + 0.20 * max(dot(n, normalize(v + vec3(0.0, 0.6, 0.0))), 0.0);
  pixel = vec4(pow(clamp(colour, 0.0, 1.0), vec3(1.0 / 2.2)) * form * (is_back ? 0.6 : 1.0), alpha);
#elif XRAY
  float edge = 1.0 - abs(dot(n, v));
  float density = mix(mix(0.10, 1.0, smoothstep(0.65, 1.0, alpha)), 1.0, pow(edge, 2.0));
  vec3 light = colour * (irradiance(n) + 0.35 * key_irradiance * max(dot(n, key_direction), 0.0)) +
               gloss(n, v, vec3(0.03), 0.35, 0.5, 1.0);
  pixel = vec4(finished(light), clamp(alpha * density * 1.6, 0.0, 1.0));
#else
  vec4 screen = has_screen_map ? screen_light(place) : vec4(1.0, 0.0, 1.0, 1.0);
  float open = screen.x, lit = screen.z, thickness = screen.w;
#if MOUTH
  float mirrored = has_screen_map ? mirrored_share_of_room(place, reflect(-v, n)) : 0.35;
#else
  float mirrored = 1.0;
#endif
#if HAIR
  lit = lit_share(place, n, thickness);   // what lies behind a card of hair says nothing about its own shadow
#endif
  vec3 m = mapped_normal(n), l = key_direction, light;
  if (dot(m, v) < 0.02) m = normalize(m + (0.02 - dot(m, v)) * v);
  float nl = dot(m, l);
#if SKIN
  // Wider for red: what comes back out of the skin has gone sideways (after Penner 2011, Pre-integrated
  // skin shading); bumps that red light does not see (Jimenez et al. 2009).
  vec3 wrap = vec3(0.125, 0.090, 0.075) * SOFTNESS;
  vec3 slope = vec3(dot(mix(m, n, 0.65), l), dot(mix(m, n, 0.35), l), nl);
  vec3 falling = clamp((slope + wrap) / (1.0 + wrap), 0.0, 1.0);
  vec3 shade = pow(vec3(lit), vec3(0.93, 1.0, 1.03));
  light = colour * key_irradiance * falling * shade;
  // Where the surface only begins to turn away there is little before the light too, but no ear or nostril.
  float behind = smoothstep(0.1, 0.8, -dot(n, l));
  light += to_linear(vec3(0.90, 0.46, 0.34)) * key_irradiance * behind * exp(-thickness / 0.0042) * 0.5 * TRANSLUCENCY;
  light += colour * irradiance(mix(m, n, 0.5)) * tinted(open, colour);
  // Two lobes for the key; the room, wide as it is, is mirrored once at their mean.
  light += (key_gloss(m, v, vec3(0.028), rough, lit) * 0.80 + key_gloss(m, v, vec3(0.028), rough * 0.58, lit) * 0.20 +
            mirrored * room_gloss(m, v, vec3(0.028), rough * 0.92, open)) * specular;
#if WET
  vec3 film = normalize(mix(n, m, 0.6));
  light += (key_gloss(film, v, vec3(0.035), 0.16, lit) +
            mirrored * room_gloss(film, v, vec3(0.035), 0.22, open)) * 0.9;
#endif
#elif EYE
  float iris_share = 0.0;
  if (is_drawn_eye) colour = to_linear(drawn_eye(base, n, v, iris_share));
  float soft = clamp((dot(n, l) + 0.20) / 1.20, 0.0, 1.0);
  // The iris is a bowl behind a lens: brightest across from the light.
  vec3 bowl = is_drawn_eye ? normalize(mix(n, 2.0 * dot(n, v) * v - n, 0.35 * iris_share)) : n;
  float inside = mix(soft, clamp(dot(bowl, l) * 0.7 + 0.35, 0.0, 1.0), iris_share);
  light = colour * (key_irradiance * inside * mix(lit, 1.0, 0.12) + irradiance(n) * tinted(open, colour));
  light += gloss(n, v, vec3(0.030), 0.07, max(lit, 0.0), open) * 1.6;
#elif HAIR
  light = colour * (key_irradiance * (0.35 + 0.65 * max(nl, 0.0)) * lit + irradiance(n) * open);
  light += gloss(n, v, vec3(0.046), rough, lit, open) * 0.35;
#else
  vec3 f0 = mix(vec3(0.04) * specular, colour, metal);
  vec3 diffuse = colour * (1.0 - metal);
  float slope = clamp((nl + WRAP) / (1.0 + WRAP), 0.0, 1.0);
  light = diffuse * (key_irradiance * slope * lit + irradiance(m) * tinted(open, diffuse));
  light += key_gloss(m, v, f0, rough, lit) + mirrored * room_gloss(m, v, f0, rough, open);
#if WET
  vec3 film = normalize(mix(n, m, 0.5));
  light += (key_gloss(film, v, vec3(0.04), 0.14, lit) + mirrored * room_gloss(film, v, vec3(0.04), 0.14, open)) * 0.8;
#endif
#endif
  if (is_back) light *= 0.5;
  pixel = vec4(finished(light + to_linear(glow)), alpha);
#endif
})";

const char* definitions(Shading shading) {
  switch (shading) {
    case Shading::skin:
      return "#define SKIN 1\n#define SOFTNESS 1.0\n#define TRANSLUCENCY 1.0\n";
    case Shading::mucosa:
      return "#define SKIN 1\n#define WET 1\n#define MOUTH 1\n#define SOFTNESS 1.2\n#define TRANSLUCENCY "
             "0.3\n";
    case Shading::tooth:
      return "#define WET 1\n#define MOUTH 1\n#define WRAP 0.30\n";
    case Shading::eye:
      return "#define EYE 1\n";
    case Shading::hair:
      return "#define HAIR 1\n";
    case Shading::bone:
      return "#define WRAP 0.12\n";
    case Shading::muscle:
      return "#define WET 1\n#define WRAP 0.18\n";
    case Shading::xray:
      return "#define XRAY 1\n";
    case Shading::data:
      return "#define DATA 1\n";
    case Shading::plain:
      break;
  }
  return "#define WRAP 0.0\n";
}

}  // namespace

std::string surface_vertex_shader() {
  return R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 colour;
layout(location = 3) in vec2 texture_place;
layout(location = 4) in vec3 eye_coordinate;
uniform mat4 to_clip;
out vec3 place;
out vec3 facing;
out vec3 base;
out vec2 uv;
out vec3 eye_place;
void main() {
  gl_Position = to_clip * vec4(position, 1.0);
  place = position;
  facing = normal;
  base = colour;
  uv = texture_place;
  eye_place = eye_coordinate;
})";
}

std::string surface_fragment_shader(Shading shading, bool has_holes) {
  return std::string("#version 330 core\n") + definitions(shading) + (has_holes ? "#define HOLES 1\n" : "") +
         soft_shadow_source(7, 12) + declarations + screen_source + light_source +
         (shading == Shading::eye ? eye_source : "") +
         (shading == Shading::mucosa || shading == Shading::tooth ? mirror_source : "") + main_source;
}

}  // namespace fascia::view

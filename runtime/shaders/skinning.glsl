// Skins a vertex of a Fascia face; include it in a vertex shader of GLSL 3.30 or ES 3.00. See fascia/gpu.h: the
// attributes and textures are those of fascia_face_skinning, _write_node_texture and _bone_matrices.
//
// fascia_nodes is a texture of 32-bit floats (RGBA32F), node i at (i % width, i / width), not filtered.
// fascia_bones are the jaw, the left eye and the right eye.
uniform highp sampler2D fascia_nodes;
uniform mat4 fascia_bones[3];

vec3 fascia_node(uint node) {
  uint width = uint(textureSize(fascia_nodes, 0).x);
  return texelFetch(fascia_nodes, ivec2(int(node % width), int(node / width)), 0).xyz;
}

// The sum over four of the vertex's nodes; call it for each four of `influences`.
vec3 fascia_pull(uvec4 nodes, vec4 weights) {
  return weights.x * fascia_node(nodes.x) + weights.y * fascia_node(nodes.y) + weights.z * fascia_node(nodes.z) +
         weights.w * fascia_node(nodes.w);
}

// The vertex's place: `pull` is the sum of fascia_pull; `eye` 0 none, 1 left, 2 right.
vec3 fascia_place(vec3 rest, vec3 pull, float jaw, uint eye) {
  if (eye != 0u) return (fascia_bones[eye] * vec4(rest, 1.0)).xyz;
  return rest + pull + jaw * ((fascia_bones[0] * vec4(rest, 1.0)).xyz - rest);
}

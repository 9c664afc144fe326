// Skins a vertex of a Fascia face (WebGPU). See fascia/gpu.h: the attributes and data are those of
// fascia_face_skinning, _write_node_texture and _bone_matrices. Declare the two bindings where your layout has them:
//
//     @group(0) @binding(0) var fascia_nodes: texture_2d<f32>;              // rgba32float, not filtered
//     @group(0) @binding(1) var<uniform> fascia_bones: array<mat4x4<f32>, 3>;  // jaw, left eye, right eye

fn fascia_node(node: u32) -> vec3<f32> {
  let width = textureDimensions(fascia_nodes).x;
  return textureLoad(fascia_nodes, vec2<u32>(node % width, node / width), 0).xyz;
}

// The sum over four of the vertex's nodes; call it for each four of `influences`.
fn fascia_pull(nodes: vec4<u32>, weights: vec4<f32>) -> vec3<f32> {
  return weights.x * fascia_node(nodes.x) + weights.y * fascia_node(nodes.y) +
         weights.z * fascia_node(nodes.z) + weights.w * fascia_node(nodes.w);
}

// The vertex's place: `pull` is the sum of fascia_pull; `eye` 0 none, 1 left, 2 right.
fn fascia_place(rest: vec3<f32>, pull: vec3<f32>, jaw: f32, eye: u32) -> vec3<f32> {
  if (eye != 0u) {
    return (fascia_bones[eye] * vec4<f32>(rest, 1.0)).xyz;
  }
  return rest + pull + jaw * ((fascia_bones[0] * vec4<f32>(rest, 1.0)).xyz - rest);
}

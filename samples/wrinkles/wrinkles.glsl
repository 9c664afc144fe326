// Wrinkles where the skin is compressed: blends a wrinkled normal map in by what fascia_face_compression says.
//
// Give each vertex its compression (3 floats, a direction times its share, in the rig's axes) as an attribute beside
// position, normal and tangent; in the vertex shader
//
//     wrinkle = fascia_wrinkle_amount(compression, rest_tangent.xyz, rest_bitangent);
//
// with the rest pose's tangent and bitangent, since the direction is one at rest, and pass the vec2 on. Wrinkles run across
// the compression: compression along the tangent brings out those of `across`, compression along the bitangent those
// of `along`.

// How strong wrinkles across the tangent (x) and across the bitangent (y) are, 0 to 1. They begin at 4 % of
// compression and are full at 20 %.
vec2 fascia_wrinkle_amount(vec3 compression, vec3 tangent, vec3 bitangent) {
  vec2 share = vec2(abs(dot(compression, tangent)), abs(dot(compression, bitangent)));
  return smoothstep(vec2(0.04), vec2(0.20), share);
}

// The normal in tangent space from the smooth map and the two wrinkled ones (Barre-Brisebois & Hill 2012, Blending in
// detail: reoriented normal mapping).
vec3 fascia_wrinkled_normal(vec3 smooth_map, vec3 across_map, vec3 along_map, vec2 wrinkle) {
  vec3 base = smooth_map * vec3(2.0, 2.0, 2.0) - vec3(1.0, 1.0, 0.0);
  vec3 across = mix(vec3(0.0, 0.0, 1.0), across_map * 2.0 - 1.0, wrinkle.x);
  vec3 along = mix(vec3(0.0, 0.0, 1.0), along_map * 2.0 - 1.0, wrinkle.y);
  vec3 detail = normalize(vec3(across.xy + along.xy, across.z * along.z));
  detail = detail * vec3(-1.0, -1.0, 1.0);
  return normalize(base * dot(base, detail) / base.z - detail);
}

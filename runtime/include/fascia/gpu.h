/** \file
 * Fascia's runtime for the GPU: compact vertex data, and skinning on the GPU. See fascia/fascia.h.
 *
 * Skinning on the GPU. The position of a vertex is
 *
 *     rest + sum of weight * displacement(node) + jaw * (jaw_matrix * rest - rest)
 *
 * or, for a vertex of an eye, eye_matrix * rest. fascia_face_skinning gives the constant data once, as vertex
 * attributes; in each frame fascia_face_write_node_texture and fascia_face_bone_matrices give about ten
 * thousand numbers instead of every vertex. The shader functions are in skinning.glsl and skinning.wgsl
 * (installed in share/fascia/shaders). They reproduce fascia_face_positions to within 1e-5 m. Normals are not
 * among them: take them in the fragment shader from the derivatives of the position, or from the CPU with
 * fascia_face_write_normals.
 */
#ifndef FASCIA_GPU_H
#define FASCIA_GPU_H

#include "fascia/fascia.h"

#ifdef __cplusplus
extern "C" {
#endif

/** How fascia_face_write_deltas writes a displacement. */
typedef enum fascia_delta_format {
  FASCIA_DELTA_FLOAT32 = 0,    /**< 3 floats: 12 bytes */
  FASCIA_DELTA_SNORM16 = 1,    /**< 4 16-bit integers, the last one 0: 8 bytes; times scale / 32767 */
  FASCIA_DELTA_32 = 0x7fffffff /**< not a format: makes the type 32 bits wide */
} fascia_delta_format;

/** Writes each vertex's displacement from rest, in the face's space, to the host's memory, `stride` bytes
 * from one to the next (12 or more, 8 for 16-bit numbers). `scale` receives the largest absolute coordinate,
 * the unit of 16-bit numbers (0 at rest). FASCIA_ERROR_ARGUMENT if `capacity`, in vertices, is too small. */
FASCIA_API fascia_result fascia_face_write_deltas(fascia_face* face, uint32_t mesh,
                                                  fascia_delta_format format, void* to, size_t stride,
                                                  size_t capacity, float* scale);

/** Skinning data of a mesh at the face's current level of detail, in the asset's memory. */
typedef struct fascia_skinning {
  uint32_t struct_size;  /**< sizeof the structure */
  uint32_t vertex_count; /**< vertices of the mesh */
  uint32_t influences;   /**< nodes per vertex: a multiple of 4 */
  uint32_t node_count;   /**< of the level: texels of the node texture */
  const float* rest;     /**< vertex_count * 3, in the face's space */
  const uint32_t* nodes; /**< vertex_count * influences: texels of the node texture */
  const float* weights;  /**< vertex_count * influences: of those nodes; 0 if a vertex has fewer */
  const float* jaw;      /**< vertex_count: share of the jaw's motion */
  const uint32_t* eyes;  /**< vertex_count: 0 none, 1 the left eye, 2 the right */
} fascia_skinning;
/** Gives the skinning data of a mesh; call it again after a change of level. It does not include the
 * blending of vertices after that change. Allocates when first called for a mesh, level and space. */
FASCIA_API fascia_result fascia_face_skinning(fascia_face* face, uint32_t mesh, fascia_skinning* skinning);

/** Writes node_count texels of 4 floats (RGBA32F): each node's displacement from rest in the face's space,
 * and 0. FASCIA_ERROR_ARGUMENT if `capacity`, in texels, is too small. */
FASCIA_API fascia_result fascia_face_write_node_texture(fascia_face* face, uint32_t mesh, float* to,
                                                        size_t capacity);

/** Writes 3 matrices, 4 x 4, column-major, that act on positions in the face's space: the jaw, the left eye,
 * the right eye. */
FASCIA_API fascia_result fascia_face_bone_matrices(fascia_face* face, uint32_t mesh, float matrices[48]);

#ifdef __cplusplus
}
#endif

#endif

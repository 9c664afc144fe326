/* Fascia's runtime: loads a face rig and simulates it. Plain C (C99); the only header a host has to include.
 *
 * A rig file is a glTF binary (.glb) with the FASCIA extensions. Load it once as an asset, create a face for
 * each head in the scene, write channel values, step, and read vertex positions:
 *
 *     fascia_asset* asset = NULL;
 *     fascia_face* face = NULL;
 *     if (fascia_asset_load(bytes, size, &asset) != FASCIA_OK) puts(fascia_last_message());
 *     fascia_face_create(asset, NULL, &face);
 *     fascia_face_set(face, "arkit:mouthSmileLeft", 0.8f);
 *     fascia_face_step(face, 1.0f / 60.0f);
 *     fascia_vectors positions = {.struct_size = sizeof positions};
 *     fascia_face_positions(face, 0, &positions);
 *
 * Threads. Assets and curves do not change after loading and may be used by any number of threads. A face may
 * be used by one thread at a time; different faces may be used in parallel. Pointers into a face stay valid
 * until it is released; their contents change with each pose or step.
 *
 * Errors. Functions that can fail return a fascia_result; fascia_last_message returns the message of the last
 * failure on this thread. Output parameters are written on success only. Nothing throws or terminates the
 * program.
 *
 * Structures. Each begins with struct_size, which the caller sets to sizeof the structure; later versions
 * only append members. Strings are UTF-8, null-terminated, and owned by the asset or curves they came from.
 *
 * Parts. fascia/base.h (results, version, allocator) and fascia/curves.h (recorded curves) are included here.
 * Optional: fascia/gpu.h (vertex data and skinning on the GPU), fascia/fit.h (activations from a stream of
 * landmarks), fascia/research.h (nodes, forces, energies, derivatives), fascia/api.h (all functions in one
 * table, for hosts that load the library dynamically) and fascia/fascia.hpp (C++20).
 *
 * Units and axes. Metres and radians unless a space says otherwise. Left and right are the subject's.
 */
#ifndef FASCIA_FASCIA_H
#define FASCIA_FASCIA_H

#include "fascia/base.h"
#include "fascia/curves.h"

#ifdef __cplusplus
extern "C" {
#endif

/* --- Assets --- */

/* Loads a rig from the `size` bytes of a .glb file, which may be freed afterwards. Every index, length and
 * fingerprint in the file is checked. */
FASCIA_API fascia_result fascia_asset_load(const void* bytes, size_t size, fascia_asset** asset);

/* Releases the asset; faces created from it remain valid. NULL is allowed. */
FASCIA_API void fascia_asset_release(fascia_asset* asset);

typedef struct fascia_asset_info {
  uint32_t struct_size;
  uint32_t level_count; /* levels of detail, coarse to fine */
  uint32_t mesh_count;  /* primitives of the file that the rig deforms */
  uint32_t channel_count;
  uint32_t set_count; /* vocabularies: arkit, au, ... */
  uint32_t muscle_count;
  float input_to_metres[16]; /* column-major: from the file's axes and units to metres, +Y up, facing +Z */
} fascia_asset_info;
FASCIA_API fascia_result fascia_asset_get_info(const fascia_asset* asset, fascia_asset_info* info);

typedef struct fascia_level_info {
  uint32_t struct_size;
  uint32_t node_count, spring_count, fibre_count;
  const char* name; /* low, medium or high */
} fascia_level_info;
FASCIA_API fascia_result fascia_asset_get_level(const fascia_asset* asset, uint32_t level,
                                                fascia_level_info* info);

typedef struct fascia_mesh_info {
  uint32_t struct_size;
  uint32_t mesh, primitive; /* indices in the glTF file */
  uint32_t vertex_count, triangle_count;
  uint32_t reserved;
  const char* name;          /* of the mesh in the file */
  const char* part;          /* skin, eye_left, teeth_lower, ... */
  const uint32_t* triangles; /* triangle_count * 3 vertex indices */
} fascia_mesh_info;
FASCIA_API fascia_result fascia_asset_get_mesh(const fascia_asset* asset, uint32_t mesh,
                                               fascia_mesh_info* info);

/* The channels, as arrays of channel_count elements. */
typedef struct fascia_channels {
  uint32_t struct_size;
  uint32_t count;
  const char* const* names;  /* zygomaticus_major_left, jaw_open, ... */
  const char* const* groups; /* muscle, jaw, eye, lid, lip, pressure */
  const char* const* units;  /* "1" or "rad" */
  const float* minimum;
  const float* maximum;
  const float* rest;
} fascia_channels;
FASCIA_API fascia_result fascia_asset_get_channels(const fascia_asset* asset, fascia_channels* channels);

typedef struct fascia_set_info {
  uint32_t struct_size;
  uint32_t member_count;
  const char* name;           /* arkit, au, viseme, ... */
  const char* const* members; /* jawOpen, ... */
} fascia_set_info;
FASCIA_API fascia_result fascia_asset_get_set(const fascia_asset* asset, uint32_t set, fascia_set_info* info);

/* Index of a channel by name, case-insensitive; -1 if there is none. */
FASCIA_API int32_t fascia_asset_find_channel(const fascia_asset* asset, const char* name);

/* Indices of a set's member by name as in fascia_face_set ("arkit:jawOpen", "jawOpen"); FASCIA_ERROR_NAME
 * if the name is a channel's or unknown. */
FASCIA_API fascia_result fascia_asset_find_member(const fascia_asset* asset, const char* name, uint32_t* set,
                                                  uint32_t* member);

/* A surface of the anatomy at rest, in metres: "cranium", "mandible", "teeth_upper", "teeth_lower" or "smas".
 * Without vertices if the rig lacks it; FASCIA_ERROR_NAME for any other name. For display. */
typedef struct fascia_surface {
  uint32_t struct_size;
  uint32_t vertex_count, triangle_count;
  uint32_t reserved;
  const float* positions;    /* vertex_count * 3 */
  const uint32_t* triangles; /* triangle_count * 3 */
} fascia_surface;
FASCIA_API fascia_result fascia_asset_surface(const fascia_asset* asset, const char* name,
                                              fascia_surface* surface);

/* The muscle fibres of a level of detail as polylines at rest, in metres: fibre f has the points offsets[f]
 * .. offsets[f+1]. For display. */
typedef struct fascia_fibres {
  uint32_t struct_size;
  uint32_t fibre_count, point_count;
  uint32_t reserved;
  const uint32_t* offsets;    /* fibre_count + 1 */
  const uint32_t* channels;   /* fibre_count: the channel that contracts each */
  const char* const* muscles; /* fibre_count: the name of each fibre's muscle */
  const float* points;        /* point_count * 3 */
} fascia_fibres;
FASCIA_API fascia_result fascia_asset_fibres(const fascia_asset* asset, uint32_t level,
                                             fascia_fibres* fibres);

/* --- Faces --- */

typedef enum fascia_space {
  FASCIA_SPACE_MESH = 0,   /* that of the file's POSITION attribute, which an engine replaces */
  FASCIA_SPACE_INPUT = 1,  /* the file's axes and units, node transforms applied */
  FASCIA_SPACE_METRES = 2, /* the rig's: metres, +Y up, facing +Z; as the surfaces of the anatomy */
  FASCIA_SPACE_32 = 0x7fffffff
} fascia_space;

typedef enum fascia_solver {
  FASCIA_SOLVER_OWN = 0,
  FASCIA_SOLVER_BULLET =
      1, /* requires the module libfascia_bullet beside this library or on the loader's path */
  FASCIA_SOLVER_REFERENCE =
      2, /* the same energies in double precision, every step converged: slow, for comparison */
  FASCIA_SOLVER_32 = 0x7fffffff
} fascia_solver;

typedef struct fascia_face_options {
  uint32_t struct_size;
  fascia_space space; /* of positions and normals */
  fascia_solver solver;
  int32_t level;      /* level of detail; -1 the finest */
  int32_t iterations; /* of FASCIA_SOLVER_OWN in each substep of 1/120 s: 0 for the default (2); 1 for crowds,
                         up to 32 for higher accuracy */
} fascia_face_options;

/* The options of a face that is created with NULL: mesh space, own solver, finest level. */
FASCIA_API fascia_face_options fascia_default_face_options(void);

/* Creates a face at rest. The first face of a level prepares that level for all faces (up to 100 ms). */
FASCIA_API fascia_result fascia_face_create(fascia_asset* asset, const fascia_face_options* options,
                                            fascia_face** face);
FASCIA_API void fascia_face_release(fascia_face* face);

/* The face's own channel values, channel_count floats that may be read and written; clamped to their range
 * when used. */
FASCIA_API float* fascia_face_values(fascia_face* face);

/* Sets a value by name, case-insensitive: a channel, "set:member" such as "arkit:jawOpen" or "au:12", or a
 * member's name alone if no channel and no earlier set has it; other spellings (mouthSmile_L) and other
 * programs' names (viseme_PP, Joy) are accepted too. A member's value remains until it is set again and adds
 * to the channels it maps to, through the member's response curve, which makes the displacement of the face
 * proportional to the value; rotations of the eyes are proportional to it directly. */
FASCIA_API fascia_result fascia_face_set(fascia_face* face, const char* name, float value);

/* The value last set by that name. */
FASCIA_API fascia_result fascia_face_get(const fascia_face* face, const char* name, float* value);

/* The same for a member of a set by index (see fascia_asset_get_set), without a look-up by name. */
FASCIA_API fascia_result fascia_face_set_member(fascia_face* face, uint32_t set, uint32_t member,
                                                float value);

/* Sets every channel to its rest value and every member to 0. */
FASCIA_API fascia_result fascia_face_clear(fascia_face* face);

/* How a layer is combined with those below it, channel by channel; an offset is a value minus the channel's
 * rest value. */
typedef enum fascia_combine {
  FASCIA_COMBINE_ADD = 0,      /* the sum of the offsets, clamped to the channel's range */
  FASCIA_COMBINE_MAX = 1,      /* the larger offset: two sources of one motion do not drive it twice */
  FASCIA_COMBINE_SATURATE = 2, /* 1 - (1 - a)(1 - b) of the range: saturates at its end */
  FASCIA_COMBINE_OVERRIDE = 3, /* replaced by the layer, to the extent of its weight and mask */
  FASCIA_COMBINE_32 = 0x7fffffff
} fascia_combine;

typedef struct fascia_layer {
  uint32_t struct_size;
  fascia_combine combine;
  float weight; /* 0 (no effect) to 1 */
  uint32_t reserved;
  const float* mask; /* channel_count weights from 0 to 1, copied; NULL: 1 for all channels */
} fascia_layer;

/* Adds layer `index` (1 to 7), or changes how it is combined. Layer 0 has the face's own values and members
 * and the curves of fascia_curves_apply; higher layers are combined with it in the order of their indices.
 * Allocates for a new layer. */
FASCIA_API fascia_result fascia_face_set_layer(fascia_face* face, uint32_t index, const fascia_layer* layer);

/* A layer's own values, as fascia_face_values for layer 0; NULL if there is no such layer. */
FASCIA_API float* fascia_face_layer_values(fascia_face* face, uint32_t layer);

/* As fascia_face_set and fascia_face_clear, for a layer. */
FASCIA_API fascia_result fascia_face_layer_set(fascia_face* face, uint32_t layer, const char* name,
                                               float value);
FASCIA_API fascia_result fascia_face_layer_clear(fascia_face* face, uint32_t layer);

/* Rotates both eyes toward a point in metres in the head's frame (the rig's axes), each about its own centre
 * and within its range, blended by `weight` (0 to 1); from the next pose or step on, until set again. NULL
 * for none. */
FASCIA_API fascia_result fascia_face_look_at(fascia_face* face, const float* point, float weight);

/* Over `seconds` of steps, changes the factor applied to all inputs of the face to `share`: 0 returns it to
 * rest, as when a capture loses the actor, 1 (the initial value) restores the inputs. */
FASCIA_API fascia_result fascia_face_blend(fascia_face* face, float share, float seconds);

/* The channel values used by the last pose or step: own values, members and curves, summed and clamped.
 * channel_count floats. */
FASCIA_API const float* fascia_face_effective_values(const fascia_face* face);

/* Solves for the static equilibrium at the current values; later steps start from it with zero velocity.
 * Curves applied since the last pose or step are consumed. */
FASCIA_API fascia_result fascia_face_pose(fascia_face* face);

/* Advances the simulation by `seconds` (0 to 1). The motion hardly depends on the frame rate; very long
 * frames are truncated. The jaw takes at least 0.12 s from closed to wide open, whatever its channels do.
 * FASCIA_ERROR_DIVERGED means that the simulation became unstable and the face was reset to rest; it may be
 * stepped again. Curves applied since the last pose or step are consumed. */
FASCIA_API fascia_result fascia_face_step(fascia_face* face, float seconds);

/* The host's task system, for functions that can run in parallel. `begin` starts or queues a task that calls
 * `run(first, end, context)` for disjoint ranges that together cover 0 .. count, each at least `least` long
 * except the last, on any threads at any time; it returns a handle for `finish`, or NULL if everything has
 * already run. `finish` returns when every range has run. Results do not depend on the partition. `user` is
 * passed to both. */
typedef void (*fascia_task_range)(uint32_t first, uint32_t end, void* context);
typedef struct fascia_tasks {
  uint32_t struct_size;
  uint32_t reserved;
  void* (*begin)(fascia_task_range run, uint32_t count, uint32_t least, void* context, void* user);
  void (*finish)(void* task, void* user);
  void* user;
} fascia_tasks;

/* Advances many faces by `seconds` (0 to 1), each as fascia_face_step with a bit-identical result, through
 * the host's tasks, or sequentially on this thread if `tasks` is NULL. The faces may be of different assets;
 * none may be listed twice or used elsewhere until this returns. FASCIA_ERROR_DIVERGED if any face was
 * reset. */
FASCIA_API fascia_result fascia_faces_step(fascia_face* const* faces, uint32_t count, float seconds,
                                           const fascia_tasks* tasks);

/* Removes all motion and resets the tissue to rest on the current position of the jaw: after a cut or a
 * teleport. */
FASCIA_API fascia_result fascia_face_reset(fascia_face* face);

/* Switches to another level of detail (-1 the finest), at the static pose of the current values with zero
 * velocity. Vertices are blended over `seconds` of steps from their displayed positions to those of the new
 * level. Vertex arrays keep their addresses; lists of nodes and fibre points change, and touches are cleared.
 * Allocates, and the first use of a level prepares it. */
FASCIA_API fascia_result fascia_face_set_level(fascia_face* face, int32_t level, float seconds);

/* The current level of detail; -1 if the face is NULL. */
FASCIA_API int32_t fascia_face_level(const fascia_face* face);

/* Saves the complete state on which the face's next steps depend, for rewinding and network play: values,
 * layers, motion, time within the step. A restored state continues bit-identically, in this or another face
 * of the same rig, solver, level and layers, on the same build and kind of machine. The blending of vertices
 * after a change of level is not included. `size` receives the number of bytes; with `to` NULL that is all.
 * FASCIA_ERROR_ARGUMENT if `capacity` is too small, FASCIA_ERROR_MODULE if the solver (Bullet) does not
 * support it. Does not allocate. */
FASCIA_API fascia_result fascia_face_save(fascia_face* face, void* to, size_t capacity, size_t* size);

/* Restores a saved state. FASCIA_ERROR_FORMAT if the bytes are damaged, FASCIA_ERROR_MISMATCH if they are of
 * another kind of face; the face is then unchanged. */
FASCIA_API fascia_result fascia_face_restore(fascia_face* face, const void* bytes, size_t size);

/* Inertial acceleration of the tissue in the head's frame, m/s^2 in the rig's axes: the negative of the
 * head's acceleration, for example. NULL for none. Kept until it is set again. */
FASCIA_API fascia_result fascia_face_set_acceleration(fascia_face* face, const float* acceleration);

/* Sets the pose of the head in the world: a rigid transform in metres, 4 x 4, column-major, from the head's
 * frame. In the next step soft tissue lags behind the head's acceleration, scaled by `inertia_scale` (1 is
 * physical, 0 none). A jump of more than half a metre in one step counts as a teleport and causes no motion.
 * Call it before each step while the head moves. */
FASCIA_API fascia_result fascia_face_move_head(fascia_face* face, const float matrix[16],
                                               float inertia_scale);

/* Applies a force in newtons, in the rig's axes, to a vertex of a mesh until all touches are cleared. At most
 * 64. A force of more than 1000 N counts as 1000 N in its direction. */
FASCIA_API fascia_result fascia_face_touch(fascia_face* face, uint32_t mesh, uint32_t vertex,
                                           const float force[3]);
FASCIA_API fascia_result fascia_face_clear_touches(fascia_face* face);

/* A list of three-component vectors in the face's memory. */
typedef struct fascia_vectors {
  uint32_t struct_size;
  uint32_t count;
  uint32_t stride; /* bytes from one vector to the next: 12; 16 for tangents */
  uint32_t reserved;
  const float* data;
} fascia_vectors;

/* Vertex positions of a mesh (see fascia_asset_get_mesh) in the face's space, in the file's vertex order. */
FASCIA_API fascia_result fascia_face_positions(fascia_face* face, uint32_t mesh, fascia_vectors* positions);

/* Unit vertex normals of a mesh in the face's space: the file's own, rotated with the surface; smooth ones if
 * the file has none. Computed on request. */
FASCIA_API fascia_result fascia_face_normals(fascia_face* face, uint32_t mesh, fascia_vectors* normals);

/* Tangents for normal maps: 4 floats per vertex, the unit tangent in the face's space and the handedness (1
 * or -1), the file's own or those of its first texture coordinates, moved with the surface. None (count 0) if
 * the file has neither. Computed on request. */
FASCIA_API fascia_result fascia_face_tangents(fascia_face* face, uint32_t mesh, fascia_vectors* tangents);

/* Compression of the skin at each vertex of a mesh, for wrinkle shaders: the direction of the largest
 * compressive strain at rest, in the rig's axes, times the strain (0.2: one fifth shorter). Zero without
 * compression and on other parts. The sign is arbitrary; wrinkles are perpendicular to it. Computed on
 * request. */
FASCIA_API fascia_result fascia_face_compression(fascia_face* face, uint32_t mesh,
                                                 fascia_vectors* compression);

/* Copies positions to the host's memory: 3 floats every `stride` bytes (12 or more). FASCIA_ERROR_ARGUMENT if
 * `capacity`, in vertices, is too small. */
FASCIA_API fascia_result fascia_face_write_positions(fascia_face* face, uint32_t mesh, void* to,
                                                     size_t stride, size_t capacity);

/* The same for normals, and for tangents (4 floats each, stride 16 or more). */
FASCIA_API fascia_result fascia_face_write_normals(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                                   size_t capacity);
FASCIA_API fascia_result fascia_face_write_tangents(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                                    size_t capacity);

/* Current positions of the points of the level's fibres (see fascia_asset_fibres), in metres. */
FASCIA_API fascia_result fascia_face_fibre_points(fascia_face* face, fascia_vectors* points);

/* Pose of the mandible: a rigid transform in metres, 4 x 4, column-major. */
FASCIA_API fascia_result fascia_face_jaw(const fascia_face* face, float matrix[16]);

#ifdef __cplusplus
}
#endif

#endif

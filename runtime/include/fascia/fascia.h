/** \file
 * Fascia's runtime: loads a face rig and simulates it. Plain C (C99); the only header a host has to include.
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
 * be used by one thread at a time; different faces may be used in parallel.
 *
 * Errors. Functions that can fail return a fascia_result; fascia_last_message returns the message of the last
 * failure on this thread. Any of them may return FASCIA_ERROR_ARGUMENT (a null pointer where none is allowed,
 * an index, size or number out of range) and, if it allocates, FASCIA_ERROR_MEMORY, after which a face is
 * unchanged or fully changed; other results are stated with the function. Output parameters are written on
 * success only (structures and arrays may also have been with FASCIA_ERROR_MEMORY). Nothing throws or
 * terminates the program.
 *
 * Memory. Pointers into an asset (its names and arrays) stay valid until the asset and all its faces are
 * released, those into a face until it is released, if the function does not say otherwise; the contents of
 * the latter change with each pose or step (lists computed on request: with each request). After its first
 * call with a face (and mesh) no function of this header allocates with FASCIA_SOLVER_OWN, if it does not say
 * so.
 *
 * Structures. Each begins with struct_size, which the caller sets to sizeof the structure, also before it is
 * filled; later versions only append members. Strings are UTF-8 and null-terminated.
 *
 * Parts. fascia/base.h (results, version, allocator, tasks) and fascia/curves.h (recorded curves) are
 * included here. Optional: fascia/gpu.h (vertex data and skinning on the GPU), fascia/fit.h (activations from
 * a stream of landmarks), fascia/research.h (nodes, forces, energies, derivatives), fascia/api.h (all
 * functions in one table, for hosts that load the library dynamically) and fascia/fascia.hpp (C++20).
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

/** Loads a rig from the `size` bytes of a .glb file, which may be freed afterwards. Every index, length and
 * fingerprint in the file is checked: FASCIA_ERROR_FORMAT if it is damaged or no rig, FASCIA_ERROR_VERSION if
 * it is of a later version, FASCIA_ERROR_MISMATCH if a mesh was changed after the rig was built. */
FASCIA_API fascia_result fascia_asset_load(const void* bytes, size_t size, fascia_asset** asset);

/** Releases the asset; faces created from it remain valid. NULL is allowed. */
FASCIA_API void fascia_asset_release(fascia_asset* asset);

/** The size of a rig and its axes. */
typedef struct fascia_asset_info {
  uint32_t struct_size;      /**< sizeof the structure */
  uint32_t level_count;      /**< levels of detail, coarse to fine */
  uint32_t mesh_count;       /**< primitives of the file that the rig deforms */
  uint32_t channel_count;    /**< muscles, jaw, eyes and all other inputs of a face: see fascia_channels */
  uint32_t set_count;        /**< vocabularies: arkit, au, ... */
  uint32_t muscle_count;     /**< muscles of the rig, by side and part */
  float input_to_metres[16]; /**< column-major: from the file's axes and units to metres, +Y up, facing +Z */
} fascia_asset_info;
/** Fills in the size of the rig and its axes. */
FASCIA_API fascia_result fascia_asset_get_info(const fascia_asset* asset, fascia_asset_info* info);

/** A level of detail: a lattice of tissue and the fibres in it. */
typedef struct fascia_level_info {
  uint32_t struct_size; /**< sizeof the structure */
  uint32_t node_count,  /**< nodes of the lattice: see fascia_lattice */
      spring_count,     /**< springs between them */
      fibre_count;      /**< muscle fibres: see fascia_asset_fibres */
  const char* name;     /**< low, medium or high */
} fascia_level_info;
/** Describes the level of detail with that index, from 0 (the coarsest) to level_count - 1. */
FASCIA_API fascia_result fascia_asset_get_level(const fascia_asset* asset, uint32_t level,
                                                fascia_level_info* info);

/** A mesh that the rig deforms: one primitive of the glTF file. */
typedef struct fascia_mesh_info {
  uint32_t struct_size;      /**< sizeof the structure */
  uint32_t mesh,             /**< index of the mesh in the glTF file */
      primitive;             /**< index of the primitive in that mesh */
  uint32_t vertex_count,     /**< vertices, in the file's order */
      triangle_count;        /**< triangles */
  uint32_t reserved;         /**< 0 */
  const char* name;          /**< of the mesh in the file */
  const char* part;          /**< skin, eye_left, teeth_lower, ... */
  const uint32_t* triangles; /**< triangle_count * 3 vertex indices */
} fascia_mesh_info;
/** Describes the mesh with that index, from 0 to mesh_count - 1. */
FASCIA_API fascia_result fascia_asset_get_mesh(const fascia_asset* asset, uint32_t mesh,
                                               fascia_mesh_info* info);

/** The channels, the inputs of a face, as arrays of `count` elements. */
typedef struct fascia_channels {
  uint32_t struct_size;      /**< sizeof the structure */
  uint32_t count;            /**< number of channels: channel_count of fascia_asset_info */
  const char* const* names;  /**< zygomaticus_major_left, jaw_open, ... */
  const char* const* groups; /**< muscle, jaw, eye, lid, lip, pressure */
  const char* const* units;  /**< "1" or "rad" */
  const float* minimum;      /**< smallest value that is used */
  const float* maximum;      /**< largest value that is used */
  const float* rest;         /**< value at rest */
} fascia_channels;
/** Lists the channels. */
FASCIA_API fascia_result fascia_asset_get_channels(const fascia_asset* asset, fascia_channels* channels);

/** A set of names for expressions, each of which drives several channels: a vocabulary. */
typedef struct fascia_set_info {
  uint32_t struct_size;       /**< sizeof the structure */
  uint32_t member_count;      /**< number of names */
  const char* name;           /**< arkit, au, viseme, ... */
  const char* const* members; /**< member_count names: jawOpen, ... */
} fascia_set_info;
/** Describes the set with that index, from 0 to set_count - 1. */
FASCIA_API fascia_result fascia_asset_get_set(const fascia_asset* asset, uint32_t set, fascia_set_info* info);

/** Index of a channel by name, case-insensitive, or "#7" for channel 7; -1 if there is none or an argument is
 * NULL. */
FASCIA_API int32_t fascia_asset_find_channel(const fascia_asset* asset, const char* name);

/** Indices of a set's member by its name, with the set's ("arkit:jawOpen") or without ("jawOpen"), as
 * fascia_face_set finds it but in no other spelling than upper or lower case. FASCIA_ERROR_NAME if the name
 * is a channel's or unknown. */
FASCIA_API fascia_result fascia_asset_find_member(const fascia_asset* asset, const char* name, uint32_t* set,
                                                  uint32_t* member);

/** Texture coordinates of a mesh: 2 floats per vertex, the file's first set (TEXCOORD_0) without the
 * transforms of materials; (0, 0) is the top left corner of an image. In the asset's memory. None (count 0)
 * if the file has none. */
FASCIA_API fascia_result fascia_asset_texcoords(const fascia_asset* asset, uint32_t mesh,
                                                fascia_vectors* texcoords);

/** A surface of the anatomy at rest, in metres. */
typedef struct fascia_surface {
  uint32_t struct_size;      /**< sizeof the structure */
  uint32_t vertex_count,     /**< vertices; 0 if the rig lacks the surface */
      triangle_count;        /**< triangles */
  uint32_t reserved;         /**< 0 */
  const float* positions;    /**< vertex_count * 3 */
  const uint32_t* triangles; /**< triangle_count * 3 vertex indices */
} fascia_surface;
/** Gives a surface for display: "cranium", "mandible", "teeth_upper", "teeth_lower" or "smas".
 * FASCIA_ERROR_NAME for any other name. */
FASCIA_API fascia_result fascia_asset_surface(const fascia_asset* asset, const char* name,
                                              fascia_surface* surface);

/** The muscle fibres of a level of detail as polylines at rest, in metres: fibre f has the points from
 * offsets[f] to offsets[f+1] - 1. */
typedef struct fascia_fibres {
  uint32_t struct_size;       /**< sizeof the structure */
  uint32_t fibre_count,       /**< number of fibres */
      point_count;            /**< points of all fibres */
  uint32_t reserved;          /**< 0 */
  const uint32_t* offsets;    /**< fibre_count + 1 */
  const uint32_t* channels;   /**< fibre_count: the channel that contracts each */
  const char* const* muscles; /**< fibre_count: the name of each fibre's muscle */
  const float* points;        /**< point_count * 3 */
} fascia_fibres;
/** Gives the fibres of a level for display; fascia_face_fibre_points has where a face moves them. */
FASCIA_API fascia_result fascia_asset_fibres(const fascia_asset* asset, uint32_t level,
                                             fascia_fibres* fibres);

/* --- Faces --- */

/** The coordinates in which a face gives positions, normals and tangents. */
typedef enum fascia_space {
  FASCIA_SPACE_MESH = 0,       /**< that of the file's POSITION attribute, which an engine replaces */
  FASCIA_SPACE_INPUT = 1,      /**< the file's axes and units, node transforms applied */
  FASCIA_SPACE_METRES = 2,     /**< the rig's: metres, +Y up, facing +Z; as the surfaces of the anatomy */
  FASCIA_SPACE_32 = 0x7fffffff /**< not a space: makes the type 32 bits wide */
} fascia_space;

/** What computes the motion of the tissue. */
typedef enum fascia_solver {
  FASCIA_SOLVER_OWN = 0,        /**< the real-time solver */
  FASCIA_SOLVER_BULLET = 1,     /**< needs the module libfascia_bullet beside this library or on its path */
  FASCIA_SOLVER_REFERENCE = 2,  /**< the same energies in double precision, fully converged: slow */
  FASCIA_SOLVER_32 = 0x7fffffff /**< not a solver: makes the type 32 bits wide */
} fascia_solver;

/** How a face is created. */
typedef struct fascia_face_options {
  uint32_t struct_size; /**< sizeof the structure */
  fascia_space space;   /**< of positions, normals and tangents */
  fascia_solver solver; /**< what computes the motion */
  int32_t level;        /**< level of detail; -1 the finest */
  int32_t iterations;   /**< of FASCIA_SOLVER_OWN in each substep of 1/120 s: 0 for the default (2); 1 for
                           crowds,   up to 32 for higher accuracy */
} fascia_face_options;

/** The options of a face that is created with NULL: mesh space, own solver, finest level. */
FASCIA_API fascia_face_options fascia_default_face_options(void);

/** Creates a face at rest. The first face of a level prepares that level for all faces (up to 100 ms).
 * FASCIA_ERROR_MODULE for FASCIA_SOLVER_BULLET if its module is missing or a host's allocator is set,
 * FASCIA_ERROR_FORMAT if the rig's tissue cannot be solved. `options` may be NULL. */
FASCIA_API fascia_result fascia_face_create(fascia_asset* asset, const fascia_face_options* options,
                                            fascia_face** face);
/** Releases the face and all memory it has given out. NULL is allowed. */
FASCIA_API void fascia_face_release(fascia_face* face);

/** The face's own channel values, channel_count floats that may be read and written; clamped to their range
 * when used, and at rest where they are not finite. NULL if the face is NULL. */
FASCIA_API float* fascia_face_values(fascia_face* face);

/** Sets a value by name, case-insensitive: a channel, "#7" for the channel with index 7, "set:member" such as
 * "arkit:jawOpen" or "au:12", or a member's name alone if no channel and no earlier set has it; other
 * spellings (mouthSmile_L) and other programs' names (viseme_PP, Joy) are accepted too, but looking them up
 * allocates. A member's value remains until it is set again or cleared and adds to the channels it maps to,
 * through the member's response curve, which makes the displacement of the face proportional to the value;
 * rotations of the eyes are proportional to it directly. FASCIA_ERROR_NAME if the rig has no such channel or
 * member. */
FASCIA_API fascia_result fascia_face_set(fascia_face* face, const char* name, float value);

/** The value last set by that name. FASCIA_ERROR_NAME as fascia_face_set. */
FASCIA_API fascia_result fascia_face_get(const fascia_face* face, const char* name, float* value);

/** Sets the value of a member of a set by index (see fascia_asset_get_set), without a look-up by name. */
FASCIA_API fascia_result fascia_face_set_member(fascia_face* face, uint32_t set, uint32_t member,
                                                float value);

/** Sets every channel to its rest value and every member to 0; other layers keep theirs. */
FASCIA_API fascia_result fascia_face_clear(fascia_face* face);

/** How a layer is combined with those below it, channel by channel; an offset is a value minus the channel's
 * rest value. Results are clamped to the channel's range. */
typedef enum fascia_combine {
  FASCIA_COMBINE_ADD = 0,        /**< the sum of the offsets */
  FASCIA_COMBINE_MAX = 1,        /**< the offset of larger magnitude: no motion is driven twice */
  FASCIA_COMBINE_SATURATE = 2,   /**< 1 - (1 - a)(1 - b) of the range: saturates at its end */
  FASCIA_COMBINE_OVERRIDE = 3,   /**< replaced by the layer, to the extent of its weight and mask */
  FASCIA_COMBINE_32 = 0x7fffffff /**< not a combination: makes the type 32 bits wide */
} fascia_combine;

/** How a layer of a face is combined with those below it. */
typedef struct fascia_layer {
  uint32_t struct_size;   /**< sizeof the structure */
  fascia_combine combine; /**< the rule */
  float weight;           /**< factor of the layer's offsets: 0 (no effect) to 1 */
  uint32_t reserved;      /**< not used: set it to 0 */
  const float* mask;      /**< channel_count weights from 0 to 1, copied; NULL: 1 for all channels */
} fascia_layer;

/** Adds layer `index` (1 to 7) at rest, or changes how it is combined. Layer 0 has the face's own values and
 * members and the curves of fascia_curves_apply; higher layers are combined with it in the order of their
 * indices. Allocates for a new layer. */
FASCIA_API fascia_result fascia_face_set_layer(fascia_face* face, uint32_t index, const fascia_layer* layer);

/** A layer's own values, as fascia_face_values for layer 0; NULL if there is no such layer. */
FASCIA_API float* fascia_face_layer_values(fascia_face* face, uint32_t layer);

/** Sets a value of a layer by name, as fascia_face_set; FASCIA_ERROR_ARGUMENT if there is no such layer. */
FASCIA_API fascia_result fascia_face_layer_set(fascia_face* face, uint32_t layer, const char* name,
                                               float value);
/** Sets the value of a member in a layer by index, as fascia_face_set_member; FASCIA_ERROR_ARGUMENT if there
 * is no such layer. */
FASCIA_API fascia_result fascia_face_layer_set_member(fascia_face* face, uint32_t layer, uint32_t set,
                                                      uint32_t member, float value);
/** Clears a layer, as fascia_face_clear; FASCIA_ERROR_ARGUMENT if there is no such layer. */
FASCIA_API fascia_result fascia_face_layer_clear(fascia_face* face, uint32_t layer);
/** Removes a layer (1 to 7) from the next pose or step on. Its values keep their place and have no effect;
 * fascia_face_set_layer makes the layer again, at rest. FASCIA_ERROR_ARGUMENT if there is no such layer. */
FASCIA_API fascia_result fascia_face_layer_remove(fascia_face* face, uint32_t layer);

/** Rotates both eyes toward a point in metres in the head's frame (the rig's axes), each about its own centre
 * and within its range, blended by `weight` (0 to 1) with the layers' result; from the next pose or step on,
 * until set again. `point` has 3 floats; NULL for none. */
FASCIA_API fascia_result fascia_face_look_at(fascia_face* face, const float* point, float weight);

/** Over `seconds` of steps, changes the factor applied to all inputs of the face to `share` (0 to 1): 0
 * returns it to rest, as when a capture loses the actor, 1 (the initial value) restores the inputs. */
FASCIA_API fascia_result fascia_face_blend(fascia_face* face, float share, float seconds);

/** The channel values used by the last pose, step or reset, channel_count floats: all layers combined, with
 * the gaze of fascia_face_look_at and the factor of fascia_face_blend, clamped. At
 * rest before the first. NULL if the face is NULL. */
FASCIA_API const float* fascia_face_effective_values(const fascia_face* face);

/** Solves for the static equilibrium at the current values; later steps start from it with zero velocity.
 * Curves applied since the last pose or step are consumed. May allocate if the pose is hard to reach. */
FASCIA_API fascia_result fascia_face_pose(fascia_face* face);

/** Advances the simulation by `seconds` (0 to 1). The motion hardly depends on the frame rate; frames longer
 * than 16/120 s are truncated (Bullet: 0.2 s). The jaw takes the rig's shortest time from closed to wide open
 * (0.12 s by default), whatever its channels do. FASCIA_ERROR_DIVERGED means that the simulation became
 * unstable and the tissue was reset to rest on the current position of the jaw; it may be stepped again.
 * Curves applied since the last pose or step are consumed. */
FASCIA_API fascia_result fascia_face_step(fascia_face* face, float seconds);

/** Advances many faces by `seconds` (0 to 1), each as fascia_face_step with a bit-identical result, through
 * the host's tasks, or sequentially on this thread if `tasks` is NULL. The faces may be of different assets;
 * none may be listed twice or used elsewhere until this returns. FASCIA_ERROR_DIVERGED if any face was
 * reset. */
FASCIA_API fascia_result fascia_faces_step(fascia_face* const* faces, uint32_t count, float seconds,
                                           const fascia_tasks* tasks);

/** Removes all motion, moves the jaw to the current values and resets the tissue to rest on it, without
 * muscle activation: after a cut or a teleport. Curves applied since the last pose or step are consumed. */
FASCIA_API fascia_result fascia_face_reset(fascia_face* face);

/** Switches to another level of detail (-1 the finest), at the static pose of the effective values with zero
 * velocity. Vertices are blended over `seconds` of steps from their displayed positions to those of the new
 * level. Vertex arrays keep their addresses; lists of nodes and fibre points change, and touches are cleared.
 * Allocates, and the first use of a level prepares it; results as fascia_face_create. Nothing changes if the
 * face has that level. */
FASCIA_API fascia_result fascia_face_set_level(fascia_face* face, int32_t level, float seconds);

/** The current level of detail; -1 if the face is NULL. */
FASCIA_API int32_t fascia_face_level(const fascia_face* face);

/** Saves the complete state on which the face's next steps depend, for rewinding and network play: values,
 * layers, motion, time within the step. A restored state continues bit-identically, in this or another face
 * of the same rig, solver, level and layers, on the same build and kind of machine. The blending of vertices
 * after a change of level is not included. `size` receives the number of bytes, also if `capacity` is too
 * small (FASCIA_ERROR_ARGUMENT); with `to` NULL that is all. FASCIA_ERROR_MODULE if the solver (Bullet) does
 * not support it. Does not allocate. */
FASCIA_API fascia_result fascia_face_save(fascia_face* face, void* to, size_t capacity, size_t* size);

/** Restores a saved state. FASCIA_ERROR_FORMAT if the bytes are damaged, FASCIA_ERROR_MISMATCH if they are of
 * another kind of face, FASCIA_ERROR_MODULE as fascia_face_save; the face is then unchanged, except that
 * bytes with a valid checksum and impossible contents (FASCIA_ERROR_FORMAT) leave it reset. */
FASCIA_API fascia_result fascia_face_restore(fascia_face* face, const void* bytes, size_t size);

/** Inertial acceleration of the tissue in the head's frame, 3 floats, m/s^2 in the rig's axes: the negative
 * of the head's acceleration, for example. NULL for none. Kept until it is set again. */
FASCIA_API fascia_result fascia_face_set_acceleration(fascia_face* face, const float* acceleration);

/** Sets the pose of the head in the world: a rigid transform in metres, 4 x 4, column-major, from the head's
 * frame. In the next step soft tissue lags behind the head's acceleration (at most 60 m/s^2), scaled by
 * `inertia_scale` (1 is physical, 0 none). A jump of more than half a metre in one step counts as a teleport
 * and causes no motion. Call it before each step while the head moves. FASCIA_ERROR_ARGUMENT for a matrix
 * that scales, shears or mirrors, or whose translation exceeds 1000 km. */
FASCIA_API fascia_result fascia_face_move_head(fascia_face* face, const float matrix[16],
                                               float inertia_scale);

/** Applies a force in newtons, in the rig's axes, to a vertex of a mesh until all touches are cleared. A
 * force of more than 1000 N counts as 1000 N in its direction. FASCIA_ERROR_ARGUMENT if there are too many:
 * at least 64 fit in rigs that `fascia build` makes. */
FASCIA_API fascia_result fascia_face_touch(fascia_face* face, uint32_t mesh, uint32_t vertex,
                                           const float force[3]);
/** Removes the forces of fascia_face_touch. */
FASCIA_API fascia_result fascia_face_clear_touches(fascia_face* face);

/** Vertex positions of a mesh (see fascia_asset_get_mesh) in the face's space, in the file's vertex order. */
FASCIA_API fascia_result fascia_face_positions(fascia_face* face, uint32_t mesh, fascia_vectors* positions);

/** Unit vertex normals of a mesh in the face's space: the file's own, rotated with the surface; smooth ones
 * if the file has none. Computed on request. */
FASCIA_API fascia_result fascia_face_normals(fascia_face* face, uint32_t mesh, fascia_vectors* normals);

/** Tangents for normal maps: 4 floats per vertex, the unit tangent in the face's space and the handedness (1
 * or -1), the file's own or those of its first texture coordinates, moved with the surface. None (count 0) if
 * the file has neither. Computed on request. */
FASCIA_API fascia_result fascia_face_tangents(fascia_face* face, uint32_t mesh, fascia_vectors* tangents);

/** Compression of the skin at each vertex of a mesh, for wrinkle shaders: the direction of the largest
 * compressive strain at rest, in the rig's axes, times the strain (0.2: one fifth shorter). Zero without
 * compression and on other parts. The sign is arbitrary; wrinkles are perpendicular to it. Computed on
 * request; the list stays in place until the face is released, a later call for the same mesh updates it. */
FASCIA_API fascia_result fascia_face_compression(fascia_face* face, uint32_t mesh,
                                                 fascia_vectors* compression);

/** Copies positions to the host's memory: 3 floats every `stride` bytes (12 or more). FASCIA_ERROR_ARGUMENT
 * if `capacity`, in vertices, is too small. */
FASCIA_API fascia_result fascia_face_write_positions(fascia_face* face, uint32_t mesh, void* to,
                                                     size_t stride, size_t capacity);

/** Copies normals to the host's memory, as fascia_face_write_positions. */
FASCIA_API fascia_result fascia_face_write_normals(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                                   size_t capacity);
/** Copies tangents to the host's memory, 4 floats each (stride 16 or more); none if the mesh has none. */
FASCIA_API fascia_result fascia_face_write_tangents(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                                    size_t capacity);

/** Current positions of the points of the level's fibres (see fascia_asset_fibres), in metres. Computed on
 * request; valid until the level changes. */
FASCIA_API fascia_result fascia_face_fibre_points(fascia_face* face, fascia_vectors* points);

/** Pose of the mandible as of the last pose or step: a rigid transform from its position at rest, metres in
 * the rig's axes, 4 x 4, column-major. */
FASCIA_API fascia_result fascia_face_jaw(const fascia_face* face, float matrix[16]);

#ifdef __cplusplus
}
#endif

#endif

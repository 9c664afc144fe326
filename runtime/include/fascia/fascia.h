/* Fascia's runtime: loads a face rig and simulates it. Plain C (C99), no other header needed.
 *
 * A rig file is a glTF binary (.glb) that carries the FASCIA extensions. Load it once as an asset, make a
 * face of it for each head in the scene, write channel values, let time pass, read vertex positions:
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
 * until it is released; what they point at changes with each pose or step.
 *
 * Errors. Functions that can fail return a fascia_result; the message of the last failure on this thread is
 * kept. Out parameters are written on success only. Nothing throws, nothing ends the program.
 *
 * Structures. Each begins with struct_size, which the caller sets to sizeof the structure; later versions
 * grow at the end only. Texts are UTF-8, end with 0, and belong to the asset or curves they came from.
 *
 * Beside this header there are fascia/gpu.h (vertex data for skinning on the graphics card),
 * fascia/fit.h (muscles from a stream of landmarks), fascia/research.h (nodes, forces, energies,
 * derivatives), fascia/api.h (all functions as one table, for hosts that load the library themselves) and
 * fascia/fascia.hpp (C++20).
 *
 * Units and axes. Metres and radians unless a space says otherwise. Left and right are the subject's.
 */
#ifndef FASCIA_FASCIA_H
#define FASCIA_FASCIA_H

#include <stddef.h>
#include <stdint.h>

/* Define FASCIA_STATIC when linking the static library; the library's own build defines FASCIA_BUILDING. */
#if defined(FASCIA_STATIC)
#define FASCIA_API
#elif defined(_WIN32) && defined(FASCIA_BUILDING)
#define FASCIA_API __declspec(dllexport)
#elif defined(_WIN32)
#define FASCIA_API __declspec(dllimport)
#elif defined(__GNUC__)
#define FASCIA_API __attribute__((visibility("default")))
#else
#define FASCIA_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define FASCIA_VERSION_MAJOR 0
#define FASCIA_VERSION_MINOR 1
#define FASCIA_VERSION_PATCH 0

typedef enum fascia_result {
  FASCIA_OK = 0,
  FASCIA_ERROR_ARGUMENT = 1, /* a null pointer, an index out of range, a number that is not finite */
  FASCIA_ERROR_FORMAT = 2,   /* the bytes are not a sound rig or curve file */
  FASCIA_ERROR_VERSION = 3,  /* a rig of a version this library does not know */
  FASCIA_ERROR_MISMATCH = 4, /* the meshes were changed after the rig was built */
  FASCIA_ERROR_NAME = 5,     /* no channel or member of that name */
  FASCIA_ERROR_MEMORY = 6,   /* out of memory */
  FASCIA_ERROR_DIVERGED = 7, /* the simulation was put back to rest, see fascia_face_step */
  FASCIA_ERROR_MODULE = 8,   /* a solver module is not there */
  FASCIA_ERROR_INTERNAL = 9, /* a fault of the library: please report it */
  FASCIA_RESULT_32 = 0x7fffffff
} fascia_result;

typedef struct fascia_asset fascia_asset;   /* a loaded rig: immutable, shared */
typedef struct fascia_face fascia_face;     /* one head with its own values and motion */
typedef struct fascia_curves fascia_curves; /* named values over time: immutable, shared */

/* Version of the library: major << 16 | minor << 8 | patch. */
FASCIA_API uint32_t fascia_version(void);

/* Name of a result, such as "FASCIA_ERROR_FORMAT". */
FASCIA_API const char* fascia_result_name(fascia_result result);

/* What went wrong last on this thread, as one sentence; "" when nothing has. Valid until the next call on
 * this thread. */
FASCIA_API const char* fascia_last_message(void);

/* Called with each failure's message too, on the thread where it happens; NULL for none. Set it before other
 * threads use the library. */
typedef void (*fascia_log_function)(void* user, fascia_result result, const char* message);
FASCIA_API void fascia_set_log(fascia_log_function function, void* user);

/* The host's memory. `allocate` returns `size` bytes at a multiple of `alignment` (a power of two), or NULL;
 * `release` takes back what it returned. Both may be called on any thread. */
typedef struct fascia_allocator {
  uint32_t struct_size;
  uint32_t reserved;
  void* (*allocate)(size_t size, size_t alignment, void* user);
  void (*release)(void* block, void* user);
  void* user;
} fascia_allocator;

/* From now on the memory of the library comes from the host; NULL goes back to malloc. (A throw of the C++
 * library and a table of names of some 30 KB, kept for good, are left out.) FASCIA_ERROR_ARGUMENT
 * while the library holds any memory: call it before everything else. FASCIA_ERROR_MODULE where the library
 * was built without it (the static library, and systems other than Linux). The Bullet module has memory of
 * its own and is refused while a host's allocator is set. */
FASCIA_API fascia_result fascia_set_allocator(const fascia_allocator* allocator);

/* --- Assets
 * ------------------------------------------------------------------------------------------------------ */

/* Loads a rig from the `size` bytes of a .glb file; they are not needed afterwards. Every index, length and
 * fingerprint in the file is checked. */
FASCIA_API fascia_result fascia_asset_load(const void* bytes, size_t size, fascia_asset** asset);

/* Lets go of the asset; faces made of it keep what they need. NULL is allowed. */
FASCIA_API void fascia_asset_release(fascia_asset* asset);

typedef struct fascia_asset_info {
  uint32_t struct_size;
  uint32_t level_count; /* levels of detail, coarse to fine */
  uint32_t mesh_count;  /* primitives of the file that the rig moves */
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
  uint32_t mesh, primitive; /* where it is in the glTF file */
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

/* Index of a channel by name, case-insensitive; -1 when there is none. */
FASCIA_API int32_t fascia_asset_find_channel(const fascia_asset* asset, const char* name);

/* Indices of a set's member by name as in fascia_face_set ("arkit:jawOpen", "jawOpen"); FASCIA_ERROR_NAME
 * when the name is a channel's or nobody's. */
FASCIA_API fascia_result fascia_asset_find_member(const fascia_asset* asset, const char* name, uint32_t* set,
                                                  uint32_t* member);

/* A surface of the anatomy at rest, in metres: "cranium", "mandible", "teeth_upper", "teeth_lower" or "smas".
 * Of no vertices when the rig has none; FASCIA_ERROR_NAME for any other name. For display. */
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

/* --- Faces
 * ------------------------------------------------------------------------------------------------------- */

typedef enum fascia_space {
  FASCIA_SPACE_MESH = 0,   /* as the POSITION attribute in the file: what an engine puts in its place */
  FASCIA_SPACE_INPUT = 1,  /* the file's axes and units, node transforms applied */
  FASCIA_SPACE_METRES = 2, /* the rig's own: metres, +Y up, facing +Z; the anatomy's surfaces are here */
  FASCIA_SPACE_32 = 0x7fffffff
} fascia_space;

typedef enum fascia_solver {
  FASCIA_SOLVER_OWN = 0,
  FASCIA_SOLVER_BULLET =
      1, /* needs the module libfascia_bullet beside this library or on the loader's path */
  FASCIA_SOLVER_REFERENCE =
      2, /* the own one in double precision, every step converged: slow, to compare with */
  FASCIA_SOLVER_32 = 0x7fffffff
} fascia_solver;

typedef struct fascia_face_options {
  uint32_t struct_size;
  fascia_space space; /* of positions and normals */
  fascia_solver solver;
  int32_t level;      /* level of detail; -1 the finest */
  int32_t iterations; /* of the own solver in each 1/120 s: 0 as it thinks best (2); 1 for crowds, up to 32 to
                         come nearer to the exact motion */
} fascia_face_options;

/* The options a face has when it is made with NULL: mesh space, own solver, finest level. */
FASCIA_API fascia_face_options fascia_default_face_options(void);

/* Makes a face at rest. The first face of a level prepares that level for all (up to 100 ms). */
FASCIA_API fascia_result fascia_face_create(fascia_asset* asset, const fascia_face_options* options,
                                            fascia_face** face);
FASCIA_API void fascia_face_release(fascia_face* face);

/* The face's own channel values, channel_count floats to read and write freely; clamped to their range when
 * used. */
FASCIA_API float* fascia_face_values(fascia_face* face);

/* Sets a value by name, case-insensitive: a channel, "set:member" such as "arkit:jawOpen" or "au:12", or a
 * member's bare name when no channel and no earlier set has it; other spellings (mouthSmile_L) and other
 * programs' names (viseme_PP, Joy) are known too. A member's value stays until it is set again,
 * and adds to the channels it maps onto: as much as makes the face go that share of its way (the member's
 * response), and eyes turn by that share of their angle. */
FASCIA_API fascia_result fascia_face_set(fascia_face* face, const char* name, float value);

/* The value last set by that name. */
FASCIA_API fascia_result fascia_face_get(const fascia_face* face, const char* name, float* value);

/* The same for a member of a set by index (see fascia_asset_get_set), without looking for a name. */
FASCIA_API fascia_result fascia_face_set_member(fascia_face* face, uint32_t set, uint32_t member,
                                                float value);

/* Puts every channel to its rest value and every member to 0. */
FASCIA_API fascia_result fascia_face_clear(fascia_face* face);

/* How a layer joins those below it, channel by channel; a departure is a value minus the channel's rest. */
typedef enum fascia_combine {
  FASCIA_COMBINE_ADD = 0,      /* the sum of the departures, clamped to the channel's range */
  FASCIA_COMBINE_MAX = 1,      /* the greater departure: two sources of one motion do not drive it twice */
  FASCIA_COMBINE_SATURATE = 2, /* 1 - (1 - a)(1 - b) of the way to the range's end: grows, never passes it */
  FASCIA_COMBINE_OVERRIDE = 3, /* the layer alone, as far as its weight and mask go */
  FASCIA_COMBINE_32 = 0x7fffffff
} fascia_combine;

typedef struct fascia_layer {
  uint32_t struct_size;
  fascia_combine combine;
  float weight; /* 0 (no effect) to 1 */
  uint32_t reserved;
  const float* mask; /* channel_count weights from 0 to 1, copied; NULL for all channels alike */
} fascia_layer;

/* Adds layer `index` (1 to 7), or changes how it joins. Layer 0 is the face's own values and members and what
 * fascia_curves_apply adds; higher layers join it in the order of their indices. Allocates for a new layer.
 */
FASCIA_API fascia_result fascia_face_set_layer(fascia_face* face, uint32_t index, const fascia_layer* layer);

/* A layer's own values, as fascia_face_values, which is layer 0's; NULL when there is no such layer. */
FASCIA_API float* fascia_face_layer_values(fascia_face* face, uint32_t layer);

/* As fascia_face_set and fascia_face_clear, in a layer. */
FASCIA_API fascia_result fascia_face_layer_set(fascia_face* face, uint32_t layer, const char* name,
                                               float value);
FASCIA_API fascia_result fascia_face_layer_clear(fascia_face* face, uint32_t layer);

/* Turns both eyes to a point in metres in the head's frame (the rig's axes), each about its own centre and
 * within its range, as far as `weight` (0 to 1) goes; from the next pose or step on, until set again. NULL
 * for none. */
FASCIA_API fascia_result fascia_face_look_at(fascia_face* face, const float* point, float weight);

/* Over `seconds` of steps, brings the share of everything that drives the face to `share`: 0 lets it come to
 * rest, as when a capture loses the actor, 1 (where a face begins) lets everything through again. */
FASCIA_API fascia_result fascia_face_blend(fascia_face* face, float share, float seconds);

/* What the last pose or step used: own values, members and curves added up and clamped. channel_count floats.
 */
FASCIA_API const float* fascia_face_effective_values(const fascia_face* face);

/* The pose in which all forces of the present values balance; time then goes on from it without velocity.
 * Curves applied since the last pose or step are used up. */
FASCIA_API fascia_result fascia_face_pose(fascia_face* face);

/* Lets `seconds` (0 to 1) pass. Any frame rate gives nearly the same motion; a very long frame loses time.
 * The jaw takes 0.12 s from shut to wide open at least, whatever its channels do.
 * FASCIA_ERROR_DIVERGED says that the simulation became unsound and the face stands at its bones again: it
 * may be stepped on. Curves applied since the last pose or step are used up. */
FASCIA_API fascia_result fascia_face_step(fascia_face* face, float seconds);

/* The host's own tasks, for functions that can share their work among threads. `begin` starts or queues a
 * task that calls `run(first, end, context)` for ranges that together cover 0 .. count once each, none
 * shorter than `least` but the last, on any threads at any time; it returns what `finish` needs to wait for
 * the task, or NULL when all was run already. `finish` returns when every range was run. Nothing depends on
 * how the ranges are cut. `user` is handed to both. */
typedef void (*fascia_task_range)(uint32_t first, uint32_t end, void* context);
typedef struct fascia_tasks {
  uint32_t struct_size;
  uint32_t reserved;
  void* (*begin)(fascia_task_range run, uint32_t count, uint32_t least, void* context, void* user);
  void (*finish)(void* task, void* user);
  void* user;
} fascia_tasks;

/* Lets `seconds` (0 to 1) pass for many faces at once: each as fascia_face_step, with the same result to the
 * last bit, through the host's tasks, or one after the other on this thread when `tasks` is NULL. The faces
 * may be of different assets; none may be listed twice or used elsewhere until this returns.
 * FASCIA_ERROR_DIVERGED when any face was put back. */
FASCIA_API fascia_result fascia_faces_step(fascia_face* const* faces, uint32_t count, float seconds,
                                           const fascia_tasks* tasks);

/* Takes all motion out and stands the face at rest under its present jaw: after a cut or a teleport. */
FASCIA_API fascia_result fascia_face_reset(fascia_face* face);

/* Goes on at another level of detail (-1 the finest), at the pose of the present values and without velocity.
 * Vertices stay where they are shown and go over `seconds` of steps to where the new level has them. Vertex
 * arrays stay where they are; lists of nodes and fibre points change, and touches are cleared. Allocates, and
 * the first use of a level prepares it. */
FASCIA_API fascia_result fascia_face_set_level(fascia_face* face, int32_t level, float seconds);

/* The level of detail now; -1 when the face is NULL. */
FASCIA_API int32_t fascia_face_level(const fascia_face* face);

/* Saves all that the face's next steps depend on, for rewinding and for play over a network: values, layers,
 * motion, time within the step. A state put back goes on with the same bits, in this or another face of the
 * same rig, solver, level and layers, on the same build and kind of machine. How the vertices fade after a
 * change of level is not part of it. `size` gets how many bytes there are; with `to` NULL nothing else
 * happens. FASCIA_ERROR_ARGUMENT when `capacity` is too small, FASCIA_ERROR_MODULE when the solver (Bullet)
 * cannot. Allocates nothing. */
FASCIA_API fascia_result fascia_face_save(fascia_face* face, void* to, size_t capacity, size_t* size);

/* Puts a saved state back. FASCIA_ERROR_FORMAT when the bytes are damaged and FASCIA_ERROR_MISMATCH when they
 * are another kind of face's: nothing has changed then. */
FASCIA_API fascia_result fascia_face_restore(fascia_face* face, const void* bytes, size_t size);

/* Acceleration that loose tissue feels in the head's frame, m/s^2 in the rig's axes: minus the head's own,
 * say. NULL for none. Kept until it is set again. */
FASCIA_API fascia_result fascia_face_set_acceleration(fascia_face* face, const float* acceleration);

/* Tells where the head stands in the world: a rigid transform in metres, 4 x 4, column-major, from the head's
 * frame. The next step makes loose tissue lag behind its acceleration, times `inertia_scale` (1 is physical,
 * 0 none). A jump of more than half a metre in one step counts as a teleport and moves nothing. Called before
 * each step while the head moves. */
FASCIA_API fascia_result fascia_face_move_head(fascia_face* face, const float matrix[16],
                                               float inertia_scale);

/* Presses on a vertex of a mesh with a force in newtons, in the rig's axes, until all touches are cleared. At
 * most 64. */
FASCIA_API fascia_result fascia_face_touch(fascia_face* face, uint32_t mesh, uint32_t vertex,
                                           const float force[3]);
FASCIA_API fascia_result fascia_face_clear_touches(fascia_face* face);

/* A list of three-component vectors in the face's memory. */
typedef struct fascia_vectors {
  uint32_t struct_size;
  uint32_t count;
  uint32_t stride; /* bytes from one to the next: 12; 16 for tangents */
  uint32_t reserved;
  const float* data;
} fascia_vectors;

/* Vertex positions of a mesh (see fascia_asset_get_mesh) in the face's space, in the file's vertex order. */
FASCIA_API fascia_result fascia_face_positions(fascia_face* face, uint32_t mesh, fascia_vectors* positions);

/* Unit vertex normals of a mesh in the face's space: the file's own, turned as the surface turns; smooth ones
 * when the file has none. Computed when asked for. */
FASCIA_API fascia_result fascia_face_normals(fascia_face* face, uint32_t mesh, fascia_vectors* normals);

/* Tangents for normal maps: 4 floats a vertex, the unit tangent in the face's space and the handedness (1 or
 * -1), the file's own or else those of its first texture coordinates, going with the surface. None (count 0)
 * when the file has neither. Computed when asked for. */
FASCIA_API fascia_result fascia_face_tangents(fascia_face* face, uint32_t mesh, fascia_vectors* tangents);

/* How the skin is compressed at each vertex of a mesh, for wrinkle shaders: the direction of the strongest
 * compression at rest, in the rig's axes, times its share (0.2: one fifth shorter). Zero where nothing is
 * compressed and on other parts. Its sign means nothing; wrinkles run across it. Computed when asked for. */
FASCIA_API fascia_result fascia_face_compression(fascia_face* face, uint32_t mesh,
                                                 fascia_vectors* compression);

/* Copies positions to memory of the host's: 3 floats each `stride` bytes (12 or more). FASCIA_ERROR_ARGUMENT
 * when `capacity` vertices are too few. */
FASCIA_API fascia_result fascia_face_write_positions(fascia_face* face, uint32_t mesh, void* to,
                                                     size_t stride, size_t capacity);

/* The same for normals, and for tangents (4 floats each, stride 16 or more). */
FASCIA_API fascia_result fascia_face_write_normals(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                                   size_t capacity);
FASCIA_API fascia_result fascia_face_write_tangents(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                                    size_t capacity);

/* Points of the level's fibres (see fascia_asset_fibres) as they stand now, in metres. */
FASCIA_API fascia_result fascia_face_fibre_points(fascia_face* face, fascia_vectors* points);

/* Where the mandible stands: a rigid transform in metres, 4 x 4, column-major. */
FASCIA_API fascia_result fascia_face_jaw(const fascia_face* face, float matrix[16]);

/* --- Curves
 * ------------------------------------------------------------------------------------------------------ */

/* Loads named values over time from the bytes of a file, whose kind is found from its content (docs/curves.md
 * lists them): tables of text with a column of times or timecodes (Live Link Face, OpenFace, Audio2Face, any
 * CSV), JSON {"fps": 60, "channels": {NAME: [...]}} or {NAME: {"times": [...], "values": [...],
 * "interpolation": "linear" | "step" | "cubic"}} or as capture programs write it, and glTF binary whose
 * animations point at FASCIA_actuation channels (KHR_animation_pointer) or move named morph targets.
 * Time counts from the first key. */
FASCIA_API fascia_result fascia_curves_load(const void* bytes, size_t size, fascia_curves** curves);

/* What a file of curves does not say, or says wrongly. */
typedef struct fascia_curves_options {
  uint32_t struct_size;
  uint32_t reserved;
  double
      frames_per_second; /* of rows, frames and timecodes, instead of the file's own; 0: as the file says */
  double time_unit;      /* seconds in one unit of the file's times; 0: as the file says */
} fascia_curves_options;

/* The same with options; NULL for none. */
FASCIA_API fascia_result fascia_curves_load_as(const void* bytes, size_t size,
                                               const fascia_curves_options* options, fascia_curves** curves);
FASCIA_API void fascia_curves_release(fascia_curves* curves);

typedef struct fascia_curves_info {
  uint32_t struct_size;
  uint32_t count;           /* curves */
  const char* const* names; /* count */
  double duration;          /* seconds: time of the last key */
  double start;             /* seconds: where the file's own time stood at its first key */
  double frames_per_second; /* of the file's rows, where it says; else 0 */
  uint32_t note_count;
  uint32_t has_head;        /* 1 when curves turn the head, see fascia_curves_head */
  const char* const* notes; /* note_count sentences: how the file was taken, and what was mended */
} fascia_curves_info;
FASCIA_API fascia_result fascia_curves_get_info(const fascia_curves* curves, fascia_curves_info* info);

/* How many of the curves the asset has a channel or member for; matched[i] is 1 for those, else 0. `matched`
 * (count elements) may be NULL. */
FASCIA_API fascia_result fascia_curves_match(const fascia_curves* curves, const fascia_asset* asset,
                                             uint32_t* count, uint8_t* matched);

/* How the head is turned at `seconds`, which is no channel of the rig: a quaternion (x, y, z, w) in the rig's
 * axes, yaw about +Y, then pitch about +X, then roll about +Z. The identity where no curve turns it. */
FASCIA_API fascia_result fascia_curves_head(const fascia_curves* curves, double seconds, float quaternion[4]);

/* Adds the curves' values at `seconds`, times `weight`, to what the face's next pose or step uses. Several
 * curves may be applied to one frame: they add up, and the sum is clamped to each channel's range; captured
 * rotations of the eyes take their channels from everything else. Before the
 * first key and after the last their values hold. Curves the rig has no name for are left out. */
FASCIA_API fascia_result fascia_curves_apply(const fascia_curves* curves, double seconds, float weight,
                                             fascia_face* face);

/* The same in a layer of the face. */
FASCIA_API fascia_result fascia_curves_apply_to_layer(const fascia_curves* curves, double seconds,
                                                      float weight, fascia_face* face, uint32_t layer);

#ifdef __cplusplus
}
#endif

#endif

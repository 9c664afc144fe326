/** \file
 * The basis of Fascia's C interface: export macro, version, results, messages, allocator and the handles.
 * Included by fascia/fascia.h.
 */
#ifndef FASCIA_BASE_H
#define FASCIA_BASE_H

#include <stddef.h>
#include <stdint.h>

/** Define FASCIA_STATIC when linking the static library; the library's own build defines FASCIA_BUILDING. */
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

#define FASCIA_VERSION_MAJOR 0 /**< of these headers; a host needs a library of the same major version */
#define FASCIA_VERSION_MINOR 1 /**< of these headers; grows with additions, before 1.0 with any change */
#define FASCIA_VERSION_PATCH 0 /**< of these headers; grows with corrections to the library */

/** What a function returns: success, or the kind of failure. */
typedef enum fascia_result {
  FASCIA_OK = 0,                /**< success */
  FASCIA_ERROR_ARGUMENT = 1,    /**< a null pointer, or an index, size or number out of range */
  FASCIA_ERROR_FORMAT = 2,      /**< the bytes are not a valid rig, curves file or saved state */
  FASCIA_ERROR_VERSION = 3,     /**< a rig of an unknown version, or a host of another version */
  FASCIA_ERROR_MISMATCH = 4,    /**< meshes changed since the rig was built, or a state of another face */
  FASCIA_ERROR_NAME = 5,        /**< no channel, member, surface or landmark has that name */
  FASCIA_ERROR_MEMORY = 6,      /**< out of memory */
  FASCIA_ERROR_DIVERGED = 7,    /**< the simulation was reset (fascia_face_step), or has no derivatives */
  FASCIA_ERROR_MODULE = 8,      /**< a solver module or a feature is not available */
  FASCIA_ERROR_INTERNAL = 9,    /**< a bug in the library: please report it */
  FASCIA_RESULT_32 = 0x7fffffff /**< not a result: makes the type 32 bits wide */
} fascia_result;

typedef struct fascia_asset fascia_asset;   /**< a loaded rig: immutable, shared */
typedef struct fascia_face fascia_face;     /**< one instance of a rig, with its own state */
typedef struct fascia_curves fascia_curves; /**< named values over time: immutable, shared */

/** Version of the library: major << 16 | minor << 8 | patch. */
FASCIA_API uint32_t fascia_version(void);

/** Name of a result, such as "FASCIA_ERROR_FORMAT"; "unknown result" for any other number. A constant. */
FASCIA_API const char* fascia_result_name(fascia_result result);

/** Message of the last failure on this thread, one sentence (at most 2047 bytes); "" if there was none. Valid
 * until the next failure on this thread, at least until the next call. */
FASCIA_API const char* fascia_last_message(void);

/** What fascia_set_log sets: called with the message of each failure, which is valid during the call, on the
 * thread where it occurs. Must not throw. */
typedef void (*fascia_log_function)(void* user, fascia_result result, const char* message);
/** Sets the function that is told of each failure, and the `user` it is called with; NULL for none (the
 * initial state). Not synchronised: set it before other threads use the library. */
FASCIA_API void fascia_set_log(fascia_log_function function, void* user);

/** An allocator of the host. Both functions may be called on any thread, and must not throw. */
typedef struct fascia_allocator {
  uint32_t struct_size; /**< sizeof the structure */
  uint32_t reserved;    /**< not used: set it to 0 */
  /** Returns `size` bytes at a multiple of `alignment` (a power of two), or NULL if there is no memory. */
  void* (*allocate)(size_t size, size_t alignment, void* user);
  void (*release)(void* block, void* user); /**< frees a block that `allocate` returned */
  void* user;                               /**< passed to both */
} fascia_allocator;

/** Makes the library use the host's allocator, which is copied; NULL selects malloc again.
 * FASCIA_ERROR_ARGUMENT while any asset, face, curves or fit exists: call it before all other functions, on
 * one thread. A table of names of some 30 KB, made on first use, is never freed and belongs to the allocator
 * of that moment. FASCIA_ERROR_MODULE if the library was built without this feature (the static library, and
 * systems other than Linux). The Bullet module allocates memory of its own and is not available while a
 * host's allocator is set. */
FASCIA_API fascia_result fascia_set_allocator(const fascia_allocator* allocator);

/** What a task of the host calls: does the work of the range `first` to `end` - 1. */
typedef void (*fascia_task_range)(uint32_t first, uint32_t end, void* context);
/** The host's task system, for functions that can run in parallel. Results do not depend on the partition. */
typedef struct fascia_tasks {
  uint32_t struct_size; /**< sizeof the structure */
  uint32_t reserved;    /**< not used: set it to 0 */
  /** Starts or queues a task that calls `run(first, end, context)` for disjoint ranges that together cover 0
   * to `count` - 1, each at least `least` long except the last, on any threads at any time. Returns a handle
   * for `finish`, or NULL if everything has already run. */
  void* (*begin)(fascia_task_range run, uint32_t count, uint32_t least, void* context, void* user);
  void (*finish)(void* task, void* user); /**< returns when every range has run */
  void* user;                             /**< passed to both */
} fascia_tasks;

/** A list of vectors of floats in the memory of a face or an asset. */
typedef struct fascia_vectors {
  uint32_t struct_size; /**< sizeof the structure */
  uint32_t count;       /**< number of vectors */
  uint32_t stride;   /**< bytes from one vector to the next: 12; 16 for tangents, 8 for texture coordinates */
  uint32_t reserved; /**< 0 */
  const float* data; /**< the first vector; NULL if there are none */
} fascia_vectors;

#ifdef __cplusplus
}
#endif

#endif

/* The basis of Fascia's C interface: export macro, version, results, messages, allocator and the handles.
 * Included by fascia/fascia.h.
 */
#ifndef FASCIA_BASE_H
#define FASCIA_BASE_H

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
  FASCIA_ERROR_FORMAT = 2,   /* the bytes are not a valid rig or curve file */
  FASCIA_ERROR_VERSION = 3,  /* a rig of a version this library does not know */
  FASCIA_ERROR_MISMATCH = 4, /* the meshes were changed after the rig was built */
  FASCIA_ERROR_NAME = 5,     /* no channel or member has that name */
  FASCIA_ERROR_MEMORY = 6,   /* out of memory */
  FASCIA_ERROR_DIVERGED = 7, /* the simulation was reset to rest, see fascia_face_step */
  FASCIA_ERROR_MODULE = 8,   /* a solver module or a feature is not available */
  FASCIA_ERROR_INTERNAL = 9, /* a bug in the library: please report it */
  FASCIA_RESULT_32 = 0x7fffffff
} fascia_result;

typedef struct fascia_asset fascia_asset;   /* a loaded rig: immutable, shared */
typedef struct fascia_face fascia_face;     /* one instance of a rig, with its own state */
typedef struct fascia_curves fascia_curves; /* named values over time: immutable, shared */

/* Version of the library: major << 16 | minor << 8 | patch. */
FASCIA_API uint32_t fascia_version(void);

/* Name of a result, such as "FASCIA_ERROR_FORMAT". */
FASCIA_API const char* fascia_result_name(fascia_result result);

/* Message of the last failure on this thread, one sentence; "" if there was none. Valid until the next call
 * on this thread. */
FASCIA_API const char* fascia_last_message(void);

/* Sets a function that is called with the message of each failure, on the thread where it occurs; NULL for
 * none. Set it before other threads use the library. */
typedef void (*fascia_log_function)(void* user, fascia_result result, const char* message);
FASCIA_API void fascia_set_log(fascia_log_function function, void* user);

/* An allocator of the host. `allocate` returns `size` bytes at a multiple of `alignment` (a power of two), or
 * NULL; `release` frees a block that it returned. Both may be called on any thread. */
typedef struct fascia_allocator {
  uint32_t struct_size;
  uint32_t reserved;
  void* (*allocate)(size_t size, size_t alignment, void* user);
  void (*release)(void* block, void* user);
  void* user;
} fascia_allocator;

/* Makes the library use the host's allocator; NULL selects malloc again. (Exceptions of the C++ library and a
 * permanent table of names of some 30 KB are not included.) FASCIA_ERROR_ARGUMENT while the library holds any
 * memory: call it before all other functions. FASCIA_ERROR_MODULE if the library was built without this
 * feature (the static library, and systems other than Linux). The Bullet module allocates memory of its own
 * and is not available while a host's allocator is set. */
FASCIA_API fascia_result fascia_set_allocator(const fascia_allocator* allocator);

#ifdef __cplusplus
}
#endif

#endif

/* Snapshots: regression tests of a face's motion, for a game's own tests. Plain C (C99); requires
 * libfascia_snapshot and fascia.h.
 *
 *     uint32_t failed = 0;
 *     if (fascia_snapshot_check(rig, rig_size, snapshot, snapshot_size, NULL, &failed) != FASCIA_OK)
 *       puts(fascia_snapshot_message());
 *     assert(failed == 0);
 *
 * 'fascia snapshot record RIG.glb -o FILE' writes the snapshots (docs/snapshots.md).
 */
#ifndef FASCIA_SNAPSHOT_H
#define FASCIA_SNAPSHOT_H

#include <fascia/fascia.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Difference of a region from the recording, in one pose or frame. */
typedef struct fascia_snapshot_difference {
  uint32_t struct_size;
  uint32_t ok;           /* 1 if the difference is within the tolerance */
  const char* state;     /* name of the pose or frame */
  const char* region;    /* name of the region */
  double mean_mm;        /* root mean square over the region's watched vertices */
  double largest_mm;     /* of the vertex with the largest difference */
  uint32_t mesh, vertex; /* indices of that vertex and its mesh in the glTF file */
} fascia_snapshot_difference;

/* Bytes of a file. */
typedef struct fascia_snapshot_file {
  const void* bytes;
  size_t size;
} fascia_snapshot_file;

typedef struct fascia_snapshot_options {
  uint32_t struct_size;
  uint32_t threads;                   /* 0: all processors */
  double tolerance_mm;                /* of every region; 0: each region's own */
  const fascia_snapshot_file* curves; /* the curves files of the takes, in the snapshot's order */
  size_t curve_count;
  /* Called for every region in every pose and frame, on the calling thread; strings are valid during the
   * call. NULL for none. */
  void (*difference)(void* user, const fascia_snapshot_difference* difference);
  void* user;
} fascia_snapshot_options;

/* Plays the snapshot's poses and takes on the rig (the bytes of a .glb) and compares. `failed` becomes the
 * number of differences that are not allowed. `options` may be NULL. FASCIA_ERROR_FORMAT if a file is invalid
 * or does not match the others; fascia_snapshot_message says why. */
FASCIA_API fascia_result fascia_snapshot_check(const void* rig, size_t rig_size, const void* snapshot,
                                               size_t snapshot_size, const fascia_snapshot_options* options,
                                               uint32_t* failed);

/* Message of the last failure on this thread, one sentence; "" if there was none. Valid until the next call
 * on this thread. */
FASCIA_API const char* fascia_snapshot_message(void);

#ifdef __cplusplus
}
#endif

#endif

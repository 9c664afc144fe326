/* Fascia's runtime the other way: from a stream of landmarks on a face to its muscles. See fascia/fascia.h.
 *
 *     fascia_fit_landmarks landmarks = {.struct_size = sizeof landmarks, .set = "ibug68"};
 *     fascia_fit* fit = NULL;
 *     fascia_fit_create(asset, &landmarks, NULL, &fit);
 *     fascia_fit_result result = {.struct_size = sizeof result};
 *     while (frame of 68 points) {
 *       fascia_fit_push(fit, points, weights, &result);
 *       memcpy(fascia_face_values(face), result.values, channel_count * sizeof(float));
 *       fascia_face_step(face, seconds);
 *     }
 *
 * A fit may be used by one thread at a time; different fits may be used in parallel.
 */
#ifndef FASCIA_FIT_H
#define FASCIA_FIT_H

#include "fascia/fascia.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fascia_fit fascia_fit; /* one observed face with its history */

/* A place on the skin: shares of a triangle's three corners. */
typedef struct fascia_fit_place {
  uint32_t mesh;        /* see fascia_asset_get_mesh */
  uint32_t vertices[3]; /* of the mesh */
  float shares[3];      /* at least 0, sum 1 */
} fascia_fit_place;

/* What the points of a frame are: one of set, names and places is given. */
typedef struct fascia_fit_landmarks {
  uint32_t struct_size;
  uint32_t count;           /* points a frame; with a set 0, or its own number */
  const char* set;          /* a detector's mark-up: "ibug68" (3D, or 2D with a camera) or "mediapipe478" */
  const char* const* names; /* count landmarks of the rig: pronasale, cheilion_left, ...; NULL: not used */
  const fascia_fit_place* places; /* count */
} fascia_fit_landmarks;

typedef struct fascia_fit_options {
  uint32_t struct_size;
  int32_t level;       /* of detail to simulate at: 0 the coarsest, which live use wants; -1 the finest */
  int32_t iterations;  /* steps a frame, 1 to 32; each costs a static pose */
  int32_t finds_scale; /* 1: the face may be larger or smaller than the rig's, found in the first frame or
                          the neutral one and kept; 0: both are in metres */
  /* Costs in square millimetres of the mean squared distance: of squared values, of their sizes, and of
   * squared changes from one frame to the next. 0 or more. */
  float ridge, sparsity, smoothness;
  /* Points are pixels of a camera without distortion, x to the right, y down, where focal is not 0; else
   * places in any right-handed axes and units. */
  float focal[2], centre[2];
} fascia_fit_options;

/* What a fit has when it is made with NULL: the coarsest level, places, scale found. */
FASCIA_API fascia_fit_options fascia_default_fit_options(void);

/* Makes a fit. FASCIA_ERROR_NAME when a landmark or the set is not known, FASCIA_ERROR_ARGUMENT when fewer
 * than four landmarks lie on the rig's skin. Takes some 0.1 s at the coarsest level. */
FASCIA_API fascia_result fascia_fit_create(fascia_asset* asset, const fascia_fit_landmarks* landmarks,
                                           const fascia_fit_options* options, fascia_fit** fit);
FASCIA_API void fascia_fit_release(fascia_fit* fit);

typedef struct fascia_fit_info {
  uint32_t struct_size;
  uint32_t point_count; /* a frame */
  uint32_t dimensions;  /* floats a point: 3, or 2 with a camera */
  uint32_t
      landmark_count; /* of the points' landmarks, how many lie on the rig's skin: the others are not used */
  const char* const* names; /* landmark_count; "" where they were given as places */
} fascia_fit_info;
FASCIA_API fascia_result fascia_fit_get_info(const fascia_fit* fit, fascia_fit_info* info);

/* Takes a frame of the same face at rest, by the same detector: where its points lie other than our
 * landmarks, and how this face's proportions differ from the rig's, no longer counts. Arguments as of
 * fascia_fit_push; forgets all frames. FASCIA_ERROR_ARGUMENT when too few points are seen to tell where the
 * head is. */
FASCIA_API fascia_result fascia_fit_set_neutral(fascia_fit* fit, const float* points, const float* weights);

/* What a frame has told; valid until the next call with this fit. */
typedef struct fascia_fit_result {
  uint32_t struct_size;
  uint32_t seen;       /* landmarks that counted; 0 when there were too few and all stays as it was */
  float residual;      /* root mean square distance left between points and fitted face, metres of the head */
  float scale;         /* of the head matrix */
  float head[16];      /* from the rig's metres to the space of the points (with a camera: metres, x right,
                          y down, z away), 4 x 4, column-major */
  const float* values; /* channel_count: what fascia_face_values takes */
  const float* landmarks; /* landmark_count * 3: where the fitted face has them, in that space */
} fascia_fit_result;

/* The next frame: point_count points and as many weights (0: not seen, 1: seen well; NULL: all 1). A point
 * that is not a number is not seen. Channels of which nothing is seen hold their values. `result` may be
 * NULL. Now and then a frame allocates, while the face's derivatives are renewed. */
FASCIA_API fascia_result fascia_fit_push(fascia_fit* fit, const float* points, const float* weights,
                                         fascia_fit_result* result);

/* Forgets all frames, as after a cut; the neutral stays. */
FASCIA_API fascia_result fascia_fit_reset(fascia_fit* fit);

#ifdef __cplusplus
}
#endif

#endif

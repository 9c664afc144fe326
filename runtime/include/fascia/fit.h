/** \file
 * Fascia's runtime, inverse problem: from a stream of facial landmarks to activations. See fascia/fascia.h.
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

typedef struct fascia_fit fascia_fit; /**< a tracker of one observed face */

/** A point on the skin, in barycentric coordinates of a triangle. */
typedef struct fascia_fit_place {
  uint32_t mesh;        /**< see fascia_asset_get_mesh */
  uint32_t vertices[3]; /**< of the mesh */
  float shares[3];      /**< at least 0, sum 1 */
} fascia_fit_place;

/** The meaning of a frame's points: exactly one of set, names and places must be given. All is copied. */
typedef struct fascia_fit_landmarks {
  uint32_t struct_size; /**< sizeof the structure */
  uint32_t count;       /**< points per frame; with a set 0, or its number of points */
  const char* set; /**< a detector's landmark set: "ibug68" (3D, or 2D with a camera) or "mediapipe478" */
  const char* const* names; /**< count landmarks of the rig: pronasale, cheilion_left, ...; NULL: not used */
  const fascia_fit_place* places; /**< count points of the skin */
} fascia_fit_landmarks;

/** How a fit is made. */
typedef struct fascia_fit_options {
  uint32_t struct_size; /**< sizeof the structure */
  int32_t level;        /**< level of detail: 0 the coarsest, recommended for live use; -1 the finest */
  int32_t iterations;   /**< Gauss-Newton steps per frame, 1 to 32; each costs a static pose */
  int32_t finds_scale;  /**< 1: the face's scale may differ from the rig's; estimated in the first frame or
                           the neutral one and kept; 0: both are in metres, as always with a camera */
  /* Penalties, in square millimetres of the mean squared distance, 0 or more. */
  float ridge,    /**< on squared values (by default 1e-3) */
      sparsity,   /**< on absolute values (2e-4) */
      smoothness; /**< on squared changes from frame to frame (5e-2) */
  float focal[2], /**< focal lengths in pixels along x and y, if the points are pixels of a camera without
                     distortion, x to the right, y down; 0: points in any right-handed axes and units */
      centre[2];  /**< the camera's principal point, pixels */
} fascia_fit_options;

/** The options of a fit that is created with NULL: the coarsest level, two steps per frame, points in 3D,
 * scale estimated. */
FASCIA_API fascia_fit_options fascia_default_fit_options(void);

/** Creates a fit, which remains valid when the asset is released. FASCIA_ERROR_NAME if a landmark or the set
 * is unknown or a named landmark is not on the rig's skin, FASCIA_ERROR_ARGUMENT if fewer than four landmarks
 * lie there or a place is on an eye or on nothing, FASCIA_ERROR_FORMAT if the rig lacks what a fit needs (the
 * jaw's channels). `options` may be NULL. Takes some 0.1 s at the coarsest level. */
FASCIA_API fascia_result fascia_fit_create(fascia_asset* asset, const fascia_fit_landmarks* landmarks,
                                           const fascia_fit_options* options, fascia_fit** fit);
/** Releases the fit and the results it has given out. NULL is allowed. */
FASCIA_API void fascia_fit_release(fascia_fit* fit);

/** The sizes of a fit's frames and results. */
typedef struct fascia_fit_info {
  uint32_t struct_size;     /**< sizeof the structure */
  uint32_t point_count;     /**< per frame */
  uint32_t dimensions;      /**< floats per point: 3, or 2 with a camera */
  uint32_t landmark_count;  /**< number of landmarks on the rig's skin: the others are not used */
  const char* const* names; /**< landmark_count; "" for those given as places */
} fascia_fit_info;
/** Describes the fit; the names are valid until it is released. */
FASCIA_API fascia_result fascia_fit_get_info(const fascia_fit* fit, fascia_fit_info* info);

/** Calibrates with a frame of the same face at rest, from the same detector: systematic differences between
 * its points and the landmarks, and between the proportions of the face and the rig, are then compensated.
 * Arguments as for fascia_fit_push; resets the tracking. FASCIA_ERROR_ARGUMENT if too few points are visible
 * to determine the head's pose. */
FASCIA_API fascia_result fascia_fit_set_neutral(fascia_fit* fit, const float* points, const float* weights);

/** The result of a frame; valid until the next call with this fit. */
typedef struct fascia_fit_result {
  uint32_t struct_size; /**< sizeof the structure */
  uint32_t seen;        /**< landmarks used; 0 if there were too few, and the state is unchanged */
  float residual; /**< root mean square distance between points and fitted face, metres in the head's scale */
  float scale;    /**< of the head matrix */
  float head[16]; /**< from the rig's metres to the space of the points (with a camera: metres, x right,
                     y down, z away), 4 x 4, column-major */
  const float* values;    /**< channel_count: for fascia_face_values */
  const float* landmarks; /**< landmark_count * 3: of the fitted face, in that space */
} fascia_fit_result;

/** Fits the next frame: point_count points and as many weights (0: invisible, 1: fully visible; NULL: all 1).
 * NaN marks an invisible point. Unobservable channels keep their values; the eyes are not fitted and stay at
 * rest. `result` may be NULL. Some frames allocate, while the Jacobian is recomputed. */
FASCIA_API fascia_result fascia_fit_push(fascia_fit* fit, const float* points, const float* weights,
                                         fascia_fit_result* result);

/** Resets the tracking, as after a cut; the calibration of fascia_fit_set_neutral is kept. */
FASCIA_API fascia_result fascia_fit_reset(fascia_fit* fit);

#ifdef __cplusplus
}
#endif

#endif

/** \file
 * Activation curves: named values over time, from the files of capture and animation programs. Included by
 * fascia/fascia.h.
 */
#ifndef FASCIA_CURVES_H
#define FASCIA_CURVES_H

#include "fascia/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Loads curves from the bytes of a file, whose format is detected from its content (docs/curves.md lists
 * the formats): text tables with a column of times or timecodes (Live Link Face, OpenFace, Audio2Face, any
 * CSV), JSON {"fps": 60, "channels": {NAME: [...]}} or {NAME: {"times": [...], "values": [...],
 * "interpolation": "linear" | "step" | "cubic"}} or as written by capture programs, and glTF binary
 * whose animations target FASCIA_actuation channels (KHR_animation_pointer) or named morph targets.
 * Time is relative to the first key, and six hours at most. FASCIA_ERROR_FORMAT if the file is in none of
 * these formats or damaged; the message names the row or curve. The bytes may be freed afterwards. */
FASCIA_API fascia_result fascia_curves_load(const void* bytes, size_t size, fascia_curves** curves);

/** Overrides of information that a curves file lacks or has wrong. */
typedef struct fascia_curves_options {
  uint32_t struct_size;     /**< sizeof the structure */
  uint32_t reserved;        /**< not used: set it to 0 */
  double frames_per_second; /**< of rows, frames and timecodes, instead of the file's own; 0: from the file */
  double time_unit;         /**< seconds per unit of the file's times; 0: from the file */
} fascia_curves_options;

/** The same with options; NULL for none. FASCIA_ERROR_ARGUMENT if one of them is negative. */
FASCIA_API fascia_result fascia_curves_load_as(const void* bytes, size_t size,
                                               const fascia_curves_options* options, fascia_curves** curves);
/** Releases the curves, which faces do not keep. NULL is allowed. */
FASCIA_API void fascia_curves_release(fascia_curves* curves);

/** What a curves file contains; its names and notes are valid until the curves are released. */
typedef struct fascia_curves_info {
  uint32_t struct_size;     /**< sizeof the structure */
  uint32_t count;           /**< number of curves */
  const char* const* names; /**< count names, as in the file */
  double duration;          /**< seconds: time of the last key */
  double start;             /**< seconds: the file's own time of its first key */
  double frames_per_second; /**< of the file's rows; 0 if unknown */
  uint32_t note_count;      /**< number of notes */
  uint32_t has_head;        /**< 1 if there are curves of the head's rotation, see fascia_curves_head */
  const char* const* notes; /**< note_count sentences: how the file was interpreted and repaired */
} fascia_curves_info;
/** Describes the curves. */
FASCIA_API fascia_result fascia_curves_get_info(const fascia_curves* curves, fascia_curves_info* info);

/** Counts the curves that drive the asset's channels or members; matched[i] is 1 for those, else 0: where two
 * names mean the same ("jawOpen", "JawOpen") the first drives it. `matched` (as many elements as curves) may
 * be NULL. */
FASCIA_API fascia_result fascia_curves_match(const fascia_curves* curves, const fascia_asset* asset,
                                             uint32_t* count, uint8_t* matched);

/** Rotation of the head at `seconds`, which is not a channel of the rig: a quaternion (x, y, z, w) in the
 * rig's axes, yaw about +Y, then pitch about +X, then roll about +Z. The identity without such curves. */
FASCIA_API fascia_result fascia_curves_head(const fascia_curves* curves, double seconds, float quaternion[4]);

/** Adds the curves' values at `seconds`, times `weight`, to the input of the face's next pose or step.
 * Several curves may be applied in one frame: they add up, and the sum is clamped to each channel's range;
 * captured rotations of the eyes override the other inputs of their channels in the layer. Before the first
 * key and after the last the values are constant. Curves whose name the rig does not know are ignored. The
 * names are looked up, which allocates, when curves are first used with an asset. */
FASCIA_API fascia_result fascia_curves_apply(const fascia_curves* curves, double seconds, float weight,
                                             fascia_face* face);

/** The same for a layer of the face; FASCIA_ERROR_ARGUMENT if it has no such layer. */
FASCIA_API fascia_result fascia_curves_apply_to_layer(const fascia_curves* curves, double seconds,
                                                      float weight, fascia_face* face, uint32_t layer);

#ifdef __cplusplus
}
#endif

#endif

/** \file
 * Fascia's runtime for research: the lattice, forces, energies and derivatives. See fascia/fascia.h.
 *
 * SI units, in the rig's frame. These functions allocate and are not meant for use in every frame.
 */
#ifndef FASCIA_RESEARCH_H
#define FASCIA_RESEARCH_H

#include "fascia/fascia.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The lattice of a level at rest. Nodes form columns of three: node layer * columns + column, layer 0 the
 * skin, 1 the SMAS, 2 the inner layer. */
typedef struct fascia_lattice {
  uint32_t struct_size; /**< sizeof the structure */
  uint32_t node_count,  /**< nodes: three for each column */
      column_count,     /**< columns: vertices of the triangles */
      triangle_count,   /**< triangles of columns, each with a prism between skin and SMAS and one below */
      spring_count;     /**< springs between nodes */
  uint32_t reserved;    /**< 0 */
  const float* rest;    /**< node_count * 3, metres */
  const float* masses;  /**< node_count, kilograms */
  const uint8_t* kinds; /**< node_count: 0 free, 1 fixed, 2 on the cranium, 3 on the mandible, 4 and 5 gliding
                           on them, 6 mucosa */
  const uint32_t* triangles; /**< triangle_count * 3 columns */
  const uint32_t* springs;   /**< spring_count * 2 nodes */
} fascia_lattice;
/** Gives the lattice of a level, in the asset's memory. */
FASCIA_API fascia_result fascia_asset_lattice(const fascia_asset* asset, uint32_t level,
                                              fascia_lattice* lattice);

/** Node positions at the face's level of detail, metres, as of the last pose or step; computed on request,
 * and valid until the level changes. */
FASCIA_API fascia_result fascia_face_nodes(fascia_face* face, fascia_vectors* nodes);

/** Potential energy of the face in its current state, joules, relative to rest, by element type. */
typedef struct fascia_energies {
  uint32_t struct_size; /**< sizeof the structure */
  uint32_t reserved;    /**< 0 */
  double total;         /**< the sum of the following */
  double springs;       /**< retinacula, ligaments and the lattice's edges */
  double membranes;     /**< stretch of skin and SMAS */
  double bending;       /**< of both */
  double volume;        /**< of the prisms */
  double tethers;       /**< gliding planes */
  double fibres;        /**< muscles: their remaining potential */
  double others; /**< kinematic guides, pressure, contact, touches, acceleration, and the correction that
                    makes rest an equilibrium */
} fascia_energies;
/** Computes the energies; of a moving face, without its kinetic energy. */
FASCIA_API fascia_result fascia_face_energies(fascia_face* face, fascia_energies* energies);

/** The sum of all forces on each node in the current state, without inertia and damping, newtons: zero for
 * nodes fixed to bones, and zero up to the solver's tolerance in a static pose. `to` has space for `capacity`
 * nodes of 3 floats; FASCIA_ERROR_ARGUMENT if the level has more. */
FASCIA_API fascia_result fascia_face_node_forces(fascia_face* face, float* to, size_t capacity);

/** Tension of each fibre (see fascia_asset_fibres), newtons; `to` has space for `capacity` of them;
 * FASCIA_ERROR_ARGUMENT if the level has more. */
FASCIA_API fascia_result fascia_face_fibre_forces(fascia_face* face, float* to, size_t capacity);

/** The derivative of a loss with respect to every channel, after fascia_face_pose: implicit differentiation
 * of the equilibrium by one adjoint solve, whatever the number of channels. `slopes` has mesh_count entries,
 * each NULL or the derivative of the loss with respect to that mesh's positions in the face's space,
 * vertex_count * 3 floats. `by_channel` receives channel_count floats, with respect to
 * fascia_face_effective_values without clamping. Exact except for contact, whose normals are held fixed; take
 * FASCIA_SOLVER_REFERENCE to compare with finite differences. The first call after a pose factors the Hessian
 * (tens of milliseconds); FASCIA_ERROR_DIVERGED if that is impossible, and the face is unchanged. */
FASCIA_API fascia_result fascia_face_gradient(fascia_face* face, const float* const* slopes,
                                              float* by_channel);

/** Those derivatives with respect to the members of a set: `by_channel` has channel_count floats, `by_member`
 * receives one float per member. They are taken at the members' current values (fascia_face_set) and include
 * the slope of the response curves. */
FASCIA_API fascia_result fascia_face_member_gradient(const fascia_face* face, uint32_t set,
                                                     const float* by_channel, float* by_member);

#ifdef __cplusplus
}
#endif

#endif

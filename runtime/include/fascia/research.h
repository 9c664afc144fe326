/* Fascia's runtime for research: what stands behind the vertices. See fascia/fascia.h.
 *
 * Everything is in SI units and the rig's own frame. These functions allocate; they are no part of a frame.
 */
#ifndef FASCIA_RESEARCH_H
#define FASCIA_RESEARCH_H

#include "fascia/fascia.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The lattice of a level at rest. Nodes stand in columns of three: node layer * columns + column, layer 0 the
 * skin, 1 the SMAS, 2 the inner layer. */
typedef struct fascia_lattice {
  uint32_t struct_size;
  uint32_t node_count, column_count, triangle_count, spring_count;
  uint32_t reserved;
  const float* rest;    /* node_count * 3, metres */
  const float* masses;  /* node_count, kilograms */
  const uint8_t* kinds; /* node_count: 0 free, 1 fixed, 2 on the cranium, 3 on the mandible, 4 and 5 gliding
                           on them, 6 mucosa */
  const uint32_t* triangles; /* triangle_count * 3 columns: the prisms */
  const uint32_t* springs;   /* spring_count * 2 nodes */
} fascia_lattice;
FASCIA_API fascia_result fascia_asset_lattice(const fascia_asset* asset, uint32_t level,
                                              fascia_lattice* lattice);

/* Where the nodes of the face's level are. */
FASCIA_API fascia_result fascia_face_nodes(fascia_face* face, fascia_vectors* nodes);

/* Potential energy of the face as it stands, joules, above that of rest, by what holds it. */
typedef struct fascia_energies {
  uint32_t struct_size;
  uint32_t reserved;
  double total;
  double springs;   /* retinacula, ligaments and the lattice's edges */
  double membranes; /* stretch of skin and SMAS */
  double bending;   /* of both */
  double volume;    /* of the prisms */
  double tethers;   /* gliding planes */
  double fibres;    /* muscles: what they have yet to give */
  double others;    /* lids' carriers, pressure, contact, touches, acceleration, and what balances rest */
} fascia_energies;
FASCIA_API fascia_result fascia_face_energies(fascia_face* face, fascia_energies* energies);

/* The sum of all forces on each node as the face stands, newtons: zero where bones hold a node, and
 * everywhere in a pose but for the solver's tolerance. `to` holds `capacity` nodes of 3 floats. */
FASCIA_API fascia_result fascia_face_node_forces(fascia_face* face, float* to, size_t capacity);

/* Tension of each fibre (see fascia_asset_fibres), newtons; `to` holds `capacity` of them. */
FASCIA_API fascia_result fascia_face_fibre_forces(fascia_face* face, float* to, size_t capacity);

/* The derivative of a loss by every channel, where the last call was fascia_face_pose: the equilibrium is
 * differentiated implicitly, by one solve of its adjoint whatever the number of channels. `slopes` has
 * mesh_count entries, each NULL or the loss's derivative by that mesh's positions in the face's space,
 * vertex_count * 3 floats. `by_channel` gets channel_count floats: by fascia_face_effective_values, as though
 * no range ended there. Exact but for contact, whose normals are held still; take FASCIA_SOLVER_REFERENCE to
 * compare with finite differences. The first call after a pose factors its curvature (tens of milliseconds).
 */
FASCIA_API fascia_result fascia_face_gradient(fascia_face* face, const float* const* slopes,
                                              float* by_channel);

/* What those derivatives are by the members of a set: `by_channel` has channel_count floats, `by_member` gets
 * one float a member. Where each member stands is what fascia_face_set and its kin have set, and its response
 * (a weight is a share of the way that the face goes, not of its muscles' pull) is differentiated with it. */
FASCIA_API fascia_result fascia_face_member_gradient(const fascia_face* face, uint32_t set,
                                                     const float* by_channel, float* by_member);

#ifdef __cplusplus
}
#endif

#endif

#pragma once

#include <vector>

#include "anatomy/face_place.h"
#include "anatomy/ramp.h"

/// The constants of tissue, attachment, contact, jaw and lids: anatomy/data/mechanics.json in metres, radians
/// and pascal. The file gives the unit, range and source of each. Nothing here has a default.
namespace fascia::anatomy {

namespace mechanics {

/// Constants of all soft tissue.
struct Tissue {
  double density = 0.0;         ///< kg/m3: mass per volume of soft tissue
  double poisson_ratio = 0.0;   ///< in-plane Poisson's ratio of skin and SMAS
  double bending_factor = 0.0;  ///< bending stiffness relative to that of a thin plate of the same material
  double volume_modulus = 0.0;  ///< pascal: resistance to change of volume between skin and SMAS
  double inner_volume_modulus = 0.0;  ///< pascal: resistance to change of volume between the SMAS and the
                                      ///< layer behind it, whose fat can flow aside
  double inner_layer_thickness =
      0.0;  ///< metres: thickness of the tissue whose mass is assigned to the innermost nodes
  double limit_strain = 0.0;  ///< strain at which retinacula, which are wavy at rest, become straight
  double stiffening = 0.0;    ///< stiffness of retinacula beyond the limit strain, relative to that below it
};

/// Skin, and the mucosa that continues it into mouth and lids.
struct Skin {
  double young_modulus = 0.0;  ///< pascal: Young's modulus of the skin at small strain
  double thickness = 0.0;      ///< metres: thickness of the facial skin
  double mucosa_stretch_share =
      0.0;  ///< membrane stiffness of the lining of lips and lids relative to that of skin
  double mucosa_bending_share =
      0.0;  ///< bending stiffness of the lining of lips and lids relative to that of skin
};

/// The SMAS as a membrane.
struct Smas {
  double young_modulus = 0.0;            ///< pascal: Young's modulus of the SMAS at rest
  double thickness = 0.0;                ///< metres: thickness of fascia and muscle together
  double submucosa_stretch_share = 0.0;  ///< membrane stiffness of the layer behind the lining of lips and
                                         ///< lids, where there is no SMAS, relative to that of the SMAS
  double submucosa_bending_share = 0.0;  ///< bending stiffness of the layer behind the lining of lips and
                                         ///< lids relative to that of the SMAS
};

/// Fat with the retinacula in it, between skin and SMAS and between SMAS and mucosa.
struct Fat {
  double across_modulus =
      0.0;  ///< pascal: Young's modulus across the layer between skin and SMAS, retinacula included
  double shear_modulus = 0.0;  ///< pascal: shear modulus of the layer between skin and SMAS where the SMAS is
                               ///< attached to the skin at mean strength
  double deep_across_share =
      0.0;  ///< Young's modulus between SMAS and mucosa relative to that between skin and SMAS
  double deep_shear_share =
      0.0;  ///< shear modulus between SMAS and mucosa relative to that between skin and SMAS
  double lining_volume_share =
      0.0;  ///< volume modulus in the lining of lips and lids relative to that elsewhere
};

/// The plane between SMAS and bone, in which the SMAS glides.
struct Glide {
  double shear_modulus = 0.0;   ///< pascal: shear modulus of the gliding plane at mean attachment
  double normal_modulus = 0.0;  ///< pascal: modulus of the gliding plane across it
  double least_depth = 0.0;     ///< metres: gliding planes thinner than this have the stiffness of this depth
  double pressing_depth =
      0.0;  ///< metres: gliding planes deeper than this have the normal stiffness of this depth
};

/// How gliding zones, lips, lids and the vestibule of the mouth change the attachment of the SMAS to bone.
/// Factors of the moduli of the gliding plane.
struct Attachment {
  double free_factor = 0.0;  ///< attachment factor where a gliding plane is widest
  double firm_factor = 0.0;  ///< attachment factor where nothing glides
  double zone_share =
      0.0;  ///< weight of the gliding zones of tissue.json relative to the attachment regions of this file
  Ramp lip_fade;  ///< metres: distances from the lips' edge over which the attachment to bone rises to its
                  ///< full value
  double lip_share = 0.0;  ///< fraction of the attachment to bone that remains at the lips' edge
  Ramp lid_fade;  ///< metres: distances from the lids' edge over which the attachment to bone rises to its
                  ///< full value
  double lid_share = 0.0;  ///< fraction of the attachment to bone that remains at the lids' edge
  Ramp air_depth;  ///< metres: depths to bone over which tissue in front of the vestibule changes from lying
                   ///< on bone to lying on mucosa and air
  double air_shear_loss = 0.0;   ///< fraction of the tangential attachment that is lost over air
  double air_normal_loss = 0.0;  ///< fraction of the normal attachment that is lost over air
  double free_travel = 0.0;      ///< metres: travel of a gliding plane from which on the SMAS counts as free
};

/// Eyelids: thin skin, and tarsal plates that move with the globe.
struct Lids {
  double softness_share = 0.0;  ///< stiffness of the lids' skin relative to that of the face
  Ramp softness_fade;  ///< metres: distances from the lids' edge over which the skin takes on the stiffness
                       ///< of the face
  double reach =
      0.0;  ///< metres: distance from the lids' edge within which tissue can be in contact with the globe
  Ramp canthal_fade;  ///< positions along the fissure, in its widths from a canthus, over which a tarsal
                      ///< plate begins
  Ramp upper_plate;   ///< metres: distances from the lid's edge over which the hold of the upper tarsal plate
                      ///< fades
  Ramp lower_plate;   ///< metres: distances from the lid's edge over which the hold of the lower tarsal plate
                      ///< fades
  Ramp unfolding;  ///< metres: distances from the lid's edge over which skin unfolds from the crease when the
                   ///< lid closes
  Ramp crease;  ///< metres: distances from the lid's edge over which the hold of the levator's aponeurosis on
                ///< the skin fades
  double hold = 0.0;     ///< pascal per metre: stiffness per area with which the tarsal plates keep their
                         ///< position on the globe
  double closing = 0.0;  ///< rotation of the upper lid at lid_upper = 1 relative to the height of the
                         ///< fissure, before what is added for the resistance of the skin
  double opening =
      0.0;  ///< rotation of the upper lid at lid_upper = -1 relative to the height of the fissure
  double raising = 0.0;  ///< rotation of the lower lid at lid_lower = 1 relative to the height of the fissure
  double canthal_turn =
      0.0;  ///< radians: rotation added to the closing towards the inner canthus, where the skin resists most
  double canthal_outer_share = 0.0;  ///< rotation subtracted from the closing at the outer canthus, where the
                                     ///< skin resists less, relative to canthal_turn
  double upper_follows_up =
      0.0;  ///< rotation of the upper lid relative to the globe's pitch when it looks up
  double upper_follows_down =
      0.0;  ///< rotation of the upper lid relative to the globe's pitch when it looks down
  double lower_follows_up =
      0.0;  ///< rotation of the lower lid relative to the globe's pitch when it looks up
  double lower_follows_down =
      0.0;                   ///< rotation of the lower lid relative to the globe's pitch when it looks down
  double follows_yaw = 0.0;  ///< rotation of both lids relative to the globe's yaw
  double upper_drawn = 0.0;  ///< radians: rotation of the upper plate towards the nose at full contraction of
                             ///< the pretarsal muscle (Horner's part)
  double lower_drawn = 0.0;  ///< radians: rotation of the lower plate towards the nose at full contraction of
                             ///< the pretarsal muscle
  double cornea_radius_share = 0.0;  ///< radius of the cornea relative to that of the globe
  double cornea_crease_reach = 0.0;  ///< metres: distance from the lids' edge of the skin of the crease that
                                     ///< a closing lid brings in front of the cornea
  double cornea_crease_depth = 0.0;  ///< metres: greatest depth of the skin of the crease below the lid
                                     ///< around it, for which the lid is kept clear of the cornea
  double globe_radius_share =
      0.0;  ///< radius of the globe relative to the width of the fissure, for a head without eyeballs
  double globe_depth_share = 0.0;  ///< depth of the globe's centre behind the canthi relative to its radius,
                                   ///< for a head without eyeballs
  double cornea_apex_limit = 0.0;  ///< greatest distance of the apex from the centre, over the globe's radius
  double cornea_clearance = 0.0;   ///< metres: distance that lids keep from the cornea
};

/// Lips, and how they roll.
struct Lips {
  double softness_share = 0.0;  ///< stiffness of relaxed lips relative to that of the face around them
  Ramp softness_fade;  ///< metres: distances from the lips' edge over which the lips become as stiff as the
                       ///< face
  double lining_reach =
      0.0;  ///< metres: distance from the lips' edge within which lining belongs to the mouth
  double body_spread = 0.0;  ///< metres: distance beside a point of the lining within which the flesh between
                             ///< it and the outer skin is fastened to it
  double body_reach =
      0.0;  ///< metres: greatest thickness of a lip through which lining and outer skin are connected
  double gum_hold = 0.0;  ///< pascal: stiffness per length with which the gums hold the lining at its fold
  double roll_drive =
      0.0;         ///< pascal per metre: stiffness per area with which lips follow the rotation of their roll
  Ramp roll_fade;  ///< metres: distances from the lips' edge over which the roll fades
  Ramp roll_lateral_fade;   ///< distances from the midline, in half widths of the mouth, over which the roll
                            ///< fades
  double roll_depth = 0.0;  ///< metres: distance of the axis of roll above (lower lip
  double roll_in = 0.0;     ///< radians: rotation at lip_roll = 1
  double roll_out = 0.0;    ///< radians: rotation at lip_roll = -1
  double protrusion_height =
      0.0;  ///< metres: distance above the upper (below the lower) lip's edge of the axis about which a lip
            ///< swings forward when the peripheral part of the orbicularis oris contracts
  double protrusion_upper = 0.0;  ///< radians: forward rotation of the free upper lip at full contraction of
                                  ///< the peripheral part of its muscle
  double protrusion_lower = 0.0;  ///< radians: forward rotation of the free lower lip at full contraction of
                                  ///< the peripheral part of its muscle
  double protrusion_drive =
      0.0;  ///< pascal per metre: stiffness per area with which lips follow the rotation of protrusion
  Ramp protrusion_fade;        ///< metres: distances from the lips' edge over which the protrusion fades
  double side_blend = 0.0;     ///< metres: from the midline, over which the left half passes into the right
  double seal_hold = 0.0;      ///< newton per metre: of each side's lips together, at lip_seal = 1
  double seal_reach = 0.0;     ///< metres: from the lips' edge, of the tissue that the seal acts on
  double seal_shortest = 0.0;  ///< length, relative to rest, at which the pull of the seal vanishes
};

/// The vestibule of the mouth, where lips and cheeks lie on air and mucosa instead of bone.
struct Vestibule {
  Ramp
      back;  ///< position, from the corner of the mouth (0) to the tragion (1), over which the vestibule ends
  Ramp height;  ///< height over which the vestibule ends, relative to that of subnasale above the mouth and
                ///< that of the lower fold below it
  double lower_fold = 0.0;     ///< position of the lower fold between the mouth (0) and gnathion (1)
  double midline_blend = 0.0;  ///< half width of the blend between the left and the right half of the
                               ///< vestibule, in half widths of the mouth
  double pressure = 0.0;       ///< pascal: pressure of the air in the vestibule at buccal_pressure = 1
};

/// How muscle fibres pull on the tissue.
struct Fibres {
  double shortest_factor =
      0.0;  ///< shortening at which a muscle's force vanishes relative to its peak shortening
  double shortest_least = 0.0;  ///< least length, relative to rest, at which the force of any fibre vanishes
  double shortest_most =
      0.0;  ///< greatest length, relative to rest, at which the force of any fibre vanishes
  double insertion_spread = 0.0;  ///< metres: distance from a fibre's free end over which its tension rises
  double insertion_spread_share = 0.0;  ///< greatest distance over which a fibre's tension rises at a free
                                        ///< end, relative to the fibre's length
  double ring_spread_share = 0.0;       ///< distance over which a ring muscle that is attached to one bone
                                        ///< transmits its force to the skin, relative to its length
  double least_tension = 0.0;           ///< fraction of the tension that remains at a free end
  double deep_course = 0.0;    ///< metres: distance from the SMAS beyond which a fibre does not move with it,
                               ///< because its sheath holds it to the bone
  double midline_reach = 0.0;  ///< metres: distance from the midline within which a fibre that ends across it
                               ///< is held by its counterpart of the other side
  double orbit_reach = 0.0;    ///< metres: distance in front of the globe within which a fibre from behind it
                               ///< ends on the tarsal plate
  double lid_reach =
      0.0;  ///< metres: distance from the lids' edge within which fibres end on the tarsal plate
};

/// Muscles of the face: force, and where they lie.
struct Muscles {
  double stress = 0.0;           ///< pascal: tension at full activation and rest length per cross section
  double modiolus_radius = 0.0;  ///< metres: half width of the node beside the corner of the mouth
  double tissue_depth = 0.0;     ///< metres: greatest depth of tissue behind the SMAS where there is no bone
};

/// How retaining ligaments are attached.
struct Ligaments {
  double reach = 0.0;  ///< metres: distance from the simulated tissue beyond which a ligament is omitted
  double tuft = 0.0;   ///< metres: radius over which a ligament fans out under the skin
};

/// Depths of SMAS and inner layer where skull and SMAS do not determine them.
struct Depths {
  double bone_reach = 0.0;  ///< metres: depth under the skin within which bone is taken into account
  double rim_reach = 0.0;   ///< metres: distance beside a border of bone, as under the chin, within which it
                            ///< still supports tissue whose ray passes by it
  double rim_depth = 0.0;  ///< metres: depth at which a border of bone supports tissue whose ray passes by it
  double flesh_share =
      0.0;  ///< greatest fraction of the thickness of lips and cheeks taken up by skin and SMAS
  double smas_share = 0.0;  ///< depth of the SMAS relative to that of bone or mucosa, where none was built
  Ramp smas_limits;         ///< metres: least and greatest depth of the SMAS where none was built
  double smas_most_share = 0.0;  ///< greatest depth of the SMAS relative to that of bone or mucosa
  double lining_smas_share =
      0.0;  ///< depth of the submucosa under the lining relative to the thickness of the flesh
  double lining_smas_most = 0.0;  ///< metres: greatest depth of the submucosa under the lining
  double behind_smas = 0.0;       ///< metres: greatest thickness of the layer between SMAS and inner nodes
  double lining_share =
      0.0;                   ///< fraction of the thickness of the flesh taken up by the columns of the lining
  double lining_most = 0.0;  ///< metres: greatest thickness taken up by the columns of the lining
};

/// Which part of the face moves with the mandible.
struct JawInfluence {
  double spread = 0.0;  ///< metres: distance over which the influence changes from one bone to the other
  Ramp certain_ratio;   ///< ratios of the distances to the farther and the nearer bone between which the
                        ///< decision becomes certain
  Ramp bone_distance;   ///< metres: distances from bone over which its influence on the decision fades
  Ramp lip_fade;        ///< metres: distances from the lips' edge over which lip membership stops deciding
  Ramp lip_passage;  ///< positions on the way from the upper to the lower lip around the corner between which
                     ///< the influence rises from none to full
};

/// The simulated part of the head. In thirds of the face: the height from subnasale to glabella.
struct Region {
  double above_hairline = 0.0;  ///< distance of its upper border beyond the trichion
  double below_chin = 0.0;      ///< distance of its lower border below gnathion
  double before_ear = 0.0;      ///< distance of its rear border in front of the tragion
  double back_below_jaw = 0.0;  ///< distance by which its rear border lies farther back below the angle of
                                ///< the jaw, where the neck begins
  double jaw_angle = 0.0;       ///< distance below the tragion at which the rear border moves back
};

/// How the mandible moves at full value of its channels. Lengths are those of an adult and scale with the
/// head.
struct JawMotion {
  double open_angle = 0.0;          ///< radians: rotation at jaw_open = 1
  double open_forward = 0.0;        ///< metres: forward condylar glide at jaw_open = 1
  double open_down = 0.0;           ///< metres: downward condylar glide at jaw_open = 1
  double protrusion_forward = 0.0;  ///< metres: forward glide at jaw_forward = 1
  double protrusion_down = 0.0;     ///< metres: downward glide at jaw_forward = 1
  double lateral_angle = 0.0;       ///< radians: rotation about the vertical at jaw_lateral = 1
  double lateral_glide = 0.0;       ///< metres: glide to the same side at jaw_lateral = 1
  double travel_time = 0.0;  ///< seconds: shortest time in which a channel goes from 0 to 1, so that a step
                             ///< change does not tear the tissue
};

/// Which surfaces can touch, and how stiff their contact is.
struct Contact {
  double lip_reach =
      0.0;  ///< metres: distance from the lips' edge within which lips can touch each other and the teeth
  double lid_reach = 0.0;  ///< metres: distance from the lids' edge within which lids can touch each other
  double globe_stiffness =
      0.0;  ///< newton per metre: stiffness per node of contact between the lids and the eyeball
  double bone_stiffness = 0.0;  ///< newton per metre: stiffness per node of contact with bone and teeth
  double facing_stiffness =
      0.0;  ///< newton per metre: stiffness per node of contact between the lips and between the lids
  double thickness = 0.0;         ///< metres: margin kept between skin and bone and between the lips
  double lid_thickness = 0.0;     ///< metres: margin kept between the lids
  double friction = 0.0;          ///< Coulomb's coefficient of friction of moist mucosa and skin
  double sticky_reach = 0.0;      ///< metres: gap at which lips that stick together part, at full stickiness
  double sticky_stiffness = 0.0;  ///< newton per metre: stiffness per node of the adhesion of lips that stick
                                  ///< together, at full stickiness
  double lip_range_before = 0.0;  ///< metres: distance in front of a lip's surface within which the other lip
                                  ///< can be in contact with it
  double lip_range_behind =
      0.0;  ///< metres: depth behind a lip's surface within which the other lip can be in contact with it
  double lip_range_beside =
      0.0;  ///< metres: distance beside a lip's surface within which the other lip can be in contact with it
  double lid_range_before = 0.0;  ///< metres: distance in front of a lid's surface within which the other lid
                                  ///< can be in contact with it
  double lid_range_behind =
      0.0;  ///< metres: depth behind a lid's surface within which the other lid can be in contact with it
  double lid_range_beside =
      0.0;  ///< metres: distance beside a lid's surface within which the other lid can be in contact with it
};

/// How tissue and muscles respond in time, and how a muscle's force depends on its activation.
struct Dynamics {
  double stiffness_damping = 0.0;  ///< seconds: damping force over elastic force, for equal rates of strain
                                   ///< and strain (Rayleigh damping)
  double mass_damping = 0.0;       ///< per second: damping force over momentum (Rayleigh damping)
  double activation_rise =
      0.0;  ///< seconds: time constant with which a muscle's activation rises to its excitation
  double activation_decay =
      0.0;  ///< seconds: time constant with which a muscle's activation falls to its excitation
  double initial_force_slope =
      0.0;  ///< slope of a muscle's relative force over activation at zero activation
};

/// Extent and depth of the SMAS. Lengths are those of an adult and scale with the face.
struct SmasShape {
  double adult_width =
      0.0;  ///< metres: distance between the outer canthi of the adult face to which lengths refer
  double adult_height = 0.0;  ///< metres: distance from between the outer canthi to gnathion of the adult
                              ///< face to which lengths refer
  double galea = 0.0;         ///< position of the upper end along the midline from trichion (0) to vertex (1)
  double neck =
      0.0;  ///< metres: distance below the angle of chin and neck to which the SMAS follows the platysma
  double ear_gap = 0.0;         ///< metres: distance in front of the ear at which the SMAS ends
  double lid_margin = 0.0;      ///< metres: width of the gap in the SMAS around the fissure of the lids
  double lip_part = 0.0;        ///< fraction of the vermilion, from the line between the lips, without SMAS
  double lip_corner = 0.0;      ///< metres: distance beyond the corners of the mouth without SMAS
  double nostril_width = 0.0;   ///< half width of the opening under the nose beyond the centres of the
                                ///< nostrils, in lengths of both nostrils
  double nostril_height = 0.0;  ///< half height of the opening under the nose, in lengths of both nostrils
  double region_blend =
      0.0;                 ///< metres: distance over which the depths at the sites of tissue.json are blended
  Ramp depth_limits;       ///< least and greatest depth of the SMAS relative to that of bone
  double clearance = 0.0;  ///< metres: distance kept to skin and bone where there is room
};

}  // namespace mechanics

struct Mechanics {
  mechanics::Tissue tissue;
  mechanics::Skin skin;
  mechanics::Smas smas;
  mechanics::Fat fat;
  mechanics::Glide glide;
  mechanics::Attachment attachment;
  mechanics::Lids lids;
  mechanics::Lips lips;
  mechanics::Vestibule vestibule;
  mechanics::Fibres fibres;
  mechanics::Muscles muscles;
  mechanics::Ligaments ligaments;
  mechanics::Depths depths;
  mechanics::JawInfluence jaw_influence;
  mechanics::Region region;
  mechanics::JawMotion jaw;
  mechanics::Contact contact;
  mechanics::Dynamics dynamics;
  mechanics::SmasShape smas_shape;
  std::vector<AttachmentRegion> attachment_regions;
  std::vector<Hold> holds;
};

}  // namespace fascia::anatomy

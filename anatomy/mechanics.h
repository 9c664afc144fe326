#pragma once

#include <string>
#include <vector>

#include "anatomy/side.h"
#include "geometry/mesh.h"
#include "geometry/smoothstep.h"

/// The constants of tissue, attachment, contact, jaw and lids: anatomy/data/mechanics.json in metres, radians
/// and pascal. The file gives the unit, range and source of each. Nothing here has a default.
namespace fascia::anatomy {

/// The interval of a transition, begin < end.
struct Ramp {
  double begin = 0.0, end = 0.0;
  /// 0 up to `begin`, 1 from `end` on, smooth between.
  double rise(double x) const { return smoothstep(begin, end, x); }
  /// 1 up to `begin`, 0 from `end` on.
  double fall(double x) const { return 1.0 - smoothstep(begin, end, x); }
};

/// A location on any face, given by its landmarks: their weighted sum per coordinate, and an offset.
struct FacePlace {
  struct Part {
    std::string landmark;  ///< on the skin, by full name
    Vec3 share;            ///< of its x, y and z
  };
  std::vector<Part> parts;
  Vec3 offset = Vec3::Zero();  ///< in thirds of the face: the height from subnasale to glabella
  double radius = 0.0;         ///< thirds of the face, over which its effect falls to 1/e
};

/// A firmly attached or gliding region of the face.
struct AttachmentRegion {
  std::string name;  ///< with its side
  FacePlace place;
  double bone = 1.0;  ///< factor of the attachment of the SMAS to bone
  double skin = 1.0;  ///< factor of the attachment of the SMAS to the skin
};

/// Additional attachment to the skull by cartilage, frenula and the mentalis.
struct Hold {
  std::string name;
  FacePlace place;
  double factor = 1.0;  ///< of the attachment to bone at its centre
};

namespace mechanics {

/// What holds for all soft tissue.
struct Tissue {
  double density = 0.0;        ///< kilogram per cubic metre: mass a volume
  double poisson_ratio = 0.0;  ///< of skin and SMAS in their plane
  double bending_factor =
      0.0;  ///< bending stiffness over that of a thin plate: the layers are stiffened by fat and retinacula
  double volume_modulus =
      0.0;  ///< pascal: between skin and SMAS: what a change of volume is resisted with. Tissue is nearly
            ///< incompressible; the figure is as low as keeps volume within some percent
  double inner_volume_modulus =
      0.0;  ///< pascal: the same between SMAS and what lies behind: fat that may flow aside
  double inner_layer_thickness = 0.0;  ///< metres: of the tissue whose mass the innermost nodes bear
  double limit_strain = 0.0;           ///< at which retinacula, wavy at rest, are straight
  double stiffening = 0.0;             ///< stiffness of retinacula beyond the limit strain over that below it
};

/// Skin, and the mucosa it turns into.
struct Skin {
  double young_modulus = 0.0;  ///< pascal: at small strain
  double thickness = 0.0;      ///< metres: of the facial skin
  double mucosa_stretch_share =
      0.0;  ///< membrane stiffness of the lips' and lids' lining over that of skin: thinner and softer
  double mucosa_bending_share = 0.0;  ///< the same for bending
};

/// The SMAS as a membrane.
struct Smas {
  double young_modulus = 0.0;  ///< pascal: at rest
  double thickness = 0.0;      ///< metres: of fascia and muscle together
  double submucosa_stretch_share =
      0.0;  ///< membrane stiffness behind the lips' and lids' lining, where there is no SMAS, over the SMAS's
  double submucosa_bending_share = 0.0;  ///< the same for bending
};

/// Fat with the retinacula in it: between skin and SMAS, and between SMAS and mucosa.
struct Fat {
  double across_modulus =
      0.0;  ///< pascal: Young's, across the layer between skin and SMAS, retinacula included
  double shear_modulus =
      0.0;  ///< pascal: of that layer where the SMAS is attached to the skin at mean strength
  double deep_across_share = 0.0;    ///< modulus between SMAS and mucosa over the one between skin and SMAS
  double deep_shear_share = 0.0;     ///< shear modulus likewise
  double lining_volume_share = 0.0;  ///< volume modulus in the lips' and lids' lining over that elsewhere
};

/// The plane between SMAS and bone, in which the SMAS glides.
struct Glide {
  double shear_modulus = 0.0;   ///< pascal: at mean attachment
  double normal_modulus = 0.0;  ///< pascal: across it: bone lets nothing sink, what lies on air may give
  double least_depth = 0.0;     ///< metres: thinner planes shear and press as if they were so deep
  double pressing_depth = 0.0;  ///< metres: deeper planes press as if they were so deep: bone bears what
                                ///< presses on it through whatever depth
};

/// How gliding zones, lips, lids and the mouth's vestibule change the hold of bone on the SMAS. Factors of
/// the gliding plane's moduli.
struct Attachment {
  double free_factor = 0.0;  ///< where a gliding plane is widest
  double firm_factor = 0.0;  ///< where nothing glides
  double zone_share = 0.0;   ///< weight of tissue.json's gliding zones against the attachment regions below
  Ramp lip_fade;  ///< metres: from the lips' edge over which the hold of bone comes in: lips hang on no bone
  double lip_share = 0.0;  ///< what is left of it at the lips' edge
  Ramp lid_fade;           ///< metres: from the lids' edge likewise: lids are held by their plates
  double lid_share = 0.0;  ///< what is left of it at the lids' edge
  Ramp air_depth;  ///< metres: depth to bone over which flesh before the vestibule turns from lying on bone
                   ///< to lying on mucosa and air
  double air_shear_loss = 0.0;   ///< share of the hold lost over air, along the plane
  double air_normal_loss = 0.0;  ///< and across it
};

/// Eyelids: thin skin, tarsal plates that go with the globe.
struct Lids {
  double softness_share = 0.0;  ///< stiffness of the lids' skin over that of the face: the thinnest skin of
                                ///< the body, some 0.5 mm, and loose
  Ramp softness_fade;           ///< metres: from the lids' edge over which skin becomes that of the face
  double reach = 0.0;           ///< metres: from the lids' edge: what may lie on the globe
  Ramp canthal_fade;  ///< place along the fissure, 0 at a canthus and in widths of the fissure, over which a
                      ///< plate begins
  Ramp upper_plate;   ///< metres: from the edge over which the upper plate's hold fades
  Ramp lower_plate;   ///< metres: from the edge over which the lower plate's hold fades
  Ramp unfolding;  ///< metres: from the edge over which skin that the closing lid takes down unfolds from the
                   ///< crease
  Ramp crease;     ///< metres: from the edge over which the levator's aponeurosis stops holding the skin
  double hold =
      0.0;  ///< pascal per metre: stiffness an area with which the plates keep their place on the globe
  double closing = 0.0;  ///< turn of the upper lid at lid_upper = 1 over the fissure's height; what the
                         ///< skin's resistance takes is added
  double opening = 0.0;  ///< turn at lid_upper = -1 over that: the levator lifts the lid some 3 mm above rest
  double raising = 0.0;  ///< turn of the lower lid at lid_lower = 1 over the fissure's height
  double canthal_turn =
      0.0;  ///< radians: added to the closing towards the inner canthus, where skin resists most
  double canthal_outer_share = 0.0;  ///< what is subtracted at the outer canthus, relative to canthal_turn
  double upper_follows_up = 0.0;  ///< turn of the upper lid with the globe's pitch above the primary position
  double upper_follows_down = 0.0;  ///< the same below it
  double lower_follows_up = 0.0;    ///< turn of the lower lid with the globe's pitch above it
  double lower_follows_down = 0.0;  ///< the same below it
  double follows_yaw = 0.0;  ///< turn of both lids with the globe's yaw: the cornea's bulge takes them along
  double upper_drawn = 0.0;  ///< radians: turn of the upper plate towards the nose at full contraction of the
                             ///< pretarsal muscle (Horner's part)
  double lower_drawn = 0.0;  ///< radians: the same of the lower plate
  double cornea_radius_share = 0.0;  ///< radius of the cornea over that of the globe
  double cornea_crease_reach =
      0.0;  ///< metres: from the edge, of skin that comes to lie in front of the cornea
  double cornea_crease_depth = 0.0;  ///< metres: greatest depth of that skin below the lid around it
  double globe_radius_share =
      0.0;  ///< radius of the globe over the fissure's width, for a head without eyeballs
  double globe_depth_share = 0.0;  ///< how far its centre lies behind the canthi, over its radius
};

/// Lips, and how they roll.
struct Lips {
  double softness_share = 0.0;  ///< stiffness of relaxed lips over that of the face around them
  Ramp softness_fade;           ///< metres: from the lips' edge over which they become as stiff as the face
  double lining_reach =
      0.0;  ///< metres: from the lips' edge: what is the mouth's lining rather than another's
  double body_spread = 0.0;  ///< metres: beside a place of the lining where the flesh between it and the
                             ///< outer skin is fastened
  double body_reach = 0.0;   ///< metres: how far that flesh reaches through the lip
  double gum_hold = 0.0;     ///< pascal: stiffness a length with which the gums hold the lining at its fold
  double roll_drive = 0.0;   ///< pascal per metre: stiffness an area with which lips follow their roll
  Ramp roll_fade;  ///< metres: from the lips' edge over which the roll fades: the vermilion turns, the white
                   ///< lip stays
  Ramp roll_lateral_fade;   ///< from the midline over which it fades, in half widths of the mouth
  double roll_depth = 0.0;  ///< metres: of the axis of roll: above (below) the edge and behind it
  double roll_in = 0.0;     ///< radians: turn at lip_roll = 1
  double roll_out = 0.0;    ///< radians: turn at lip_roll = -1
  double protrusion_height =
      0.0;  ///< metres: of the axis a protruding lip swings about, above (below) its edge
  double protrusion_upper =
      0.0;  ///< radians: swing of the upper lip at full contraction of its peripheral part
  double protrusion_lower = 0.0;  ///< radians: of the lower
  double protrusion_drive = 0.0;  ///< pascal per metre: stiffness an area with which lips follow that swing
  Ramp protrusion_fade;  ///< metres: from the lips' edge over which it fades: the white lip comes along
};

/// The vestibule of the mouth: where lips and cheeks lie on air and mucosa instead of bone.
struct Vestibule {
  Ramp back;    ///< from the corner of the mouth to the tragion: where it ends, at the masseter's front edge
  Ramp height;  ///< from the mouth to its folds, in the height of subnasale above it and of the lower fold
                ///< below it: where it ends
  double lower_fold = 0.0;  ///< depth of the lower fold, on the way from the mouth to gnathion
  double midline_blend =
      0.0;  ///< half width of the blend between its left and right half, in half widths of the mouth
  double pressure = 0.0;  ///< pascal: of the air in it at buccal_pressure = 1
};

/// How muscle fibres pull on the tissue.
struct Fibres {
  double shortest_factor =
      0.0;  ///< the pull has fallen to nothing at this multiple of the muscle's peak shortening
  double shortest_least = 0.0;    ///< least length, relative to rest, at which the pull of any fibre ends
  double shortest_most = 0.0;     ///< greatest such length
  double insertion_spread = 0.0;  ///< metres: over which a fibre's pull comes in at its free end
  double insertion_spread_share = 0.0;  ///< of its length at most
  double ring_spread_share =
      0.0;  ///< of its length, over which a ring that hangs on one bone gives its pull to the skin
  double least_tension = 0.0;  ///< share of the tension that is left at a free end
  double deep_course = 0.0;  ///< metres: from the SMAS, beyond which a fibre does not go with it: its sheath
                             ///< holds it by the bone
  double midline_reach = 0.0;  ///< metres: from the midline within which a fibre that ends across it is held
                               ///< by its fellow of the other side
  double orbit_reach =
      0.0;  ///< metres: before the globe within which a fibre from behind it ends on the tarsal plate
  double lid_reach = 0.0;  ///< metres: from the lids' edge, on which such fibres are laid
};

/// How retaining ligaments are fastened.
struct Ligaments {
  double reach = 0.0;  ///< metres: farther from the simulated tissue they are left out
  double tuft = 0.0;   ///< metres: radius over which one fans out under the skin
};

/// Depths of SMAS and inner layer, where skull and SMAS do not tell them.
struct Depths {
  double bone_reach = 0.0;  ///< metres: under the skin, within which bone counts
  double rim_reach = 0.0;   ///< metres: beside which a border of bone, as under the chin, still supports what
                            ///< a ray passes by it
  double rim_depth = 0.0;   ///< metres: depth at which it does
  double flesh_share =
      0.0;  ///< of the thickness of lips and cheeks that skin and SMAS may take up, the rest being mucosa
  double smas_share = 0.0;         ///< of the way to bone or mucosa: depth of the SMAS where none was built
  Ramp smas_limits;                ///< metres: least and greatest of that depth
  double smas_most_share = 0.0;    ///< of the way to bone or mucosa: greatest depth of the SMAS
  double lining_smas_share = 0.0;  ///< of the flesh: depth of the submucosa under the lining
  double lining_smas_most = 0.0;   ///< metres: and its greatest depth
  double behind_smas = 0.0;        ///< metres: greatest thickness of what lies between SMAS and inner layer
  double lining_share = 0.0;       ///< of the flesh that the lining's columns take up
  double lining_most = 0.0;        ///< metres: and at most
};

/// Which part of the face goes with the mandible.
struct JawInfluence {
  double spread = 0.0;  ///< metres: over which it goes from one bone to the other
  Ramp certain_ratio;   ///< distance to the farther bone over that to the nearer: undecided, decided
  Ramp bone_distance;   ///< metres: from bone over which it has no more say
  Ramp lip_fade;  ///< metres: from the lips' edge within which the lip decides instead of the bones: the rows
                  ///< of teeth lie too near each other
  Ramp lip_passage;  ///< from upper to lower lip around the corner: where the influence begins and is whole
};

/// What of the head is simulated. In thirds of the face: the height from subnasale to glabella.
struct Region {
  double above_hairline = 0.0;  ///< how far it goes beyond the trichion
  double below_chin = 0.0;      ///< how far it goes below gnathion
  double before_ear = 0.0;      ///< how far before the tragion it ends
  double back_below_jaw =
      0.0;                 ///< how much farther back it ends below the jaw's angle, where the neck turns away
  double jaw_angle = 0.0;  ///< how far below the tragion that begins
};

/// How the mandible moves at full value of its channels. Lengths are an adult's and scale with the head.
struct JawMotion {
  double open_angle = 0.0;          ///< radians: turn at jaw_open = 1
  double open_forward = 0.0;        ///< metres: condylar glide forward at jaw_open = 1
  double open_down = 0.0;           ///< metres: condylar glide down at jaw_open = 1
  double protrusion_forward = 0.0;  ///< metres: at jaw_forward = 1
  double protrusion_down = 0.0;     ///< metres: at jaw_forward = 1
  double lateral_angle = 0.0;       ///< radians: turn about the vertical at jaw_lateral = 1
  double lateral_glide = 0.0;       ///< metres: to the same side at jaw_lateral = 1
};

/// What touches what, and how hard it resists.
struct Contact {
  double lip_reach = 0.0;  ///< metres: from their edge within which lips meet each other and the teeth
  double lid_reach = 0.0;  ///< metres: from their edge within which lids meet each other
};

/// How far the SMAS goes and where it lies. Lengths are an adult's and scale with the face.
struct SmasShape {
  double adult_width = 0.0;   ///< metres: between the outer canthi of the adult whose lengths these are
  double adult_height = 0.0;  ///< metres: from between the outer canthi to gnathion of that adult
  double galea = 0.0;  ///< upper end along the midline from trichion, 0, to vertex, 1: the frontalis ends in
                       ///< the galea behind the hairline
  double neck = 0.0;   ///< metres: how far below the angle of chin and neck it follows the platysma
  double ear_gap = 0.0;         ///< metres: how far before the ear it ends
  double lid_margin = 0.0;      ///< metres: how far around the fissure of the lids it stays open
  double lip_part = 0.0;        ///< how much of the vermilion, from the line between the lips, it stays open
  double lip_corner = 0.0;      ///< metres: how far beyond the corners of the mouth
  double nostril_width = 0.0;   ///< half width of the opening under the nose beyond the nostrils' centres, in
                                ///< lengths of both nostrils
  double nostril_height = 0.0;  ///< its half height, likewise
  double region_blend = 0.0;  ///< metres: over which the depths of tissue.json's sites blend into each other
  Ramp depth_limits;          ///< least and greatest depth on the way from skin to bone
  double clearance = 0.0;     ///< metres: kept to skin and bone where there is room
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
  mechanics::Ligaments ligaments;
  mechanics::Depths depths;
  mechanics::JawInfluence jaw_influence;
  mechanics::Region region;
  mechanics::JawMotion jaw;
  mechanics::Contact contact;
  mechanics::SmasShape smas_shape;
  std::vector<AttachmentRegion> attachment_regions;
  std::vector<Hold> holds;
};

}  // namespace fascia::anatomy

#pragma once

#include "builder/tissue/columns.h"

namespace fascia::tissue {

/// Index of the channel `name`, or -1.
int channel_index(const std::vector<rig::Channel>& channels, const std::string& name);

/// Binds each muscle's fibres to the level's SMAS nodes. A muscle without a channel is omitted.
void add_fibres(const TissueInputs& inputs, const Columns& columns, rig::TissueLevel& level);

/// Rotation of the lids about the globe: `lid_upper_<side>` closes from 0 to 1 (below 0 it opens wider),
/// `lid_lower_<side>` raises the lower lid, `eye_pitch_<side>` moves both lids; and the globes for contact.
void add_lids(const TissueInputs& inputs, const FaceRegion& region, const Columns& columns,
              rig::TissueLevel& level);

/// Air in the mouth: `buccal_pressure_<side>` on its half of the
/// vestibule, behind cheek and lips.
void add_pressures(const TissueInputs& inputs, const Columns& columns, rig::TissueLevel& level);

/// Lips rolled over the teeth (`lip_roll_upper_<side>`, `lip_roll_lower_<side>` above 0) or turned out (below
/// 0), and swung forward by the peripheral part of the orbicularis oris (`orbicularis_oris_peripheral_...`).
void add_lip_turns(const TissueInputs& inputs, const FaceRegion& region, const Beneath& beneath,
                   const Columns& columns, rig::TissueLevel& level);

/// Sealing of the lips (`lip_seal_<side>`): strands from the edge of one lip to that of the other, modelled
/// as fibres of the marginal orbicularis oris.
void add_lip_seal(const TissueInputs& inputs, const Columns& columns, rig::TissueLevel& level);

/// Retaining ligaments from bone through the fascia to the skin: springs that only resist being stretched.
void add_ligaments(const TissueInputs& inputs, const Columns& columns, rig::TissueLevel& level);

/// Distance fields of the bones with their teeth, and which nodes may touch them.
void add_contact(const TissueInputs& inputs, const Columns& columns, rig::TissueLevel& level);

/// Contact pairs between lips and between lids.
void add_facing(const TissueInputs& inputs, const FaceRegion& region, const Columns& columns,
                rig::TissueLevel& level);

}  // namespace fascia::tissue

#include "bench/actuators/expected.h"

namespace fascia::bench {

const std::vector<Expectation>& expectations() {
  static const std::vector<Expectation> all = {
      {"frontalis_medial", 1, "superciliare_mediale_left", {0, 1, 0}, 2, 9},
      {"frontalis_lateral", 1, "superciliare_laterale_left", {0, 1, 0}, 2, 9},
      {"procerus", 1, "glabella", {0, -1, 0}, 1, 6},
      {"corrugator_supercilii_transverse", 1, "superciliare_mediale_left", {-1, -0.2, 0}, 1, 6},
      {"corrugator_supercilii_oblique", 1, "superciliare_mediale_left", {-0.4, -1, 0}, 1, 6},
      {"depressor_supercilii", 1, "superciliare_mediale_left", {0, -1, 0}, 0.7, 5},
      {"orbicularis_oculi_pretarsal_upper", 1, "palpebrale_superius_left", {0, -1, 0}, 0.3, 6},
      {"orbicularis_oculi_pretarsal_lower", 1, "palpebrale_inferius_left", {0, 1, 0}, 0.1, 3},
      {"orbicularis_oculi_preseptal_upper", 1, "sulcus_palpebralis_superior_left", {0, -1, 0}, 0.3, 5},
      {"orbicularis_oculi_preseptal_lower", 1, "orbitale_left", {0, 1, 0}, 0.2, 5},
      {"orbicularis_oculi_orbital_upper", 1, "superciliare_left", {0, -1, 0}, 0.7, 6},
      {"orbicularis_oculi_orbital_lower", 1, "zygomaxillare_skin_left", {0, 1, 0}, 0.7, 6},
      {"orbicularis_oculi_malar", 1, "malare_left", {0, 1, 0}, 2, 10},
      {"levator_palpebrae_superioris", 1, "palpebrale_superius_left", {0, 1, 0}, 0.5, 4},
      // Slung over the nose from side to side, the two press the skin beside the ala onto it: against the
      // outward normal of the groove.
      {"both:nasalis_transverse", 1, "alar_groove_left", {-0.83, -0.19, -0.53}, 0.2, 3},
      {"nasalis_alar", 1, "alare_left", {0.6, -1, 0}, 0.2, 3},
      {"depressor_septi_nasi", 1, "subnasale", {0, -1, 0}, 0.3, 3},
      {"levator_labii_superioris_alaeque_nasi_alar", 1, "alare_left", {0, 1, 0}, 1, 6},
      {"levator_labii_superioris_alaeque_nasi_labial", 1, "crista_philtri_left", {0, 1, 0}, 1, 7},
      {"levator_labii_superioris_medial", 1, "labiale_superius_laterale_left", {0, 1, 0}, 1.5, 8},
      {"levator_labii_superioris_lateral", 1, "labiale_superius_laterale_left", {0, 1, 0}, 1.5, 8},
      {"zygomaticus_minor", 1, "labiale_superius_laterale_left", {0.5, 1, 0}, 1, 7},
      {"zygomaticus_major_superior", 1, "cheilion_left", {0.7, 1, 0}, 3, 12},
      {"zygomaticus_major_inferior", 1, "cheilion_left", {0.8, 1, 0}, 2, 12},
      {"zygomaticus_major", 1, "cheilion_left", {0.7, 1, 0}, 6, 14},
      {"levator_anguli_oris", 1, "cheilion_left", {-0.1, 1, 0}, 2, 9},
      {"incisivus_labii_superioris", 1, "cheilion_left", {-1, 0.2, 0}, 0.5, 6},
      {"risorius", 1, "cheilion_left", {1, 0, -0.3}, 1, 8},
      {"buccinator_upper", 1, "cheilion_left", {1, 0, -0.6}, 1, 8},
      {"buccinator_lower", 1, "cheilion_left", {1, 0, -0.6}, 1, 8},
      {"orbicularis_oris_marginal_upper", 1, "cheilion_left", {-1, 0, 0}, 0.5, 7},
      {"orbicularis_oris_peripheral_upper", 1, "cheilion_left", {-1, 0, 0}, 0.5, 7},
      {"orbicularis_oris_marginal_lower", 1, "cheilion_left", {-1, 0, 0}, 0.5, 7},
      {"orbicularis_oris_peripheral_lower", 1, "cheilion_left", {-1, 0, 0}, 0.5, 7},
      // Thinner from front to back, the lip grows taller: lips press against each other (action unit 24).
      {"compressor_labii_upper", 1, "labiale_superius_laterale_left", {0, -1, -0.5}, 0.2, 4},
      {"compressor_labii_lower", 1, "labiale_inferius_laterale_left", {0, 1, -0.5}, 0.2, 4},
      {"depressor_labii_inferioris_medial", 1, "labiale_inferius_laterale_left", {0.2, -1, 0}, 1.5, 8},
      {"depressor_labii_inferioris_lateral", 1, "labiale_inferius_laterale_left", {0.2, -1, 0}, 1.5, 8},
      {"depressor_anguli_oris", 1, "cheilion_left", {0.2, -1, 0}, 3, 11},
      {"mentalis", 1, "sublabiale", {0, 1, 0.3}, 0.7, 7},
      {"incisivus_labii_inferioris", 1, "cheilion_left", {-1, -0.2, 0}, 0.5, 6},
      {"platysma_labial", 1, "labiale_inferius_laterale_left", {0.4, -1, -0.3}, 1, 9},
      {"platysma_modiolar", 1, "cheilion_left", {0.5, -1, -0.3}, 1.5, 10},
      {"jaw_open", 1, "gnathion", {0, -1, -0.5}, 25, 60},
      {"jaw_forward", 1, "gnathion", {0, 0, 1}, 4, 10},
      {"jaw_lateral", 1, "gnathion", {1, 0, 0}, 5, 14},
      {"lid_upper", 1, "palpebrale_superius_left", {0, -1, 0}, 6, 14},
      {"lid_upper", -1, "palpebrale_superius_left", {0, 1, 0}, 1, 4},
      {"lid_lower", 1, "palpebrale_inferius_left", {0, 1, 0}, 1, 5},
      {"lid_lower", -1, "palpebrale_inferius_left", {0, -1, 0}, 0.5, 4},
      {"lip_roll_upper", 1, "labiale_superius_laterale_left", {0, -0.6, -1}, 2, 9},
      {"lip_roll_upper", -1, "labiale_superius_laterale_left", {0, 0.6, 1}, 1, 7},
      {"lip_roll_lower", 1, "labiale_inferius_laterale_left", {0, 0.6, -1}, 2, 9},
      {"lip_roll_lower", -1, "labiale_inferius_laterale_left", {0, -0.6, 1}, 1, 7},
      {"buccal_pressure", 1, "buccale_left", {1, 0, 0.3}, 4, 16},
      {"buccal_pressure", -0.4, "buccale_left", {-1, 0, -0.3}, 2, 12},
  };
  return all;
}

}  // namespace fascia::bench

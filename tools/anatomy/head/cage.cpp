#include "tools/anatomy/head/layout.h"

// The layout of the left half. Rings run around the eye (E), the nostril (O), the ear (A) and the mouth: M
// just outside the vermilion, N inside the nasolabial fold, Q outside it, K from the infraorbital cheek along
// the jaw, W the oval of the face. H is the row above the brow, C the rows over the cranium (row, column from
// the midline), Z their lateral ends around the ear, V the rows of the neck.

namespace fascia::head_maker {

std::vector<CageNode> cage_nodes() {
  return {
      // midline of the face
      {"glabella", {0, 60, 108}, true},
      {"nasion", {0, 37.4, 107.3}, true},
      {"rhinion", {0, 19, 121}, true},
      {"pronasale", {0, 3.5, 130.7}, true},
      {"subnasale", {0, -12, 115.7}, true},
      // side of the nose, alar groove
      {"L2", {14.5, 18, 104}, true},
      {"L3", {15.5, 7.0, 108.5}, true},
      {"L5", {16.5, -9.0, 105.0}, true},
      // inside the nasolabial fold
      {"N2", {32, -20, 102}, true},
      {"N3", {39, -37, 94}, true},
      {"N4", {32, -54, 95}, true},
      {"N5", {17, -60, 105}, true},
      {"N6", {0, -56.5, 108.5}, true},
      // outside it
      {"Q2", {33, -6, 101}, false},
      {"Q3", {48, -28, 87}, false},
      {"Q4", {43, -60, 80}, false},
      {"Q5", {20, -72, 98}, false},
      {"Q6", {0, -69, 110}, true},
      // infraorbital cheek, zygoma, jaw line
      {"K1", {25, 9, 98}, false},
      {"K2", {54, 4, 83}, true},
      {"K3", {57, -46, 60}, false},
      {"K4", {31, -75, 80}, false},
      {"K5", {0, -79.5, 96}, true},
      // oval of the face
      {"Wt", {67, 60, 60}, false},
      {"Wa", {73, 33, 42}, false},
      {"Wb", {72, 0, 40}, false},
      {"Wc", {62, -48, 22}, false},
      {"Wd", {35, -79, 48}, false},
      {"Wm", {0, -84, 74}, false},
      // forehead
      {"H0", {0, 84, 101}, false},
      {"H1", {22, 84, 98}, false},
      {"H2", {41, 82, 87}, false},
      {"H3", {56, 79, 72}, false},
      {"Z0", {67, 78, 52}, false},
      // cranium: rows 1 to 4
      {"C10", {0, 118, 78}, false},
      {"C11", {25, 116, 72}, false},
      {"C12", {45, 110, 61}, false},
      {"C13", {62, 99, 46}, false},
      {"Z1", {73, 82, 26}, false},
      {"C20", {0, 140, 36}, false},
      {"C21", {27, 138, 34}, false},
      {"C22", {50, 127, 24}, false},
      {"C23", {67, 108, 10}, false},
      {"Z2", {77, 78, -6}, false},
      {"C30", {0, 142, -18}, false},
      {"C31", {28, 138, -20}, false},
      {"C32", {51, 122, -28}, false},
      {"C33", {65, 98, -32}, false},
      {"Z3", {73, 62, -36}, false},
      {"C40", {0, 108, -72}, false},
      {"C41", {25, 103, -73}, false},
      {"C42", {46, 88, -66}, false},
      {"C43", {60, 62, -60}, false},
      {"Z4", {66, 28, -50}, false},
      {"C50", {0, 30, -84}, false},
      {"C51", {18, 22, -80}, false},
      {"C52", {34, 12, -70}, false},
      {"C53", {47, 0, -56}, false},
      {"Z5", {56, -18, -38}, false},
      // neck, two rows
      {"V0", {0, -95, 56}, false},
      {"V1", {30, -92, 42}, false},
      {"V2", {52, -80, 16}, false},
      {"V3", {56, -68, -6}, false},
      {"V4", {51, -58, -25}, false},
      {"V5", {43, -52, -36}, false},
      {"V6", {33, -46, -44}, false},
      {"V7", {22, -40, -52}, false},
      {"V8", {11, -36, -57}, false},
      {"V9", {0, -34, -58}, false},
      {"U0", {0, -122, 43}, false},
      {"U1", {30, -119, 33}, false},
      {"U2", {56, -114, 10}, false},
      {"U3", {68, -110, -14}, false},
      {"U4", {69, -107, -35}, false},
      {"U5", {60, -104, -50}, false},
      {"U6", {45, -102, -58}, false},
      {"U7", {30, -100, -64}, false},
      {"U8", {15, -99, -67}, false},
      {"U9", {0, -98, -68}, false},
  };
}

std::vector<CagePatch> cage_patches() {
  std::vector<CagePatch> patches = {
      // nose: around the nostril, then up the dorsum
      {{"O3", "O0", "pronasale", "subnasale"}, "nose"},
      {{"O0", "O1", "L3", "pronasale"}, "nose"},
      {{"O1", "O2", "L5", "L3"}, "nose"},
      {{"O2", "O3", "subnasale", "L5"}, "nose"},
      {{"pronasale", "L3", "L2", "rhinion"}, "nose"},
      {{"rhinion", "L2", "E0", "nasion"}, "nose"},
      {{"nasion", "E0", "E1", "glabella"}, "nose"},
      // around the mouth
      {{"M0", "M1", "L5", "subnasale"}, "perioral"},
      {{"M1", "M2", "N2", "L5"}, "perioral"},
      {{"M2", "M3", "N3", "N2"}, "perioral"},
      {{"M3", "M4", "N4", "N3"}, "perioral"},
      {{"M4", "M5", "N5", "N4"}, "perioral"},
      {{"M5", "M6", "N6", "N5"}, "perioral"},
      // across the nasolabial fold
      {{"L5", "N2", "Q2", "L3"}, "cheek"},
      {{"N2", "N3", "Q3", "Q2"}, "cheek"},
      {{"N3", "N4", "Q4", "Q3"}, "cheek"},
      {{"N4", "N5", "Q5", "Q4"}, "chin"},
      {{"N5", "N6", "Q6", "Q5"}, "chin"},
      // cheek and jaw line
      {{"L3", "Q2", "K1", "L2"}, "cheek"},
      {{"Q2", "Q3", "K2", "K1"}, "cheek"},
      {{"Q3", "Q4", "K3", "K2"}, "cheek"},
      {{"Q4", "Q5", "K4", "K3"}, "cheek"},
      {{"Q5", "Q6", "K5", "K4"}, "chin"},
      // under and beside the eye
      {{"L2", "K1", "E7", "E0"}, "cheek"},
      {{"K1", "K2", "E6", "E7"}, "cheek"},
      {{"K2", "Wb", "E5", "E6"}, "cheek"},
      {{"Wb", "Wa", "E4", "E5"}, "temple"},
      {{"Wa", "Wt", "E3", "E4"}, "temple"},
      {{"K2", "K3", "Wc", "Wb"}, "cheek"},
      {{"K3", "K4", "Wd", "Wc"}, "submental"},
      {{"K4", "K5", "Wm", "Wd"}, "submental"},
      // forehead
      {{"glabella", "E1", "H1", "H0"}, "forehead"},
      {{"E1", "E2", "H2", "H1"}, "forehead"},
      {{"E2", "E3", "H3", "H2"}, "forehead"},
      {{"E3", "Wt", "Z0", "H3"}, "temple"},
      // around the ear
      {{"Wt", "Wa", "A0", "A1"}, "temple"},
      {{"Wa", "Wb", "A7", "A0"}, "cheek"},
      {{"Wb", "Wc", "A6", "A7"}, "cheek"},
      {{"Z0", "Wt", "A1", "Z1"}, "scalp"},
      {{"Z1", "A1", "A2", "Z2"}, "scalp"},
      {{"Z2", "A2", "A3", "Z3"}, "scalp"},
      {{"Z3", "A3", "A4", "Z4"}, "scalp"},
      {{"Z4", "A4", "A5", "Z5"}, "scalp"},
  };
  const std::vector<std::vector<std::string>> rows = {
      {"H0", "H1", "H2", "H3", "Z0"},     {"C10", "C11", "C12", "C13", "Z1"},
      {"C20", "C21", "C22", "C23", "Z2"}, {"C30", "C31", "C32", "C33", "Z3"},
      {"C40", "C41", "C42", "C43", "Z4"}, {"C50", "C51", "C52", "C53", "Z5"}};
  for (std::size_t r = 0; r + 1 < rows.size(); ++r)
    for (int c = 0; c < 4; ++c)
      patches.push_back(
          {{rows[r][c], rows[r][c + 1], rows[r + 1][c + 1], rows[r + 1][c]}, r == 0 ? "forehead" : "scalp"});
  const std::vector<std::string> above = {"Wm", "Wd", "Wc", "A6", "A5", "Z5", "C53", "C52", "C51", "C50"};
  for (int k = 0; k < 9; ++k) {
    const std::string v = numbered('V', k), next_v = numbered('V', k + 1);
    const std::string u = numbered('U', k), next_u = numbered('U', k + 1);
    patches.push_back({{above[k + 1], above[k], v, next_v}, "neck"});
    patches.push_back({{next_v, v, u, next_u}, "neck"});
  }
  return patches;
}

}  // namespace fascia::head_maker

// Writes the embedded head and its landmarks into the folder that is named.
#include "builder/rigging/embedded_head.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  fascia::rigging::write_embedded_head(folder / "embedded_head.obj", folder / "embedded_head_landmarks.json");
}

// Writes what the samples' tests play with: a small rig and a curve file.
// usage: make_sample_files FOLDER
#include <fstream>
#include <string>

#include "tests/rig/tiny_rig.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::string folder = argv[1];
  const auto bytes = fascia::test::tiny_rig_file();
  std::ofstream rig(folder + "/tiny.glb", std::ios::binary);
  rig.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  std::ofstream curves(folder + "/smile.csv");
  curves << "time,arkit:mouthSmileLeft,arkit:mouthSmileRight,unknown\n0,0,0,1\n0.5,1,0.5,1\n1,0,0,1\n";
  std::ofstream useless(folder + "/useless.csv");
  useless << "time,unknown\n0,0\n1,1\n";
  rig.close();
  curves.close();
  useless.close();
  return rig && curves && useless ? 0 : 1;
}

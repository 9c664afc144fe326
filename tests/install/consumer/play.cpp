#include <cstdio>
#include <fascia/fascia.hpp>
#include <fstream>
#include <iterator>
#include <vector>

/// The same as play.c in C++: a channel is driven, and a vertex of the first mesh moves.
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ifstream file(argv[1], std::ios::binary);
  const std::vector<char> read{std::istreambuf_iterator<char>(file), {}};
  const std::vector<std::uint8_t> bytes(read.begin(), read.end());
  try {
    const fascia::api::Asset asset = fascia::api::Asset::load(bytes);
    fascia::api::Face face(asset);
    const auto shown = face.positions(0);
    const std::vector<fascia::api::Vector3> rest(shown.begin(), shown.end());
    face.values()[0] = 1.0F;
    face.pose();
    std::size_t moved = 0;
    for (std::size_t v = 0; v < rest.size(); ++v)
      moved += face.positions(0)[v] != rest[v] ? 1 : 0;
    std::printf("%zu vertices of %zu moved\n", moved, rest.size());
    return moved > 0 ? 0 : 1;
  } catch (const fascia::api::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

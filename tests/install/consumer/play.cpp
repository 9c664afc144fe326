#include <fascia/fascia.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ifstream file(argv[1], std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  fascia_asset* asset = nullptr;
  if (fascia_asset_load(bytes.data(), bytes.size(), &asset) != FASCIA_OK) return 1;
  const std::unique_ptr<fascia_asset, decltype(&fascia_asset_release)> keep(asset, fascia_asset_release);
  fascia_asset_info info{};
  info.struct_size = sizeof info;
  if (fascia_asset_get_info(asset, &info) != FASCIA_OK) return 1;
  std::printf("channels %u\n", static_cast<unsigned>(info.channel_count));
  return info.channel_count > 0 ? 0 : 1;
}

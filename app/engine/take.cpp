#include "app/engine/take.h"

#include "formats/files.h"
#include "geometry/error.h"

namespace fascia::app {

Take::Take(const std::filesystem::path& file) : file_(file) {
  const std::vector<uint8_t> bytes = formats::read_bytes(file);
  fascia_curves* curves = nullptr;
  if (fascia_curves_load(bytes.data(), bytes.size(), &curves) != FASCIA_OK)
    throw Error("'" + file.string() + "': " + fascia_last_message());
  curves_.reset(curves);
  fascia_curves_info info = {};
  info.struct_size = sizeof info;
  if (fascia_curves_get_info(curves, &info) != FASCIA_OK)
    throw Error("'" + file.string() + "': " + fascia_last_message());
  duration_ = info.duration;
  frames_per_second_ = info.frames_per_second;
  names_.assign(info.names, info.names + info.count);
  notes_.assign(info.notes, info.notes + info.note_count);
}

std::vector<bool> Take::matched(const fascia_asset* asset) const {
  std::vector<uint8_t> flags(names_.size(), 0);
  uint32_t count = 0;
  if (fascia_curves_match(curves_.get(), asset, &count, flags.data()) != FASCIA_OK) return {};
  return {flags.begin(), flags.end()};
}

}  // namespace fascia::app

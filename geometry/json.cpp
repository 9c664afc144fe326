#include "geometry/json.h"

#include "geometry/error.h"

namespace fascia {

void check_depth(std::string_view json, const std::string& name) {
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > greatest_depth)
        throw Error(name + ": its JSON is nested deeper than " + std::to_string(greatest_depth) +
                    " levels, at byte " + std::to_string(i) + "; flatten it and try again");
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    }
  }
}

}  // namespace fascia

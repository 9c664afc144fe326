#include "rig/read/visitor.h"

#include <charconv>
#include <iomanip>
#include <locale>
#include <sstream>

namespace fascia::rig {

void Reader::hash(const char* name, uint64_t& value) {
  std::string digits;
  text(name, digits);
  if (digits.empty()) return;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (digits.size() != 16 || error != std::errc() || end != digits.data() + digits.size())
    fail(name, "not sixteen hexadecimal digits");
}

void Reader::fail_bounds(const char* name, double value, double least, double most) const {
  std::ostringstream text;  // to_chars of a double is not in every library the runtime is built with
  text.imbue(std::locale::classic());
  text << std::setprecision(9) << value << " is not within " << least << " .. " << most;
  fail(name, text.str());
}

void Reader::numbers(const char* name, float* to, std::size_t count) {
  if (!has(name)) return;
  const tinygltf::Value& values = object_.Get(name);
  if (!values.IsArray() || values.ArrayLen() != count)
    fail(name, "not " + std::to_string(count) + " numbers");
  for (std::size_t i = 0; i < count; ++i)
    to[i] = checked_number<float>(values.Get(i), name);
}

void Reader::texts(const char* name, std::vector<std::string>& values) {
  if (!has(name)) return;
  const tinygltf::Value& array = object_.Get(name);
  if (!array.IsArray()) fail(name, "not an array of texts");
  values.resize(array.ArrayLen());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!array.Get(i).IsString()) fail(name, "entry " + std::to_string(i) + " is not a text");
    values[i] = array.Get(i).Get<std::string>();
  }
}

gltf::AccessorView Reader::accessor(const char* name, std::size_t components, std::size_t length) {
  if (!has(name)) {
    if (length != 0 && length != any)
      fail(name, "missing, though " + std::to_string(length) + " elements are due");
    return {};
  }
  const int index = checked_number<int>(object_.Get(name), name);
  const gltf::AccessorView view = gltf::accessor_view(model_, index, at(name));
  if (view.components != components)
    fail(name, "its accessor has " + std::to_string(view.components) + " components an element, not " +
                   std::to_string(components));
  if (view.data == nullptr || view.count == 0) fail(name, "its accessor is empty");
  if (length != any && view.count != length)
    fail(name, std::to_string(view.count) + " elements where " + std::to_string(length) + " are due");
  if (model_.accessors[static_cast<std::size_t>(index)].sparse.isSparse) fail(name, "its accessor is sparse");
  return view;
}

}  // namespace fascia::rig

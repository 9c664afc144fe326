#include "formats/named_files.h"

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>

#include "formats/files.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "gltf/edit/uri.h"

namespace fascia::formats {

namespace {

namespace fs = std::filesystem;
using PlainJson = nlohmann::json;

/// Calls `use` with every line of a file but for those longer than any that names a file.
void for_each_short_line(const fs::path& path, const std::function<void(std::string_view)>& use) {
  constexpr size_t longest = 4096;
  std::string line;
  const auto end_line = [&] {
    if (!line.empty() && line.size() <= longest) use(line);
    line.clear();
  };
  read_pieces(path, [&](std::span<const uint8_t> piece) {
    for (const uint8_t byte : piece) {
      if (byte == '\n' || byte == '\r')
        end_line();
      else if (line.size() <= longest)
        line += static_cast<char>(byte);
    }
  });
  end_line();
}

/// Where the next word of `line` begins at or behind `at`, and where it ends.
std::pair<size_t, size_t> word_at(std::string_view line, size_t at) {
  const size_t begin = std::min(line.find_first_not_of(" \t", at), line.size());
  return {begin, std::min(line.find_first_of(" \t", begin), line.size())};
}

std::string_view without_blanks_at_end(std::string_view text) {
  return text.substr(0, text.find_last_not_of(" \t") + 1);
}

/// The file that names others, and whether they may lie outside its folder.
struct Owner {
  const fs::path& path;
  Outside outside;
};

NamedFile beside(const Owner& owner, std::string_view name) {
  return {std::string(name), find_beside(owner.path, std::string(name), owner.outside).path};
}

bool names_texture(std::string_view keyword) {
  return keyword.starts_with("map_") || keyword == "norm" || keyword == "bump" || keyword == "disp" ||
         keyword == "refl" || keyword == "decal";
}

/// The texture of a line: what is left behind its options, of which a name with blanks may look like one.
NamedFile texture_of(const Owner& owner, std::string_view line, size_t keyword_end) {
  const std::string_view text = without_blanks_at_end(line);
  std::string_view last;
  for (auto [begin, end] = word_at(text, keyword_end); begin < end;
       std::tie(begin, end) = word_at(text, end)) {
    last = text.substr(begin);
    if (NamedFile file = beside(owner, last); file.path) return file;
  }
  return {std::string(last), std::nullopt};
}

void add_textures(const Owner& mesh, const fs::path& library, std::vector<NamedFile>& files) {
  for_each_short_line(library, [&](std::string_view line) {
    const auto [begin, end] = word_at(line, 0);
    if (names_texture(line.substr(begin, end - begin))) files.push_back(texture_of(mesh, line, end));
  });
}

std::vector<NamedFile> files_of_obj(const Owner& mesh) {
  std::vector<NamedFile> files;
  for_each_short_line(mesh.path, [&](std::string_view line) {
    const auto [begin, end] = word_at(line, 0);
    if (line.substr(begin, end - begin) != "mtllib") return;
    const size_t name = word_at(line, end).first;
    files.push_back(beside(mesh, without_blanks_at_end(line.substr(name))));
  });
  const size_t libraries = files.size();
  for (size_t i = 0; i < libraries; ++i)
    if (const auto path = files[i].path) add_textures(mesh, *path, files);
  return files;
}

/// Hears a glTF file's JSON as it is parsed and keeps the URIs of buffers and images.
class UriListener : public nlohmann::json_sax<PlainJson> {
 public:
  std::vector<std::string> uris;

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool string(string_t& text) override {
    if (depth_ == 3 && is_list_ && key_ == "uri" && !gltf::has_scheme(text)) uris.push_back(text);
    return true;
  }
  bool key(string_t& name) override {
    if (depth_ == 1) is_list_ = name == "buffers" || name == "images";
    if (depth_ == 3) key_ = name.substr(0, 4);
    return true;
  }
  bool start_object(std::size_t) override { return ++depth_ > 0; }
  bool end_object() override { return --depth_ >= 0; }
  bool start_array(std::size_t) override { return ++depth_ > 0; }
  bool end_array() override { return --depth_ >= 0; }
  bool parse_error(std::size_t, const std::string&, const PlainJson::exception&) override { return false; }

 private:
  int depth_ = 0;
  bool is_list_ = false;
  std::string key_;
};

std::vector<NamedFile> files_of_gltf(const Owner& mesh) {
  std::ifstream stream(mesh.path, std::ios::binary);
  if (!stream) throw Error("'" + mesh.path.string() + "' cannot be opened: check its permissions");
  UriListener listener;
  PlainJson::sax_parse(stream, &listener);
  std::vector<NamedFile> files;
  for (const std::string& uri : listener.uris)
    files.push_back(beside(mesh, gltf::percent_decoded(uri)));
  return files;
}

}  // namespace

std::vector<NamedFile> named_files(const fs::path& mesh, Outside outside) {
  std::error_code status;
  if (!fs::is_regular_file(mesh, status)) throw Error("'" + mesh.string() + "' is not a file");
  if (extension_of(mesh) == ".obj") return files_of_obj({mesh, outside});
  if (extension_of(mesh) == ".gltf") return files_of_gltf({mesh, outside});
  return {};
}

}  // namespace fascia::formats

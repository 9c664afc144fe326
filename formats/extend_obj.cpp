#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "formats/detail.h"
#include "formats/extend_detail.h"
#include "formats/obj_lines.h"

namespace fascia::formats::detail {

namespace {

/// A corner of a face as the file names it, counted from 0; -1: not given.
struct Corner {
  int v = -1, vt = -1, vn = -1;
};

/// What is counted while a file is read from its beginning.
struct Counts {
  int v = 0, vt = 0, vn = 0;
};

/// The lines of a file, as they are where they end with LF; what ends otherwise, or is folded, is made plain.
std::vector<std::string> lines_of(const std::vector<uint8_t>& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  bool is_plain = text.find('\\') == std::string_view::npos && text.substr(0, 3) != "\xEF\xBB\xBF";
  for (size_t at = text.find('\r'); is_plain && at != std::string_view::npos; at = text.find('\r', at + 1))
    is_plain = at + 1 < text.size() && text[at + 1] == '\n';
  const std::string plain = is_plain ? std::string(text) : plain_obj(text);
  std::vector<std::string> lines(1);
  for (const char character : plain)
    if (character == '\n')
      lines.emplace_back();
    else
      lines.back().push_back(character);
  return lines;
}

std::string keyword(const std::string& line) {
  std::string word;
  std::istringstream(line) >> word;
  return word;
}

bool is_continued(const std::string& line) {
  const size_t last = line.find_last_not_of(" \t\r");
  return last != std::string::npos && line[last] == '\\';
}

std::optional<Corner> corner_of(const std::string& token, const Counts& counts, bool& is_relative) {
  Corner corner;
  int* const parts[] = {&corner.v, &corner.vt, &corner.vn};
  const int known[] = {counts.v, counts.vt, counts.vn};
  std::istringstream words(token);
  std::string word;
  for (size_t k = 0; k < 3 && std::getline(words, word, '/'); ++k) {
    if (word.empty()) continue;
    const int number = std::atoi(word.c_str());
    if (number < 0) is_relative = true;
    *parts[k] = number > 0 ? number - 1 : known[k] + number;
  }
  if (corner.v < 0) return std::nullopt;
  return corner;
}

std::string number(double value, int digits = 9) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// One mesh's part in the file.
struct Growth {
  const SceneMesh* mesh = nullptr;
  const MeshExtension* extension = nullptr;
  std::map<int, std::vector<Triangle>> pieces;  ///< of triangles before that changed, by their number
  std::vector<Triangle> added;
  std::map<Triangle, int> by_corners;        ///< sorted `v` numbers of a triangle that changed -> its number
  std::vector<int> appended_v, appended_vt;  ///< of appended vertices, numbers in the new file
  bool is_added = false;
};

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

/// Rewrites the text of one file.
class ObjWriter {
 public:
  ObjWriter(Scene& scene, const std::vector<MeshExtension>& extensions)
      : scene_(scene), lines_(lines_of(scene.bytes)) {
    count();
    for (size_t m = 0; m < extensions.size(); ++m)
      if (extensions[m].changed()) grow(scene.meshes[m], extensions[m]);
  }

  std::string text(size_t first_new_mesh) {
    std::string out;
    Counts counts;
    const std::string block = vertex_block();
    for (size_t i = 0; i < lines_.size(); ++i) {
      std::string line = lines_[i];
      const size_t first = i;
      while (is_continued(line) && i + 1 < lines_.size()) {
        line.resize(line.find_last_of('\\'));
        line += " " + lines_[++i];
      }
      const std::string word = keyword(line);
      if (word == "v") ++counts.v;
      if (word == "vt") ++counts.vt;
      if (word == "vn") ++counts.vn;
      std::string replacement;
      if (word == "f" && rewrite_face(line, counts, replacement)) {
        out += replacement;
      } else {
        for (size_t k = first; k <= i; ++k)
          out += lines_[k] + (k + 1 < lines_.size() ? "\n" : "");
      }
      if (first <= block_after_ && block_after_ <= i) out += block;
    }
    if (!out.empty() && out.back() != '\n') out += '\n';
    if (is_relative_) out += block;
    for (Growth& growth : growths_)
      if (!growth.is_added) out += added_faces(growth);
    for (size_t m = first_new_mesh; m < scene_.meshes.size(); ++m)
      out += new_object(scene_.meshes[m]);
    return out;
  }

 private:
  void count() {
    for (size_t i = 0; i < lines_.size(); ++i) {
      const std::string word = keyword(lines_[i]);
      if (word == "v" || word == "vt" || word == "vn") block_after_ = i;
      if (word == "v") ++total_.v;
      if (word == "vt") ++total_.vt;
      if (word == "vn") ++total_.vn;
      if (word == "v") coloured_ = coloured_ || values_of(lines_[i]).size() >= 6;
      if (word == "v") vertex_lines_.push_back(i);
      if (word == "f") is_relative_ = is_relative_ || lines_[i].find('-') != std::string::npos;
    }
    // Numbers counted backward would change their meaning were lines put in before them.
    if (is_relative_) block_after_ = lines_.size();
  }

  static std::vector<double> values_of(const std::string& line) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    std::vector<double> values;
    for (double x; words >> x;)
      values.push_back(x);
    return values;
  }

  void grow(SceneMesh& mesh, const MeshExtension& extension) {
    Growth growth;
    growth.mesh = &mesh;
    growth.extension = &extension;
    std::map<int, std::vector<Triangle>> by_origin;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (extension.origin[t] < 0)
        growth.added.push_back(mesh.triangles[t]);
      else
        by_origin[extension.origin[t]].push_back(mesh.triangles[t]);
    }
    for (auto& [origin, pieces] : by_origin) {
      const Triangle& before = extension.triangles_before[static_cast<size_t>(origin)];
      if (pieces.size() == 1 && pieces[0] == before) continue;
      growth.by_corners[sorted({mesh.source_vertices[static_cast<size_t>(before[0])],
                                mesh.source_vertices[static_cast<size_t>(before[1])],
                                mesh.source_vertices[static_cast<size_t>(before[2])]})] = origin;
      growth.pieces[origin] = std::move(pieces);
    }
    for (size_t i = 0; i < extension.vertices.size(); ++i) {
      growth.appended_v.push_back(total_.v + new_v_++);
      mesh.source_vertices.push_back(growth.appended_v.back());
      growth.appended_vt.push_back(mesh.uvs.empty() ? -1 : total_.vt + new_vt_++);
    }
    growths_.push_back(std::move(growth));
  }

  std::string vertex_block() const {
    std::string out;
    for (const Growth& growth : growths_) {
      const auto first = static_cast<size_t>(growth.extension->vertices_before);
      for (size_t i = 0; i < growth.appended_v.size(); ++i) {
        out += "v " + place(growth.mesh->positions[first + i]);
        if (coloured_) out += colour(growth, growth.extension->vertices[i]);
        out += "\n";
      }
    }
    for (const Growth& growth : growths_)
      for (size_t i = 0; i < growth.appended_vt.size(); ++i)
        if (growth.appended_vt[i] >= 0) {
          const Vec2& uv = growth.mesh->uvs[static_cast<size_t>(growth.extension->vertices_before) + i];
          out += "vt " + number(uv[0]) + " " + number(1.0 - uv[1]) + "\n";
        }
    return out;
  }

  /// The coordinates of a `v` line.
  std::string place(const Vec3& position) const {
    const int digits = scene_.offset.isZero(0) ? 9 : 15;
    const Vec3 p = position + scene_.offset;
    return number(p[0], digits) + " " + number(p[1], digits) + " " + number(p[2], digits);
  }

  /// What stands behind the coordinates of the two vertices that an appended one lies between.
  std::string colour(const Growth& growth, const AppendedVertex& vertex) const {
    const auto rest = [&](int v) { return colour_of(growth, v); };
    const std::array<double, 3> a = rest(vertex.a), b = rest(vertex.b);
    std::string out;
    for (size_t k = 0; k < 3; ++k)
      out += " " + number((1.0 - vertex.share) * a[k] + vertex.share * b[k]);
    return out;
  }

  std::array<double, 3> colour_of(const Growth& growth, int v) const {
    while (v >= growth.extension->vertices_before)
      v = growth.extension->vertices[static_cast<size_t>(v - growth.extension->vertices_before)].a;
    const int source = growth.mesh->source_vertices[static_cast<size_t>(v)];
    const std::vector<double> values = values_of(lines_[vertex_lines_[static_cast<size_t>(source)]]);
    if (values.size() < 6) return {1.0, 1.0, 1.0};
    return {values[values.size() - 3], values[values.size() - 2], values[values.size() - 1]};
  }

  /// Writes a face in triangles when one of its own was cut.
  bool rewrite_face(const std::string& line, const Counts& counts, std::string& out) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    std::vector<Corner> corners;
    std::vector<Vec3> places;
    std::vector<int> polygon;
    while (words >> word) {
      if (word[0] == '#') break;
      bool is_relative = false;
      const auto corner = corner_of(word, counts, is_relative);
      if (!corner || corner->v >= total_.v) return false;
      polygon.push_back(static_cast<int>(corners.size()));
      corners.push_back(*corner);
      const std::vector<double> p = values_of(lines_[vertex_lines_[static_cast<size_t>(corner->v)]]);
      if (p.size() < 3) return false;
      places.emplace_back(p[0], p[1], p[2]);
    }
    std::vector<Triangle> triangles;
    triangulate(places, polygon, triangles);
    for (Growth& growth : growths_) {
      bool is_cut = false;
      std::string text;
      for (const Triangle& t : triangles) {
        const auto at = growth.by_corners.find(
            sorted({corners[static_cast<size_t>(t[0])].v, corners[static_cast<size_t>(t[1])].v,
                    corners[static_cast<size_t>(t[2])].v}));
        if (at == growth.by_corners.end()) {
          text += "f";
          for (const int k : t)
            text += " " + token(corners[static_cast<size_t>(k)]);
          text += "\n";
          continue;
        }
        is_cut = true;
        for (const Triangle& piece : growth.pieces[at->second]) {
          text += "f";
          for (const int v : piece)
            text += " " + piece_token(growth, v, corners);
          text += "\n";
        }
      }
      if (!is_cut) continue;
      out = text;
      if (!growth.is_added && !is_relative_) out += added_faces(growth);
      return true;
    }
    return false;
  }

  static std::string token(const Corner& corner) {
    std::string out = std::to_string(corner.v + 1);
    if (corner.vt >= 0 || corner.vn >= 0) out += "/" + (corner.vt >= 0 ? std::to_string(corner.vt + 1) : "");
    if (corner.vn >= 0) out += "/" + std::to_string(corner.vn + 1);
    return out;
  }

  /// A vertex of a piece: a corner of the face as it stands there, or an appended one; that takes the normal
  /// of the nearer corner of its edge.
  std::string piece_token(const Growth& growth, int vertex, const std::vector<Corner>& corners) const {
    const auto corner_at = [&](int v) {
      const int source = growth.mesh->source_vertices[static_cast<size_t>(v)];
      for (const Corner& corner : corners)
        if (corner.v == source) return corner;
      return corners[0];
    };
    if (vertex < growth.extension->vertices_before) return token(corner_at(vertex));
    const auto i = static_cast<size_t>(vertex - growth.extension->vertices_before);
    int like = vertex;
    while (like >= growth.extension->vertices_before) {
      const AppendedVertex& looks =
          growth.extension->vertices[static_cast<size_t>(like - growth.extension->vertices_before)];
      like = looks.share < 0.5 ? looks.a : looks.b;
    }
    Corner corner = corner_at(like);
    corner.v = growth.appended_v[i];
    if (corner.vt >= 0) corner.vt = growth.appended_vt[i];
    return token(corner);
  }

  std::string added_faces(Growth& growth) const {
    growth.is_added = true;
    std::string out;
    for (const Triangle& t : growth.added) {
      std::array<Corner, 3> corners;
      bool has_texture = true;
      for (size_t k = 0; k < 3; ++k) {
        const auto v = static_cast<size_t>(t[k]);
        const auto before = static_cast<size_t>(growth.extension->vertices_before);
        corners[k].v = growth.mesh->source_vertices[v];
        corners[k].vt = v < before ? growth.mesh->source_textures[v] : growth.appended_vt[v - before];
        has_texture = has_texture && corners[k].vt >= 0;
      }
      out += "f";
      for (Corner& corner : corners) {
        if (!has_texture) corner.vt = -1;
        out += " " + token(corner);
      }
      out += "\n";
    }
    return out;
  }

  std::string new_object(SceneMesh& mesh) {
    std::string out = "o " + mesh.name + "\n";
    const int first = total_.v + new_v_;
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      mesh.source_vertices.push_back(first + static_cast<int>(v));
      out += "v " + place(mesh.positions[v]);
      if (mesh.colours.size() == mesh.positions.size())
        for (size_t k = 0; k < 3; ++k)
          out += " " + number(mesh.colours[v][static_cast<int>(k)]);
      out += "\n";
    }
    new_v_ += static_cast<int>(mesh.positions.size());
    for (const Triangle& t : mesh.triangles)
      out += "f " + std::to_string(first + t[0] + 1) + " " + std::to_string(first + t[1] + 1) + " " +
             std::to_string(first + t[2] + 1) + "\n";
    return out;
  }

  Scene& scene_;
  std::vector<std::string> lines_;
  std::vector<size_t> vertex_lines_;
  std::vector<Growth> growths_;
  Counts total_;
  int new_v_ = 0, new_vt_ = 0;
  size_t block_after_ = 0;
  bool coloured_ = false, is_relative_ = false;
};

}  // namespace

void rewrite_obj(Scene& scene, const std::vector<MeshExtension>& extensions) {
  ObjWriter writer(scene, extensions);
  const std::string text = writer.text(extensions.size());
  scene.bytes.assign(text.begin(), text.end());
}

}  // namespace fascia::formats::detail

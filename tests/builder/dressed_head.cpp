#include "tests/builder/dressed_head.h"

#include <cmath>
#include <cstdio>

#include "anatomy/anatomy.h"
#include "builder/rigging/embedded_head.h"
#include "formats/scene.h"

namespace fascia::testing {
namespace {

/// Collects objects as OBJ text after what a file already has.
class ObjText {
 public:
  explicit ObjText(std::string text) : text_(std::move(text)) {
    for (size_t at = text_.find("\nv "); at != std::string::npos; at = text_.find("\nv ", at + 1))
      ++count_;
  }
  void object(const std::string& name) { text_ += "o " + name + "\n"; }
  int vertex(const Vec3& metres) {
    char line[96];
    std::snprintf(line, sizeof line, "v %.5f %.5f %.5f\n", 1e3 * metres[0], 1e3 * metres[1], 1e3 * metres[2]);
    text_ += line;
    return ++count_;
  }
  void triangle(int a, int b, int c) {
    text_ += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  }
  /// A ribbon along `way`, `width` wide.
  void ribbon(const std::vector<Vec3>& way, const Vec3& width) {
    int last[2] = {};
    for (size_t k = 0; k < way.size(); ++k) {
      const int a = vertex(way[k]), b = vertex(way[k] + width);
      if (k > 0) {
        triangle(last[0], last[1], b);
        triangle(last[0], b, a);
      }
      last[0] = a;
      last[1] = b;
    }
  }
  void ball(const Vec3& centre, double radius) {
    constexpr int around = 24, down = 12;
    std::vector<std::vector<int>> ring(down + 1);
    for (int j = 0; j <= down; ++j)
      for (int i = 0; i < around; ++i) {
        const double a = 2.0 * M_PI * i / around, b = M_PI * j / down;
        ring[static_cast<size_t>(j)].push_back(vertex(
            centre + radius * Vec3(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b))));
      }
    for (size_t j = 0; j < down; ++j)
      for (size_t i = 0; i < around; ++i) {
        const size_t next = (i + 1) % around;
        triangle(ring[j][i], ring[j + 1][i], ring[j + 1][next]);
        triangle(ring[j][i], ring[j + 1][next], ring[j][next]);
      }
  }
  void block(const Vec3& centre, const Vec3& half) {
    int corner[8];
    for (int k = 0; k < 8; ++k)
      corner[k] = vertex(centre + half.cwiseProduct(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)));
    for (const auto& f : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                          std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}}) {
      triangle(corner[f[0]], corner[f[1]], corner[f[2]]);
      triangle(corner[f[0]], corner[f[2]], corner[f[3]]);
    }
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int count_ = 0;
};

}  // namespace

void write_dressed_head(const std::filesystem::path& head, const std::filesystem::path& landmarks) {
  rigging::write_embedded_head(head, landmarks);
  const std::vector<uint8_t> bytes = formats::read_bytes(head);
  ObjText obj(std::string(bytes.begin(), bytes.end()));
  const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  const auto at = [&](const std::string& name) {
    for (const anatomy::Landmark& landmark : anatomy.landmarks)
      if (landmark.name == name && landmark.skin) return *landmark.skin;
    return Vec3(NAN, NAN, NAN);
  };
  for (const std::string side : {"_left", "_right"}) {
    obj.object("eye" + side);
    obj.ball(0.5 * (at("endocanthion" + side) + at("exocanthion" + side)) - Vec3(0, 0, 0.0085), 0.0118);
  }
  obj.object("tongue");
  obj.block(at("stomion") + Vec3(0, -0.004, -0.03), Vec3(0.012, 0.004, 0.012));
  obj.object("lashes");
  const Vec3 lid = at("palpebrale_superius_left"), out(0, 0.003, 0.008);
  for (const double x : {-0.004, 0.0, 0.004})
    obj.ribbon({lid + Vec3(x, 0, 0), lid + Vec3(x, 0, 0) + 0.5 * out, lid + Vec3(x, 0, 0) + out},
               Vec3(0.0006, 0, 0));
  std::vector<Vec3> along;
  for (int k = -10; k <= 10; ++k)
    along.push_back(lid + Vec3(0.0009 * k, 0, -3e-6 * k * k));
  obj.ribbon(along, out);
  obj.object("brows");
  const Vec3 brow = at("superciliare_left");
  obj.ribbon({brow + Vec3(-0.010, 0, 0.0005), brow + Vec3(0, 0, 0.0005), brow + Vec3(0.010, 0, -0.0015)},
             Vec3(0, 0.003, -0.001));
  obj.object("hair");
  obj.ribbon({at("vertex"), at("vertex") + Vec3(0, 0.004, 0.02), at("vertex") + Vec3(0, 0.002, 0.045)},
             Vec3(0.001, 0, 0));
  obj.object("moustache");
  const Vec3 lip = at("labiale_superius");
  obj.ribbon({lip + Vec3(0, 0.004, 0), lip + Vec3(0, 0, 0.003), lip + Vec3(0, -0.006, 0.004)},
             Vec3(0.001, 0, 0));
  formats::write_text(head, obj.text());
}

}  // namespace fascia::testing

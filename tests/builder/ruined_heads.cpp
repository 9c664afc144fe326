#include <Eigen/Core>
#include <limits>
#include <utility>

#include "tests/builder/broken_head_kinds.h"

namespace fascia::testing {

void add_ruins(std::map<std::string, Break>& kinds) {
  const auto refused = [](const std::vector<std::string>& says, const Break& ruin) {
    return [says, ruin](Made& made, Random& random) {
      made.is_usable = false;
      made.says = says;
      ruin(made, random);
    };
  };
  constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
  kinds["not_a_number"] = refused({"not a number", "not finite"}, [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    for (size_t i = 0; i < 1 + any(random, 20); ++i)
      mesh.vertices[any(random, mesh.vertices.size())][static_cast<Eigen::Index>(random() % 3)] = no_number;
  });
  kinds["infinite"] = refused({"not a number", "not finite"}, [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    mesh.vertices[any(random, mesh.vertices.size())].x() = -std::numeric_limits<double>::infinity();
  });
  kinds["one_triangle"] = refused({"no face", "triangle"}, [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    mesh.triangles = {mesh.triangles[any(random, mesh.triangles.size())]};
    made.pieces = {skin_of(made)};
  });
  kinds["no_triangles"] = refused({"triangle"}, [](Made& made, Random&) {
    skin_of(made).mesh.triangles.clear();
    made.pieces = {skin_of(made)};
  });
  kinds["index_out_of_range"] = refused({"passes the"}, [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    mesh.triangles[any(random, mesh.triangles.size())][1] =
        mesh.vertex_count() + static_cast<int>(any(random, 9));
  });
  kinds["all_in_one_place"] = refused({"units large"}, [](Made& made, Random&) {
    for (Piece& piece : made.pieces)
      for (Vec3& p : piece.mesh.vertices)
        p = Vec3(0.1, 0.1, 0.1);
  });
  kinds["pressed_flat"] = refused({"no face"}, [](Made& made, Random&) {
    for (Piece& piece : made.pieces)
      for (Vec3& p : piece.mesh.vertices)
        p.z() = 0.0;
  });
  kinds["vertices_shuffled"] = refused({"no face"}, [](Made& made, Random& random) {
    made.pieces = {skin_of(made)};
    std::vector<Vec3>& all = made.pieces[0].mesh.vertices;
    for (size_t v = all.size() - 1; v > 0; --v)
      std::swap(all[v], all[any(random, v + 1)]);
  });
}

}  // namespace fascia::testing

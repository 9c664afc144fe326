#include "tests/builder/broken_heads.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "anatomy/anatomy.h"
#include "tests/builder/broken_head_kinds.h"
#include "tests/builder/taken_apart.h"

namespace fascia::testing {
namespace {

const std::vector<anatomy::MeshObject>& generic_head() {
  static const std::vector<anatomy::MeshObject> head = anatomy::load_generic().head;
  return head;
}

/// Which of some places, strewn by chance about the head, is nearest.
std::function<int(const Triangle&)> islands_of(const TriangleMesh& mesh, Random& random, size_t count) {
  std::vector<Vec3> seeds;
  for (size_t i = 0; i < count; ++i)
    seeds.push_back(mesh.vertices[any(random, mesh.vertices.size())]);
  return [&mesh, seeds](const Triangle& t) {
    const Vec3 p = middle_of(mesh, t);
    return static_cast<int>(std::min_element(seeds.begin(), seeds.end(),
                                             [&](const Vec3& a, const Vec3& b) {
                                               return (a - p).squaredNorm() < (b - p).squaredNorm();
                                             }) -
                            seeds.begin());
  };
}

/// The skin's pieces in place of the skin, each a mesh and a node of its own.
void replace_skin(Made& made, const std::vector<TriangleMesh>& parts) {
  const Piece skin = skin_of(made);
  std::erase_if(made.pieces, [](const Piece& piece) { return piece.name == "skin"; });
  for (size_t i = 0; i < parts.size(); ++i)
    made.pieces.push_back({"piece_" + std::to_string(i), parts[i], skin.scale});
}

/// A plane through the head by chance, across `axis`.
std::vector<TriangleMesh> cut_in_two(const TriangleMesh& mesh, Random& random, const Vec3& axis, double off) {
  const Vec3 normal =
      (axis + 0.2 * Vec3(chance(random, -1, 1), chance(random, -1, 1), chance(random, -1, 1))).normalized();
  return taken_apart(
      mesh, [&mesh, normal, off](const Triangle& t) { return middle_of(mesh, t).dot(normal) > off ? 1 : 0; });
}

const std::vector<std::string> lies_on_others = {"on others"}, faces_against = {"against their neighbours"},
                               faces_inward = {"face inward"},
                               are_flat = {"two corners in one place", "taken as edges"};

void add_ways_to_cut(std::map<std::string, Break>& kinds) {
  kinds["triangle_soup"] = [](Made& made, Random&) {
    TriangleMesh& mesh = skin_of(made).mesh;
    int next = 0;
    mesh = joined(taken_apart(mesh, [&](const Triangle&) { return next++; }));
    made.is_cut = true;
  };
  kinds["texture_islands"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    mesh = joined(taken_apart(mesh, islands_of(mesh, random, 6 + any(random, 60))));
    made.is_cut = true;
  };
  kinds["pieces_by_material"] = [](Made& made, Random& random) {
    const TriangleMesh mesh = skin_of(made).mesh;
    replace_skin(made, taken_apart(mesh, islands_of(mesh, random, 2 + any(random, 6))));
    made.is_cut = true;
  };
  kinds["hard_edges"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    const double cell = chance(random, 0.2, 0.5);  // of a normal's direction
    mesh = joined(taken_apart(mesh, [&](const Triangle& t) {
      const auto corner = [&](size_t k) { return mesh.vertices[static_cast<size_t>(t[k])]; };
      const Vec3 n = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized() / cell;
      return static_cast<int>(std::floor(n[0]) * 10000 + std::floor(n[1]) * 100 + std::floor(n[2]));
    }));
    made.is_cut = true;
  };
  kinds["front_and_back"] = [](Made& made, Random& random) {
    const TriangleMesh mesh = skin_of(made).mesh;
    replace_skin(made, cut_in_two(mesh, random, Vec3::UnitZ(), chance(random, -0.02, 0.02)));
    made.is_cut = true;
  };
  kinds["left_and_right"] = [](Made& made, Random& random) {
    const TriangleMesh mesh = skin_of(made).mesh;
    replace_skin(made, cut_in_two(mesh, random, Vec3::UnitX(), chance(random, -0.003, 0.003)));
    made.is_cut = true;
  };
  kinds["one_half_mirrored_by_its_node"] = [](Made& made, Random&) {
    const TriangleMesh mesh = skin_of(made).mesh;
    auto halves = taken_apart(mesh, [&](const Triangle& t) { return middle_of(mesh, t).x() > 0.0 ? 1 : 0; });
    Piece left{"half", halves[1]}, right{"half_mirrored", halves[1]};
    right.scale.x() = -1.0;
    std::erase_if(made.pieces, [](const Piece& piece) { return piece.name == "skin"; });
    made.pieces.push_back(left);
    made.pieces.push_back(right);
    made.is_cut = true;
  };
  kinds["rims_rounded_apart"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    mesh = joined(taken_apart(mesh, islands_of(mesh, random, 12)));
    for (Vec3& p : mesh.vertices)
      p += 2e-7 * Vec3(chance(random, -1, 1), chance(random, -1, 1), chance(random, -1, 1));
  };
}

void add_ways_to_layer(std::map<std::string, Break>& kinds) {
  kinds["second_shell"] = [](Made& made, Random&) {
    Piece copy = skin_of(made);
    copy.name = "copy";
    made.pieces.push_back(copy);
    made.is_cut = true;
    made.says = lies_on_others;
  };
  kinds["second_shell_in_one_mesh"] = [](Made& made, Random&) {
    TriangleMesh& mesh = skin_of(made).mesh;
    mesh = joined({mesh, mesh});
    made.is_cut = true;
    made.says = lies_on_others;
  };
  kinds["backs_of_their_own"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    TriangleMesh back = mesh;
    for (Triangle& t : back.triangles)
      turn_over(t);
    mesh = random() % 2 ? joined({mesh, back}) : joined({back, mesh});
    made.is_cut = true;
    made.says = lies_on_others;
  };
  kinds["backs_on_the_same_vertices"] = [](Made& made, Random&) {
    add_backs(skin_of(made).mesh);
    made.says = lies_on_others;
  };
  kinds["soup_with_backs"] = [](Made& made, Random&) {
    TriangleMesh& mesh = skin_of(made).mesh;
    add_backs(mesh);
    int next = 0;
    mesh = joined(taken_apart(mesh, [&](const Triangle&) { return next++; }));
    made.is_cut = true;
    made.says = lies_on_others;
  };
  kinds["thin_outer_shell"] = [](Made& made, Random& random) {
    Piece outline = skin_of(made);
    outline.name = "outline";
    const std::vector<Vec3> normals = vertex_normals(outline.mesh);
    const double off = chance(random, 2e-4, 1e-3);
    for (size_t v = 0; v < normals.size(); ++v)
      outline.mesh.vertices[v] += off * normals[v];
    for (Triangle& t : outline.mesh.triangles)
      turn_over(t);
    made.pieces.push_back(outline);
  };
  kinds["repeated_triangles"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    for (int i = 0; i < 500; ++i)
      mesh.triangles.push_back(mesh.triangles[any(random, mesh.triangles.size())]);
    made.says = lies_on_others;
  };
}

void add_ways_to_turn(std::map<std::string, Break>& kinds) {
  kinds["inside_out"] = [](Made& made, Random&) {
    for (Triangle& t : skin_of(made).mesh.triangles)
      turn_over(t);
    made.says = faces_inward;
  };
  kinds["all_inside_out"] = [](Made& made, Random&) {
    for (Piece& piece : made.pieces)
      for (Triangle& t : piece.mesh.triangles)
        turn_over(t);
    made.says = faces_inward;
  };
  kinds["mirrored_by_its_node"] = [](Made& made, Random&) {
    for (Piece& piece : made.pieces)
      piece.scale.x() = -1.0;
  };
  kinds["patches_inside_out"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    const auto label = islands_of(mesh, random, 40);
    for (Triangle& t : mesh.triangles)
      if (label(t) % 3 == 0) turn_over(t);
    made.says = faces_against;
  };
  kinds["every_third_inside_out"] = [](Made& made, Random& random) {
    for (Triangle& t : skin_of(made).mesh.triangles)
      if (random() % 3 == 0) turn_over(t);
    made.says = faces_against;
  };
  kinds["back_piece_inside_out"] = [](Made& made, Random& random) {
    const TriangleMesh mesh = skin_of(made).mesh;
    auto parts = cut_in_two(mesh, random, Vec3::UnitZ(), 0.0);
    for (Triangle& t : parts[0].triangles)
      turn_over(t);
    replace_skin(made, parts);
    made.is_cut = true;
    made.says = faces_against;
  };
}

void add_blemishes(std::map<std::string, Break>& kinds) {
  kinds["fins"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    const size_t count = mesh.triangles.size();
    for (int i = 0; i < 60; ++i) {
      const Triangle t = mesh.triangles[any(random, count)];
      const Vec3 out(chance(random, -1, 1), chance(random, -1, 1), chance(random, -1, 1));
      mesh.vertices.push_back(middle_of(mesh, t) + 0.004 * out);
      mesh.triangles.push_back({t[0], t[1], mesh.vertex_count() - 1});
    }
    made.says = {"stand on edges that two others share"};
  };
  kinds["inner_walls"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    const size_t count = mesh.triangles.size();
    for (int i = 0; i < 12; ++i) {  // a strip from one place of the skin to the next
      const Triangle t = mesh.triangles[any(random, count)], u = mesh.triangles[any(random, count)];
      if ((middle_of(mesh, t) - middle_of(mesh, u)).norm() > 0.03) continue;
      mesh.triangles.push_back({t[0], t[1], u[0]});
      mesh.triangles.push_back({t[0], u[0], u[1]});
    }
  };
  kinds["holes"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    for (int i = 0; i < 6; ++i) {
      const Vec3 at = mesh.vertices[any(random, mesh.vertices.size())];
      const double radius = chance(random, 0.003, 0.010);
      const bool is_face = at.z() > 0.05 && std::abs(at.x()) < 0.05;  // features are kept
      if (is_face) continue;
      std::erase_if(mesh.triangles,
                    [&](const Triangle& t) { return (middle_of(mesh, t) - at).norm() < radius; });
    }
  };
  kinds["missing_triangles"] = [](Made& made, Random& random) {
    std::erase_if(skin_of(made).mesh.triangles, [&](const Triangle&) { return random() % 150 == 0; });
  };
  kinds["floating_bits"] = [](Made& made, Random& random) {
    TriangleMesh bits;
    for (int i = 0; i < 300; ++i) {
      const Vec3 at(chance(random, -0.15, 0.15), chance(random, -0.2, 0.2), chance(random, -0.15, 0.2));
      for (int k = 0; k < 3; ++k)
        bits.vertices.push_back(
            at + 0.002 * Vec3(chance(random, -1, 1), chance(random, -1, 1), chance(random, -1, 1)));
      bits.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    if (random() % 2) {
      made.pieces.push_back({"bits", bits});
    } else {
      skin_of(made).mesh = joined({skin_of(made).mesh, bits});
    }
    made.says = {"too small to be a part of the head"};
  };
  kinds["stray_vertices"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    for (int i = 0; i < 5; ++i)
      mesh.vertices.emplace_back(chance(random, -50, 50), chance(random, -50, 50), chance(random, -50, 50));
  };
  kinds["stray_triangle"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    const Vec3 at(chance(random, -3, 3), chance(random, -3, 3), chance(random, -3, 3));
    const int first = mesh.vertex_count();
    for (int k = 0; k < 3; ++k)
      mesh.vertices.push_back(at + 0.01 * Vec3(k == 0, k == 1, k == 2));
    mesh.triangles.push_back({first, first + 1, first + 2});
  };
  kinds["no_area"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    const size_t count = mesh.triangles.size();
    for (int i = 0; i < 200; ++i) {
      const Triangle t = mesh.triangles[any(random, count)];
      mesh.triangles.push_back({t[0], t[0], t[1]});
      mesh.vertices.push_back(
          0.5 * (mesh.vertices[static_cast<size_t>(t[0])] + mesh.vertices[static_cast<size_t>(t[1])]));
      mesh.triangles.push_back({t[0], mesh.vertex_count() - 1, t[1]});
    }
    made.says = {"stand on edges that two others share"};
  };
  kinds["collapsed_vertices"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    for (int i = 0; i < 80; ++i) {
      const Triangle t = mesh.triangles[any(random, mesh.triangles.size())];
      mesh.vertices[static_cast<size_t>(t[0])] = mesh.vertices[static_cast<size_t>(t[1])];
    }
    made.says = are_flat;
  };
  kinds["no_eyeballs"] = [](Made& made, Random&) {
    std::erase_if(made.pieces, [](const Piece& piece) { return piece.name.rfind("eye_", 0) == 0; });
  };
  kinds["left_eyeball_missing"] = [](Made& made, Random&) {
    std::erase_if(made.pieces, [](const Piece& piece) { return piece.name == "eye_left"; });
  };
  kinds["spikes"] = [](Made& made, Random& random) {
    TriangleMesh& mesh = skin_of(made).mesh;
    for (int i = 0; i < 4; ++i) {
      Vec3& p = mesh.vertices[any(random, mesh.vertices.size())];
      if (p.z() < 0.03) p *= chance(random, 1.5, 4.0);
    }
  };
}

const std::map<std::string, Break>& kinds() {
  static const std::map<std::string, Break> all = [] {
    std::map<std::string, Break> made;
    made["sound"] = [](Made&, Random&) {};
    add_ways_to_cut(made);
    add_ways_to_layer(made);
    add_ways_to_turn(made);
    add_blemishes(made);
    add_ruins(made);
    return made;
  }();
  return all;
}

}  // namespace

std::vector<std::string> broken_kinds() {
  std::vector<std::string> names;
  for (const auto& [name, make] : kinds())
    names.push_back(name);
  return names;
}

BrokenHead broken_head(const std::string& kind, unsigned seed) {
  uint32_t mixed = seed;
  for (const char c : kind)
    mixed = mixed * 31 + static_cast<unsigned char>(c);
  Random random(mixed);
  Made made;
  for (const anatomy::MeshObject& object : generic_head())
    made.pieces.push_back({object.name, object.mesh});
  kinds().at(kind)(made, random);
  const Mat3 turn = (Eigen::AngleAxisd(chance(random, -0.15, 0.15), Vec3::UnitY()) *
                     Eigen::AngleAxisd(chance(random, -0.15, 0.15), Vec3::UnitX()))
                        .toRotationMatrix();
  const double units[] = {1.0, 100.0, 1000.0};
  const double unit = units[random() % 3];
  // A head that a node mirrors is turned by none, for the halves would no longer meet.
  const bool is_mirrored = std::any_of(made.pieces.begin(), made.pieces.end(),
                                       [](const Piece& piece) { return piece.scale.x() < 0.0; });
  Mat4 to_file = Mat4::Identity();
  to_file.topLeftCorner<3, 3>() = unit * (is_mirrored ? Mat3(Mat3::Identity()) : turn);
  for (Piece& piece : made.pieces)
    for (Vec3& p : piece.mesh.vertices)
      p = transform_point(to_file, p);
  return {kind, kind + ".glb", glb_of(made.pieces), made.is_usable, made.says, made.is_cut, to_file};
}

}  // namespace fascia::testing

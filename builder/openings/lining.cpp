#include "builder/openings/lining.h"

#include <algorithm>
#include <cmath>

namespace fascia::openings {

namespace {

constexpr double close_share = 0.25;  // of the way to the first ring

/// A closed ring of vertices with their places around it, ascending from 0; the first is repeated at 2.
struct Ring {
  std::vector<int> vertices;
  std::vector<double> around;
  void add(int vertex, double place) {
    vertices.push_back(vertex);
    around.push_back(place);
  }
  void close() { add(vertices.front(), 2.0); }
};

/// Triangles between two rings, always going on where the places around lag behind.
void span_rings(const Ring& front, const Ring& back, std::vector<Triangle>& triangles) {
  size_t i = 0, j = 0;
  while (i + 1 < front.vertices.size() || j + 1 < back.vertices.size()) {
    const bool front_ends = i + 1 == front.vertices.size(), back_ends = j + 1 == back.vertices.size();
    const double next_front = front_ends ? 3.0 : 0.5 * (front.around[i] + front.around[i + 1]),
                 next_back = back_ends ? 3.0 : 0.5 * (back.around[j] + back.around[j + 1]);
    if (next_front <= next_back) {
      triangles.push_back({front.vertices[i + 1], front.vertices[i], back.vertices[j]});
      ++i;
    } else {
      triangles.push_back({front.vertices[i], back.vertices[j], back.vertices[j + 1]});
      ++j;
    }
  }
}

/// Fills in `around` by the lengths of both sides; the left corner is vertex `left`.
void measure(Rim& rim, size_t left) {
  const size_t count = rim.vertices.size();
  std::vector<double> lengths(count + 1, 0.0);
  for (size_t i = 0; i < count; ++i)
    lengths[i + 1] = lengths[i] + (rim.places[(i + 1) % count] - rim.places[i]).norm();
  const double upper = std::max(lengths[left], 1e-12),
               lower = std::max(lengths[count] - lengths[left], 1e-12);
  for (size_t i = 0; i < count; ++i)
    rim.around.push_back(i <= left ? lengths[i] / upper : 1.0 + (lengths[i] - lengths[left]) / lower);
}

size_t nearest(const Rim& rim, double around) {
  size_t best = 0;
  double least = 9.0;
  for (size_t i = 0; i < rim.around.size(); ++i) {
    const double off = std::abs(rim.around[i] - around), distance = std::min(off, 2.0 - off);
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

}  // namespace

Vec3 Rim::at(double place) const {
  const auto after = std::upper_bound(around.begin(), around.end(), place);
  const auto i = static_cast<size_t>(std::max<std::ptrdiff_t>(0, after - around.begin() - 1));
  const size_t j = (i + 1) % places.size();
  const double end = j == 0 ? 2.0 : around[j];
  const double t = std::clamp((place - around[i]) / std::max(1e-12, end - around[i]), 0.0, 1.0);
  return (1.0 - t) * places[i] + t * places[j];
}

Rim rim_of(const TriangleMesh& mesh, const Cut& cut) {
  Rim rim;
  const size_t count = cut.path.nodes.size();
  const auto add = [&](size_t node, int vertex) {
    rim.vertices.push_back(vertex);
    rim.places.push_back(position(mesh, cut.path.nodes[node]));
  };
  for (size_t i = 0; i < count; ++i)
    add(i, cut.upper[i]);
  for (size_t i = count - 2; i > 0; --i)
    add(i, cut.lower[i]);
  measure(rim, count - 1);
  return rim;
}

Rim rim_of(const TriangleMesh& mesh, const std::vector<int>& loop, const MeetingLine& line) {
  const size_t count = loop.size();
  const auto along = [&](size_t i) {
    return line.along(mesh.vertices[static_cast<size_t>(loop[i % count])]);
  };
  size_t right = 0, left = 0;
  for (size_t i = 1; i < count; ++i) {
    if (along(i) < along(right)) right = i;
    if (along(i) > along(left)) left = i;
  }
  // The border's direction is that of its triangles: seen from the front, with the hole to its right.
  double side[2] = {0.0, 0.0};
  size_t steps[2] = {0, 0};
  for (size_t i = (right + 1) % count; i != left; i = (i + 1) % count, ++steps[0])
    side[0] += line.above(mesh.vertices[static_cast<size_t>(loop[i])]);
  for (size_t i = (right + count - 1) % count; i != left; i = (i + count - 1) % count, ++steps[1])
    side[1] += line.above(mesh.vertices[static_cast<size_t>(loop[i])]);
  const bool is_forward = side[0] / static_cast<double>(std::max<size_t>(1, steps[0])) >=
                          side[1] / static_cast<double>(std::max<size_t>(1, steps[1]));
  Rim rim;
  for (size_t i = 0; i < count; ++i) {
    const int v = loop[is_forward ? (right + i) % count : (right + count - i) % count];
    rim.vertices.push_back(v);
    rim.places.push_back(mesh.vertices[static_cast<size_t>(v)]);
  }
  measure(rim, is_forward ? (left + count - right) % count : (right + count - left) % count);
  return rim;
}

int lining_columns(const Rim& rim) {
  return 2 * std::clamp(static_cast<int>(rim.vertices.size()) / 4, 8, 24);
}

Lining span_lining(const Rim& rim, int first, int rings, int columns, const RingPlace& place,
                   const Vec3& end) {
  Lining lining;
  Ring last;
  for (size_t i = 0; i < rim.vertices.size(); ++i)
    last.add(rim.vertices[i], rim.around[i]);
  last.close();
  const auto add = [&](const Vec3& p, double around) {
    lining.vertices.push_back(p);
    lining.like.push_back(rim.vertices[nearest(rim, around)]);
    return first + static_cast<int>(lining.vertices.size()) - 1;
  };
  // Close behind the rim it is as fine as the rim: a coarse one would show before it where it bends, and its
  // large triangles would turn the rim's normals.
  Ring close;
  for (size_t i = 0; i < rim.vertices.size(); ++i)
    close.add(add((1.0 - close_share) * rim.places[i] + close_share * place(1, rim.around[i]), rim.around[i]),
              rim.around[i]);
  close.close();
  span_rings(last, close, lining.triangles);
  last = std::move(close);
  for (int ring = 1; ring <= rings; ++ring) {
    Ring next;
    for (int column = 0; column < columns; ++column) {
      const double around = 2.0 * column / columns;
      next.add(add(place(ring, around), around), around);
    }
    next.close();
    span_rings(last, next, lining.triangles);
    last = std::move(next);
  }
  const int middle = add(end, 0.5);
  for (size_t i = 0; i + 1 < last.vertices.size(); ++i)
    lining.triangles.push_back({last.vertices[i + 1], last.vertices[i], middle});
  return lining;
}

}  // namespace fascia::openings

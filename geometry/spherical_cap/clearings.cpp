#include "geometry/spherical_cap/clearings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "geometry/spherical_cap/spherical_cap_methods.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

constexpr int margin_cells = 2;            // margin beyond the edges of a face of the grid
constexpr double members_per_cell = 1.35;  // at the centre of a face, for an even distribution
constexpr int probe_stride = 3;            // squares between probes
constexpr int max_cells = 4096;            // per edge of the cube
constexpr std::size_t few_parts = 16;      // fewer parts are not subdivided further
constexpr std::size_t many_parts =
    300;                              // with more parts, testing each of them per facet is too slow
constexpr double min_progress = 0.7;  // maximum fraction of parts remaining after a useful round
constexpr int max_rounds = 10;        // each round halves the parts
constexpr std::size_t squares_per_member = 12;  // maximum number of evaluated squares
constexpr double parts_rounding = 1e-7;         // for sums of square roots of cosine differences

// Tolerance of the unit length of directions.
constexpr double length_tolerance = 1e-6;
constexpr double largest_length = 1.0 + 1.1 * length_tolerance;
constexpr double smallest_length = 1.0 - 1.1 * length_tolerance;

/// Position on one of the six faces of the cube [-1, 1]^3. In the local coordinates of a face, the
/// face lies at z = 1.
struct FacePoint {
  int face;
  double x, y;

  Vector3d on_cube() const { return {x, y, 1.0}; }  // in local coordinates of the face
};

Vector3d world_from_face(int face, const Vector3d& on_face) {
  const int axis = face / 2;
  Vector3d in_world;
  in_world[axis] = face % 2 == 0 ? -on_face.z() : on_face.z();
  in_world[(axis + 1) % 3] = on_face.x();
  in_world[(axis + 2) % 3] = on_face.y();
  return in_world;
}

Vector3d face_from_world(int face, const Vector3d& in_world) {
  const int axis = face / 2;
  const double height = face % 2 == 0 ? -in_world[axis] : in_world[axis];
  return {in_world[(axis + 1) % 3], in_world[(axis + 2) % 3], height};
}

/// Members sorted into square cells on the faces of the cube. A member within the margin beyond the
/// edges of another face is also stored there.
class CubeGrid {
 public:
  CubeGrid(std::span<const Vector3d> members, int cells_per_edge);

  /// Returns whether a cell inside the face contains a member.
  bool contains_any(int face, int column, int row) const {
    const std::size_t cell = cell_at(face, column + margin_cells, row + margin_cells);
    return cell_begin_[cell + 1] > cell_begin_[cell];
  }

  /// Returns whether `predicate` returns true for a member near `face_point`. Tests all members
  /// within `radius`, except for some beyond the margin, and tests close members early. `predicate`
  /// receives local coordinates of the face.
  template <typename Predicate>
  bool any_around(const FacePoint& face_point, double radius, Predicate predicate) const;

 private:
  int slot(double coordinate) const {
    return std::clamp(static_cast<int>((coordinate + reach_) * scale_), 0, slots_ - 1);
  }
  std::size_t cell_at(int face, int column, int row) const {
    return static_cast<std::size_t>((face * slots_ + row) * slots_ + column);
  }

  int slots_;     // per edge of a face, including margins
  double reach_;  // maximum coordinate on a face, including the margin
  double scale_;  // slots per unit length
  std::vector<Vector3d> members_;
  std::vector<std::uint32_t> cell_begin_;
};

CubeGrid::CubeGrid(std::span<const Vector3d> members, int cells_per_edge)
    : slots_(cells_per_edge + 2 * margin_cells),
      reach_(1.0 + 2.0 * margin_cells / cells_per_edge),
      scale_(0.5 * cells_per_edge) {
  struct Entry {
    std::uint32_t member, cell;
    int face;
  };
  std::vector<Entry> entries;
  entries.reserve(members.size() + members.size() / 4);
  cell_begin_.assign(cell_at(6, 0, 0) + 1, 0);
  for (std::size_t i = 0; i < members.size(); ++i) {
    const Vector3d& q = members[i];
    const std::array<double, 5> coordinates{q.x(), q.y(), q.z(), q.x(), q.y()};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double x = coordinates[axis + 1], y = coordinates[axis + 2];
      const double height = std::abs(coordinates[axis]), limit = reach_ * height;
      if (std::abs(x) > limit || std::abs(y) > limit) continue;
      const int face = static_cast<int>(2 * axis) + (coordinates[axis] > 0.0 ? 1 : 0);
      const double scale = 1.0 / height;
      const std::size_t cell = cell_at(face, slot(x * scale), slot(y * scale));
      entries.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(cell), face});
      ++cell_begin_[cell];
    }
  }
  std::uint32_t end = 0;
  for (std::uint32_t& begin : cell_begin_) begin = end += begin;
  members_.resize(entries.size());
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
    members_[--cell_begin_[entry->cell]] = face_from_world(entry->face, members[entry->member]);
  }
}

template <typename Predicate>
bool CubeGrid::any_around(const FacePoint& face_point, double radius, Predicate predicate) const {
  // Upper bound of the magnification of a small circle by the projection from the sphere to the
  // face.
  const double half = radius * (1.0 + face_point.x * face_point.x + face_point.y * face_point.y);
  const int left = slot(face_point.x - half), right = slot(face_point.x + half);
  const auto any_in_row = [&](int row) {
    const std::uint32_t end = cell_begin_[cell_at(face_point.face, right + 1, row)];
    for (std::uint32_t i = cell_begin_[cell_at(face_point.face, left, row)]; i < end; ++i) {
      if (predicate(members_[i])) return true;
    }
    return false;
  };
  const int bottom = slot(face_point.y - half), top = slot(face_point.y + half),
            middle = slot(face_point.y);
  if (any_in_row(middle)) return true;
  for (int away = 1; away <= std::max(middle - bottom, top - middle); ++away) {
    if (middle - away >= bottom && any_in_row(middle - away)) return true;
    if (middle + away <= top && any_in_row(middle + away)) return true;
  }
  return false;
}

class Search {
 public:
  Search(DirectionIndex& occluded, double cosine, int cells_per_edge)
      : occluded_(occluded),
        grid_(occluded.members(), cells_per_edge),
        edge_(2.0 / cells_per_edge),
        cell_diagonal_(edge_ * std::numbers::sqrt2) {
    set_cosine(cosine);
  }

  double cosine() const { return cosine_; }

  /// Evaluates directions distributed over the sphere. A better initial direction lets more squares
  /// be discarded early.
  void probe() {
    visit_squares(probe_stride, [this](const FacePoint& middle) { try_direction(middle); });
  }

  void cover_the_cube() {
    visit_squares(1, [this](const FacePoint& middle) { keep_if_clear(middle); });
  }

  void cut_in_four() {
    edge_ *= 0.5;
    std::vector<FacePoint> before;
    before.swap(clear_);
    for (const auto& [face, x, y] : before) {
      for (const double up : {-0.5, 0.5}) {
        for (const double right : {-0.5, 0.5}) {
          keep_if_clear({face, x + right * edge_, y + up * edge_});
        }
      }
    }
  }

  std::size_t size() const { return clear_.size(); }  ///< remaining squares
  std::size_t squares() const { return squares_; }    ///< evaluated squares

  std::vector<SpherePart> parts() const {
    std::vector<SpherePart> parts;
    for (const FacePoint& face_point : clear_) {
      const Vector3d middle = face_point.on_cube();
      parts.push_back({world_from_face(face_point.face, middle.normalized()),
                       compute_square_radius(middle.norm())});
    }
    return parts;
  }

 private:
  void set_cosine(double cosine) {
    cosine_ = cosine;
    clear_radius_ = std::sqrt(std::max(0.0, 2.0 - 2.0 * cosine));
    limit_ = cosine + cap_tolerance;
    limit_sine_ = std::sqrt(std::max(0.0, largest_length * largest_length - limit_ * limit_));
    // |s - q|^2 = 1 + |q|^2 - 2 s.q
    const double too_near2 = 1.0 + smallest_length * smallest_length - 2.0 * limit_;
    is_cell_too_near_ = too_near2 > 0.0 && cell_diagonal_ + length_tolerance < std::sqrt(too_near2);
  }

  // Returns the maximum distance of points of a square from its centre, after projection to the
  // sphere: half the diagonal divided by the distance from the origin. `norm` is the norm of the
  // centre.
  double compute_square_radius(double norm) const {
    const double half_diagonal = edge_ / std::numbers::sqrt2;
    return half_diagonal / (norm - half_diagonal);
  }

  template <typename Visit>
  void visit_squares(int stride, Visit visit) const {
    const int squares = static_cast<int>(std::lround(2.0 / edge_));
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < squares; row += stride) {
        for (int column = 0; column < squares; column += stride) {
          if (is_cell_too_near_ && grid_.contains_any(face, column, row)) continue;
          visit({face, (column + 0.5) * edge_ - 1.0, (row + 0.5) * edge_ - 1.0});
        }
      }
    }
  }

  // Returns whether place.q exceeds `product` for a member q near `face_point`. Tests at least all
  // members within `radius`.
  bool is_any_above(double product, const FacePoint& face_point, double radius) const {
    const Vector3d on_cube = face_point.on_cube();
    return grid_.any_around(face_point, radius,
                            [&](const Vector3d& q) { return on_cube.dot(q) > product; });
  }

  void try_direction(const FacePoint& face_point) {
    const Vector3d on_cube = face_point.on_cube();
    if (is_any_above(cosine_ * on_cube.norm(), face_point, clear_radius_)) return;
    const Vector3d direction = world_from_face(face_point.face, on_cube.normalized());
    const double cosine = occluded_.nearest(direction).cosine;
    if (cosine < cosine_) set_cosine(cosine);
  }

  void keep_if_clear(const FacePoint& middle) {
    ++squares_;
    const double norm = middle.on_cube().norm(), radius = compute_square_radius(norm);
    // All s of the square are within the angle b of its centre. Hence a member q at the angle c
    // from the centre satisfies s.q >= |q| cos(c + b). This exceeds the limit if the product of the
    // centre and q exceeds the following value. The radius is slightly larger than sin b.
    const double cos_b = 1.0 - 0.5 * radius * radius;
    const double enough = limit_ * cos_b + limit_sine_ * radius;
    if (is_any_above(enough * norm, middle, std::max(0.0, clear_radius_ - radius))) return;
    clear_.push_back(middle);
    try_direction(middle);
  }

  DirectionIndex& occluded_;
  CubeGrid grid_;
  double edge_;                    // edge length of the squares
  double cell_diagonal_;           // diagonal of the grid cells
  double cosine_;                  // h of the clearest direction found
  double clear_radius_ = 0.0;      // radius of its cap
  double limit_ = 0.0;             // squares with h above this limit are discarded
  double limit_sine_ = 0.0;        // sine that belongs to limit_ for a member of maximum length
  bool is_cell_too_near_ = false;  // each member violates the limit for every s in its grid cell
  std::size_t squares_ = 0;
  std::vector<FacePoint> clear_;  // centres of the kept squares
};

}  // namespace

bool Clearings::meet(const Vector3d& normal, double cap_cosine) const {
  const double cap_radius = std::sqrt(std::max(0.0, 2.0 - 2.0 * cap_cosine));
  return std::any_of(parts.begin(), parts.end(), [&](const SpherePart& part) {
    const double reach = cap_radius + part.radius + parts_rounding;
    return 2.0 - 2.0 * part.centre.dot(normal) <= reach * reach;
  });
}

Clearings find_clearings(DirectionIndex& occluded, double cosine) {
  // The cell size is the radius of the known cap, or larger so that evenly distributed members give
  // one or two per cell.
  const auto count = static_cast<double>(occluded.members().size());
  const double radius = std::sqrt(std::max(0.0, 2.0 - 2.0 * cosine));
  const double edge =
      std::max(radius, std::sqrt(members_per_cell * 4.0 * std::numbers::pi / count));
  Search search(occluded, cosine, std::clamp(static_cast<int>(2.0 / edge), 4, max_cells));
  search.probe();
  search.cover_the_cube();
  const auto max_squares = squares_per_member * occluded.members().size();
  for (int round = 0; round < max_rounds && search.size() > few_parts; ++round) {
    if (search.squares() + 4 * search.size() > max_squares) break;
    const std::size_t before = search.size();
    search.cut_in_four();
    const bool is_stuck =
        static_cast<double>(search.size()) > min_progress * static_cast<double>(before);
    if (is_stuck && search.size() <= many_parts) break;
  }
  if (search.size() > many_parts) return {{{Vector3d::UnitZ(), 2.0}}, search.cosine()};
  return {search.parts(), search.cosine()};
}

}  // namespace skycap::geometry

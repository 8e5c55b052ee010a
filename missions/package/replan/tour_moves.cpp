#include "missions/package/replan/tour_moves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/pose/pose.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using geometry::View;

/// Frequency of each kind of move [%].
constexpr std::size_t shifts = 56, drops = 6, replacements = 10, joins = 10, additions = 4,
                      carries = 7;  // The remaining moves reverse a part of the tour.
/// Frequency of moves that add a view en route in fly-through capture [%].
constexpr std::size_t en_route_additions = 20;
/// Standard deviations of small and large shifts of a view and of shifts of its aim, in view
/// distances.
constexpr double small_shift = 0.036, large_shift = 0.12, aim_shift = 0.1;
constexpr double large_share = 0.4;  ///< Fraction of large shifts.
/// Range of distances of new views from their targets in view distances, and maximum angle to the
/// normal.
constexpr double nearest = 0.4, farthest = 1.3, max_tilt = 1.22;  // 70 degrees
/// New views observe the target with the most missing area out of this number of random targets.
constexpr int targets_drawn = 6;

}  // namespace

std::shared_ptr<Stop> TourMoves::stop(const View& view) {
  return std::make_shared<Stop>(Stop{view, ++stops_made_});
}

std::size_t TourMoves::below(std::size_t end) {
  return static_cast<std::size_t>(random_.uniform() * static_cast<double>(end));
}

std::optional<Move> TourMoves::propose(const Stops& stops, const ObservationSum& covered,
                                       double scale) {
  if (stops.empty()) return add(stops, covered);
  if (problem_.bend_time && below(100) < en_route_additions) return add_en_route(stops, covered);
  std::size_t kind = below(100);
  const auto is_drawn = [&](std::size_t share) {
    if (kind < share) return true;
    kind -= share;
    return false;
  };
  if (is_drawn(shifts)) return shift(stops, scale);
  if (is_drawn(drops)) return drop(stops);
  if (is_drawn(replacements)) return replace(stops, covered);
  if (is_drawn(joins)) return join(stops);
  if (is_drawn(additions)) return add(stops, covered);
  if (is_drawn(carries)) return carry(stops);
  return turn(stops);
}

std::uint32_t TourMoves::missing_target(const ObservationSum& covered) {
  auto best = static_cast<std::uint32_t>(below(covered.size()));
  for (int i = 1; i < targets_drawn; ++i) {
    const auto other = static_cast<std::uint32_t>(below(covered.size()));
    if (covered.missing(other) > covered.missing(best)) best = other;
  }
  return best;
}

std::optional<View> TourMoves::find_missing_surface_view(const ObservationSum& covered) {
  const auto& target = problem_.targets[missing_target(covered)];
  const Vector3d normal = target.normal.cast<double>();
  const Vector3d u = geometry::any_orthogonal(normal), v = normal.cross(u);
  const double tilt = max_tilt * std::sqrt(random_.uniform());
  const double azimuth = 2.0 * std::numbers::pi * random_.uniform();
  const Vector3d towards =
      std::cos(tilt) * normal + std::sin(tilt) * (std::cos(azimuth) * u + std::sin(azimuth) * v);
  return problem_.find_view(target.position.cast<double>(), towards,
                            problem_.view_distance * random_.between(nearest, farthest));
}

View TourMoves::shifted(const View& view, double shift, double aim) {
  const auto drawn = [&](double sigma) {
    const double x = random_.normal(), y = random_.normal();
    return Vector3d(sigma * Vector3d(x, y, random_.normal()));
  };
  const double d = problem_.view_distance;
  const Vector3d target = view.position + d * view.direction + drawn(aim * d);
  const Vector3d position = view.position + drawn(shift * d);
  return geometry::look_at(position, target);
}

std::optional<Move> TourMoves::shift(const Stops& stops, double scale) {
  const std::size_t i = below(stops.size());
  const double step = random_.uniform() < large_share ? large_shift : small_shift;
  // Shifts the aim, the position, or both.
  const std::size_t which = below(3);
  const View view = shifted(stops[i]->view, which == 0 ? 0.0 : scale * step,
                            which == 1 ? 0.0 : scale * aim_shift);
  Move move{stops, {stops[i]}, stop(view)};
  move.stops[i] = move.added;
  return move;
}

std::optional<Move> TourMoves::drop(const Stops& stops) {
  const std::size_t i = below(stops.size());
  Move move{stops, {stops[i]}};
  move.stops.erase(move.stops.begin() + static_cast<std::ptrdiff_t>(i));
  return move;
}

std::optional<Move> TourMoves::replace(const Stops& stops, const ObservationSum& covered) {
  const auto view = find_missing_surface_view(covered);
  if (!view) return std::nullopt;
  std::optional<Move> move = drop(stops);
  insert(*move, *view);
  return move;
}

std::optional<Move> TourMoves::join(const Stops& stops) {
  if (stops.size() < 2) return std::nullopt;
  const std::size_t i = below(stops.size() - 1);
  const View &a = stops[i]->view, &b = stops[i + 1]->view;
  const double share = random_.uniform(), d = problem_.view_distance;
  const Vector3d position = a.position + share * (b.position - a.position);
  const Vector3d aim = a.position + d * a.direction +
                       share * (b.position - a.position + d * (b.direction - a.direction));
  if ((aim - position).norm() < 0.1 * d) return std::nullopt;  // The views face each other.
  const View between = shifted(geometry::look_at(position, aim), large_shift, aim_shift);
  Move move{stops, {stops[i], stops[i + 1]}, stop(between)};
  move.stops[i] = move.added;
  move.stops.erase(move.stops.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  return move;
}

std::optional<Move> TourMoves::add(const Stops& stops, const ObservationSum& covered) {
  const auto view = find_missing_surface_view(covered);
  if (!view) return std::nullopt;
  Move move{stops, {}};
  insert(move, *view);
  return move;
}

/// Adds a view where the path is closest to the best position for observing the target, with a
/// random offset along the path.
std::optional<Move> TourMoves::add_en_route(const Stops& stops, const ObservationSum& covered) {
  constexpr double beside = 0.2;  // Standard deviation in view distances.
  const auto& target = problem_.targets[missing_target(covered)];
  const Vector3d seen = target.position.cast<double>();
  const Vector3d best = seen + problem_.view_distance * target.normal.cast<double>();
  std::size_t leg = 0;
  Vector3d leg_point = problem_.home;
  for (std::size_t i = 0; i <= stops.size(); ++i) {
    const Vector3d from = leg_end(stops, i), displacement = leg_end(stops, i + 1) - from;
    const double share = displacement.squaredNorm() > 0.0
                             ? displacement.dot(best - from) / displacement.squaredNorm()
                             : 0.0;
    const Vector3d on_leg = from + std::clamp(share, 0.0, 1.0) * displacement;
    if (i == 0 || (on_leg - best).norm() < (leg_point - best).norm()) leg = i, leg_point = on_leg;
  }
  const Vector3d displacement = leg_end(stops, leg + 1) - leg_end(stops, leg);
  if (displacement.norm() == 0.0) return std::nullopt;
  leg_point += beside * problem_.view_distance * random_.normal() * displacement.normalized();
  if ((leg_point - seen).norm() < nearest * problem_.view_distance) return std::nullopt;
  Move move{stops, {}, stop(geometry::look_at(leg_point, seen))};
  move.stops.insert(move.stops.begin() + static_cast<std::ptrdiff_t>(leg), move.added);
  return move;
}

std::optional<Move> TourMoves::carry(const Stops& stops) {
  const std::size_t count = 1 + below(3);
  if (stops.size() <= count) return std::nullopt;
  const std::size_t first = below(stops.size() - count + 1);
  const auto begin = stops.begin() + static_cast<std::ptrdiff_t>(first);
  Stops chain(begin, begin + static_cast<std::ptrdiff_t>(count));
  if (random_.uniform() < 0.5) std::ranges::reverse(chain);
  Move move{stops, {}};
  const auto from = move.stops.begin() + static_cast<std::ptrdiff_t>(first);
  move.stops.erase(from, from + static_cast<std::ptrdiff_t>(count));
  const std::size_t to = below(move.stops.size() + 1);
  move.stops.insert(move.stops.begin() + static_cast<std::ptrdiff_t>(to), chain.begin(),
                    chain.end());
  return move;
}

std::optional<Move> TourMoves::turn(const Stops& stops) {
  if (stops.size() < 2) return std::nullopt;
  std::size_t first = below(stops.size()), last = below(stops.size());
  if (first > last) std::swap(first, last);
  Move move{stops, {}};
  std::reverse(move.stops.begin() + static_cast<std::ptrdiff_t>(first),
               move.stops.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  return move;
}

/// Returns the start of leg `leg`, which is the end of the previous leg.
Vector3d TourMoves::leg_end(const Stops& stops, std::size_t leg) const {
  return leg == 0 || leg == stops.size() + 1 ? problem_.home : stops[leg - 1]->view.position;
}

/// Inserts the view at the position with the smallest detour.
void TourMoves::insert(Move& move, const View& view) {
  const auto leg_point = [&](std::size_t i) { return leg_end(move.stops, i); };
  std::size_t best = 0;
  double min = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i <= move.stops.size(); ++i) {
    const double detour = (view.position - leg_point(i)).norm() +
                          (leg_point(i + 1) - view.position).norm() -
                          (leg_point(i + 1) - leg_point(i)).norm();
    if (detour < min) best = i, min = detour;
  }
  move.added = stop(view);
  move.stops.insert(move.stops.begin() + static_cast<std::ptrdiff_t>(best), move.added);
}

}  // namespace skycap::missions::package

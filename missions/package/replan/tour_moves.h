/// Proposals of how a tour might be changed: the moves that the search tries.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/random_numbers.h"
#include "missions/package/replan/leg_times.h"
#include "missions/package/replan/tour_problem.h"

namespace skycap::missions::package {

/// A tour that differs from another in these stops.
struct Move {
  Stops stops;                    ///< of the changed tour
  Stops removed;                  ///< of the other one
  std::shared_ptr<Stop> added{};  ///< what it brings is not known yet; null: none
};

/// Keeps references to problem and numbers.
class TourMoves {
 public:
  TourMoves(const TourProblem& problem, geometry::RandomNumbers& random)
      : problem_(problem), random_(random) {}

  /// A stop of this search.
  std::shared_ptr<Stop> stop(const geometry::View& view);

  /// Moves one view and its aim, by steps of `scale` (1 at first, less as the search settles);
  /// drops one, replaces one by any other or two by one, adds one, takes one or several to another
  /// place in the order, or turns a part of it round. `covered` is what the tour covers. Nothing if
  /// what was drawn cannot be.
  std::optional<Move> propose(const Stops& stops, const DoseSum& covered, double scale);

 private:
  std::size_t below(std::size_t end);
  std::uint32_t missing_target(const DoseSum& covered);
  std::optional<geometry::View> view_of_missing(const DoseSum& covered);
  geometry::View shifted(const geometry::View& view, double shift, double aim_shift);
  std::optional<Move> shift(const Stops& stops, double scale);
  std::optional<Move> drop(const Stops& stops);
  std::optional<Move> replace(const Stops& stops, const DoseSum& covered);
  std::optional<Move> join(const Stops& stops);
  std::optional<Move> add(const Stops& stops, const DoseSum& covered);
  std::optional<Move> add_on_way(const Stops& stops, const DoseSum& covered);
  std::optional<Move> carry(const Stops& stops);
  std::optional<Move> turn(const Stops& stops);
  Eigen::Vector3d end_of_leg(const Stops& stops, std::size_t leg) const;
  void insert(Move& move, const geometry::View& view);

  const TourProblem& problem_;
  geometry::RandomNumbers& random_;
  std::uint32_t stops_made_ = 0;
};

}  // namespace skycap::missions::package

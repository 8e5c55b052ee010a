/// Random modifications of a tour (moves) for the search.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/random_numbers.h"
#include "missions/package/replan/leg_times.h"
#include "missions/package/replan/tour_problem.h"

namespace skycap::missions::package {

/// Modified tour and its difference from the original.
struct Move {
  Stops stops;                    ///< Stops of the modified tour.
  Stops removed;                  ///< Stops of the original that were removed.
  std::shared_ptr<Stop> added{};  ///< New stop without computed doses; null for moves without one.
};

/// Generator of random moves. Keeps references to `problem` and `random`.
class TourMoves {
 public:
  TourMoves(const TourProblem& problem, geometry::RandomNumbers& random)
      : problem_(problem), random_(random) {}

  /// Creates a stop with a unique number.
  std::shared_ptr<Stop> stop(const geometry::View& view);

  /// Draws a random move. A move shifts a view and its aim, removes a view, replaces a view, joins
  /// two views into one, or adds a view. It may also move a sequence of views to another position
  /// in the order or reverse a part of the tour. `scale` is the relative step size, which starts at
  /// 1 and decreases. `covered` is the coverage of the tour. Returns an empty value if the drawn
  /// move is not possible.
  std::optional<Move> propose(const Stops& stops, const ObservationSum& covered, double scale);

 private:
  std::size_t below(std::size_t end);
  std::uint32_t missing_target(const ObservationSum& covered);
  std::optional<geometry::View> find_missing_surface_view(const ObservationSum& covered);
  geometry::View shifted(const geometry::View& view, double shift, double aim_shift);
  std::optional<Move> shift(const Stops& stops, double scale);
  std::optional<Move> drop(const Stops& stops);
  std::optional<Move> replace(const Stops& stops, const ObservationSum& covered);
  std::optional<Move> join(const Stops& stops);
  std::optional<Move> add(const Stops& stops, const ObservationSum& covered);
  std::optional<Move> add_en_route(const Stops& stops, const ObservationSum& covered);
  std::optional<Move> carry(const Stops& stops);
  std::optional<Move> turn(const Stops& stops);
  Eigen::Vector3d leg_end(const Stops& stops, std::size_t leg) const;
  void insert(Move& move, const geometry::View& view);

  const TourProblem& problem_;
  geometry::RandomNumbers& random_;
  std::uint32_t stops_made_ = 0;
};

}  // namespace skycap::missions::package

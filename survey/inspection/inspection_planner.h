/// Planner of inspection flights: a continuous flight that sees a known structure in the fewest
/// seconds, without stops, at a clearance.
///
/// The structure is a set of points with normals and discs. A first tour joins viewpoints of a
/// greedy cover. Several independent searches (route_search.h) change the polygon of a smoothed
/// route, with seconds as the cost. The shortest verified flight is returned.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "survey/inspection/flight_evaluation.h"
#include "survey/inspection/reachable_space.h"
#include "survey/inspection/route_search.h"
#include "survey/inspection/sight_rules.h"
#include "survey/inspection/smooth_route.h"

namespace skycap::survey::inspection {

struct InspectionOptions {
  InspectionCamera camera;
  MotionLimits limits;
  CoverageGoal goal;
  PitchRange pitch;
  double clearance = 3.0;  ///< Distance from all obstacles at every moment [m].
  /// Distance by which the flown curve may leave the planned one. It is kept in addition to the
  /// clearance [m].
  double flown_deviation = 0.0;
  std::size_t moves = 60'000;     ///< Budget of each search, in tried moves.
  std::size_t searches = 2;       ///< Independent searches with different seeds.
  std::size_t candidates = 2500;  ///< Random positions of viewpoints for the first tour.

  /// Distance from all obstacles that the planned curve keeps [m].
  double planned_clearance() const { return clearance + flown_deviation; }
  /// Throws Error{bad_config} naming the first value outside its interval.
  void validate() const;
};

/// Returns the smallest distance between a segment and all obstacles, at most `up_to` [m]. Must be
/// thread-safe.
using SegmentDistance =
    std::function<double(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double up_to)>;

/// Structure and the space around it. Mission frame [m], z up.
struct InspectionSite {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< Normals of the points. Empty: computed from them.
  /// Obstacles, including the structure. Null: the points of the structure.
  ObstacleDistance distance;
  FreePosition is_free;              ///< Null: at least the clearance from all obstacles.
  SegmentDistance segment_distance;  ///< For the verification. Null: the points of the structure.
  std::optional<double> min_height, max_height;  ///< z [m]
};

/// Parameters of one run of the planner.
struct InspectionRun {
  std::uint64_t seed = 1;
  unsigned threads = 1;  ///< Zero: all processors. Does not affect the plan.
  std::stop_token stop{};
  std::function<void(const std::string& what)> report{};  ///< Progress messages. May be null.
};

struct InspectionPlan {
  std::vector<Vertex> vertices;
  Smoothing smoothing;
  std::vector<FlightSample> samples;  ///< Flight every sample_interval.
  StructureCloud cloud;               ///< Points that the evaluation refers to.
  FlightEvaluation evaluation;
  PerRule<std::size_t> attainable{};  ///< Points that some position sees, a lower bound.
  /// By the planner's count, which is conservative, and by the evaluation.
  bool meets_goal = false;
  double verified_clearance = 0.0;  ///< Verified distance from all obstacles [m].
  double first_duration = 0.0;      ///< Duration of the first tour [s].
  std::size_t search = 0;           ///< Search that found the flight.
  std::size_t evaluated_moves = 0;  ///< Over all searches.
  std::size_t cells = 0;            ///< Computed cells of visibility.
};

/// Interval of the samples of a plan [s].
inline constexpr double sample_interval = 0.1;

/// Plans an inspection flight. The result depends only on options, site and seed. Throws
/// Error{bad_config} for invalid options, and if the range does not exceed the clearance. Throws
/// Error{bad_geometry} if nothing is reachable or visible, or if no flight of the searches keeps
/// the limits and the clearance. Throws Interrupted after a stop request.
InspectionPlan plan_inspection(const InspectionOptions& options, const InspectionSite& site,
                               const InspectionRun& run);

/// Requirement that a flight along a given polygon violates.
struct FlightProblem {
  std::optional<std::size_t> leg;  ///< From vertex `leg` to the next one. Empty: whole flight.
  std::string what;
};

/// Flight along a given polygon.
struct GivenPlan {
  InspectionPlan plan;  ///< Without the figures of a search.
  /// Empty: the flight keeps the clearance and all limits.
  std::vector<FlightProblem> problems;
  std::size_t slowed_legs = 0;  ///< Legs with a longer delay than given.
  double added_delay = 0.0;     ///< Sum over all legs [s].
};

/// Evaluates and verifies the flight along `vertices` like the flight of plan_inspection(). Delays
/// are lengthened where the flight would exceed the limits of acceleration or jerk. Throws
/// Error{bad_config} for invalid options, and with fewer than two vertices. Throws Interrupted
/// after a stop request.
GivenPlan follow_vertices(const InspectionOptions& options, const InspectionSite& site,
                          std::vector<Vertex> vertices, const InspectionRun& run);

}  // namespace skycap::survey::inspection

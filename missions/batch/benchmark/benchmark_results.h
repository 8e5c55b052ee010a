/// Aggregated results of a benchmark: means, confidence intervals and curves.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "missions/batch/benchmark/trials.h"

namespace skycap::missions::batch {

/// All trials of one planner on one mission, ordered by seed.
struct BenchmarkCell {
  std::string mission;
  std::string planner;  ///< name of a contestant
  std::vector<Trial> trials;
  /// Number of views of a fixed set, which has no curve of its own. Nullopt for planners.
  std::optional<std::size_t> set_views = {};
};

/// Figures by which planners are compared.
struct CellFigures {
  Statistic views;
  Statistic coverage;  ///< fraction of the surface
  /// Fraction of the surface visible from admissible views.
  std::optional<Statistic> coverage_visible;
  std::optional<double> attainable_coverage;  ///< attainable coverage, as a fraction of the surface
  Statistic planning_time;                    ///< processor time for planning [s]
  Statistic distance;
  std::optional<Statistic> flight_time;  ///< flight time of a vehicle [s]
};

/// Computes the figures of a cell, which must contain at least one trial.
CellFigures compute_figures(const BenchmarkCell& cell);

/// Figures of Table 2 of the paper.
struct ViewFigures {
  Statistic frontiers;  ///< frontiers resolved per view, over all trials
  Statistic coverage;   ///< coverage per view, over all trials
};

ViewFigures view_figures(const std::vector<Trial>& trials);

/// Effort until trials reached a given coverage.
struct ReachFigures {
  std::size_t reached = 0;  ///< trials that reached it; only these are included in the means
  Statistic views, distance, planning_time;
};

/// Returns nullopt if no trial reaches `coverage`, a fraction of the surface.
std::optional<ReachFigures> reach_figures(const std::vector<Trial>& trials, double coverage);

/// Quantity on the x axis of coverage curves.
enum class CurveAxis { views, planning_time, distance, flight_time };

struct CurvePoint {
  double x = 0.0;
  double mean = 0.0;       ///< mean coverage
  double deviation = 0.0;  ///< standard deviation over the trials
};

/// Computes the mean coverage over the trials at `count` positions. They are spaced logarithmically
/// along the planning time and linearly along the other axes. A trial that has ended keeps its
/// final coverage. Empty without trials, and along the flight time for surveys without a vehicle.
std::vector<CurvePoint> coverage_curve(const std::vector<Trial>& trials, CurveAxis axis,
                                       std::size_t count);

/// Figures of Figure 6 of the paper: number of views and distance until a target frontier was
/// observed.
struct TargetFigures {
  std::size_t targets = 0;
  /// Fractions of targets observed after exactly 1, 2, ... views; the last entry includes all
  /// higher numbers.
  std::vector<double> share_by_views;
  /// Cumulative fractions of targets observed within less than 0.5, 1.0, ... m of travel.
  std::vector<double> share_by_distance;
};

inline constexpr std::size_t target_view_bins = 10;
inline constexpr std::size_t target_distance_bins = 12;
inline constexpr double target_distance_bin = 0.5;

TargetFigures target_figures(const std::vector<Trial>& trials);

}  // namespace skycap::missions::batch

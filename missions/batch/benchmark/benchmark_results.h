/// The trials of a benchmark put together: means, their certainty, and curves.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "missions/batch/benchmark/trials.h"

namespace skycap::missions::batch {

/// All trials of one planner on one mission, by seed.
struct BenchmarkCell {
  std::string mission;
  std::string planner;  ///< a contestant's name
  std::vector<Trial> trials;
};

/// What planners are compared by.
struct CellFigures {
  Statistic views;
  Statistic coverage;                         ///< share of the surface
  std::optional<Statistic> coverage_visible;  ///< share of what admissible views can see
  std::optional<double> ceiling;              ///< attainable share of the surface
  Statistic planning_time;                    ///< [s]
  Statistic distance;
  std::optional<Statistic> flown_time;  ///< of a vehicle [s]
};

/// `cell` must hold a trial.
CellFigures figures_of(const BenchmarkCell& cell);

/// Table 2 of the paper.
struct ViewFigures {
  Statistic frontiers;  ///< resolved in a view, over the trials
  Statistic coverage;   ///< of a trial by its number of views
};

ViewFigures view_figures(const std::vector<Trial>& trials);

/// What it took until trials had a coverage.
struct ReachFigures {
  std::size_t reached = 0;  ///< trials that came to it; the others are in none of the means
  Statistic views, distance, planning_time;
};

/// Nothing if no trial comes to `coverage`, a share of the surface.
std::optional<ReachFigures> reach_figures(const std::vector<Trial>& trials, double coverage);

/// Along what coverage is drawn.
enum class CurveAxis { views, planning_time, distance, flown_time };

struct CurvePoint {
  double x = 0.0;
  double mean = 0.0;       ///< coverage
  double deviation = 0.0;  ///< standard deviation over the trials
};

/// Mean coverage over the trials at `count` places: evenly spread along views, distance and time in
/// the air, by equal factors along the planning time. A trial that has ended keeps its coverage.
/// Empty without trials, and along the time in the air of surveys that are not flown.
std::vector<CurvePoint> coverage_curve(const std::vector<Trial>& trials, CurveAxis axis,
                                       std::size_t count);

/// Figure 6 of the paper: how many views, and what way, it took until a target was observed.
struct TargetFigures {
  std::size_t targets = 0;
  std::vector<double> share_by_views;     ///< taking 1, 2, ... views, the last entry that or more
  std::vector<double> share_by_distance;  ///< in less than 0.5, 1.0, ... m
};

inline constexpr std::size_t target_view_bins = 10;
inline constexpr std::size_t target_distance_bins = 12;
inline constexpr double target_distance_bin = 0.5;

TargetFigures target_figures(const std::vector<Trial>& trials);

}  // namespace skycap::missions::batch

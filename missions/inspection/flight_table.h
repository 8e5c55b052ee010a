/// Table of flights around known structures: planned ones beside those of other programs.
#pragma once

#include <optional>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "survey/inspection/flight_evaluation.h"

namespace skycap::missions::inspection {

/// Flight around a structure, or the reason why it is not part of the comparison.
struct ComparedFlight {
  std::string structure;  ///< Name of the mission.
  std::string flight;     ///< Such as "skycap, seed 1", or the name of a file.
  std::optional<survey::inspection::FlightEvaluation> evaluation;  ///< Empty: skipped.
  std::string skipped;                                             ///< Reason; empty if evaluated.
  std::optional<double> planning_time;  ///< Processor time of a planned flight [s].
};

/// Returns a Markdown table with one row per evaluated flight, and a list of the skipped ones.
/// Shares are of all points of the structure. The views per point are those of every 0.5 s.
std::string comparison_table(std::span<const ComparedFlight> flights);

/// Returns one object per flight, with the fields of evaluation_json().
nlohmann::ordered_json comparison_json(std::span<const ComparedFlight> flights);

}  // namespace skycap::missions::inspection

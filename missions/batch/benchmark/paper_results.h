/// Results published for SEE++, printed next to the benchmark's results. Source: Border and
/// Gammell, SEE++ (2020), Tables 1 and 2: means of 100 experiments.
#pragma once

#include <optional>
#include <string_view>

namespace skycap::missions::batch {

/// Row of Table 1 for one model.
struct PaperResult {
  double views = 0.0;
  double coverage = 0.0;       ///< fraction, not percent
  double planning_time = 0.0;  ///< planning time [s]
  double distance = 0.0;
};

/// Returns nullopt if the paper does not contain the planner or the model with the mission's name.
std::optional<PaperResult> paper_result(std::string_view mission, std::string_view planner);

/// Row of Table 2: means over the three standard models.
struct PaperViewResult {
  double frontiers = 0.0;  ///< frontiers observed per view
  double coverage = 0.0;   ///< coverage per view, as a fraction
};

/// Returns nullopt for planners other than see and see++.
std::optional<PaperViewResult> paper_view_result(std::string_view planner);

/// Returns whether Table 2 includes the model.
bool is_standard_model(std::string_view mission);

}  // namespace skycap::missions::batch

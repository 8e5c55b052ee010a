/// What the SEE++ paper reports, to be printed beside our own figures. Source: Border and Gammell,
/// SEE++ (2020), Tables 1 and 2: means of 100 experiments.
#pragma once

#include <optional>
#include <string_view>

namespace skycap::missions::batch {

/// A row of Table 1 for one model.
struct PaperResult {
  double views = 0.0;
  double coverage = 0.0;       ///< share, not percent
  double planning_time = 0.0;  ///< [s]
  double distance = 0.0;
};

/// Nothing if the paper has no such model, by the name of its mission, or planner.
std::optional<PaperResult> paper_result(std::string_view mission, std::string_view planner);

/// A row of Table 2: means over the three standard models.
struct PaperViewResult {
  double frontiers = 0.0;  ///< observed in a view
  double coverage = 0.0;   ///< obtained by a view; share
};

/// Nothing but for see and see++.
std::optional<PaperViewResult> paper_view_result(std::string_view planner);

/// Whether Table 2 takes the model in.
bool is_standard_model(std::string_view mission);

}  // namespace skycap::missions::batch

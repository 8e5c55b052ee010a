#include "missions/batch/benchmark/paper_results.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "survey/planners/planner_names.h"

namespace skycap::missions::batch {
namespace {

constexpr std::array<std::string_view, 4> models{"teapot", "bunny", "dragon", "radcliffe_camera"};

struct Row {
  survey::PlannerName planner;
  std::array<PaperResult, 4> by_model;
};

// Coverage in percent, as in the paper.
constexpr std::array<Row, 9> table_1_rows{{
    {survey::PlannerName::see_plus_plus,
     {{{22.3, 97.1, 20.1, 29.7},
       {31.5, 99.4, 46.0, 40.9},
       {35.5, 97.3, 34.0, 40.6},
       {27.1, 95.3, 121, 806}}}},
    {survey::PlannerName::see,
     {{{60.0, 98.1, 4.13, 42.8},
       {75.3, 99.5, 24.7, 56.3},
       {78.0, 98.0, 15.4, 56.8},
       {64.5, 96.6, 74.4, 1302}}}},
    {survey::PlannerName::rsv,
     {{{105, 97.6, 196, 49.6},
       {129, 97.6, 325, 64.8},
       {130, 96.1, 311, 58.2},
       {130, 91.4, 648, 4008}}}},
    {survey::PlannerName::rse,
     {{{105, 97.8, 200, 50.7},
       {129, 95.1, 324, 62.7},
       {130, 97.2, 311, 61.1},
       {130, 89.7, 630, 6375}}}},
    {survey::PlannerName::oa,
     {{{105, 98.8, 194, 37.8},
       {129, 99.5, 313, 45.1},
       {130, 98.4, 300, 43.1},
       {130, 93.9, 675, 1098}}}},
    {survey::PlannerName::uv,
     {{{105, 98.8, 194, 37.8},
       {129, 99.5, 313, 45.1},
       {130, 98.4, 300, 43.1},
       {130, 93.9, 675, 1098}}}},
    {survey::PlannerName::pc,
     {{{105, 97.6, 198, 50.0},
       {129, 98.9, 320, 62.9},
       {130, 97.2, 306, 59.2},
       {130, 91.9, 622, 3272}}}},
    {survey::PlannerName::af,
     {{{105, 97.6, 196, 49.9},
       {129, 96.4, 326, 64.3},
       {130, 97.1, 306, 63.8},
       {130, 90.7, 628, 2615}}}},
    {survey::PlannerName::ae,
     {{{105, 97.4, 196, 48.5},
       {129, 97.4, 324, 59.8},
       {130, 97.3, 311, 58.0},
       {130, 91.0, 650, 1409}}}},
}};

}  // namespace

std::optional<PaperResult> paper_result(std::string_view mission, std::string_view planner) {
  const auto model = std::ranges::find(models, mission);
  const auto row = std::ranges::find(table_1_rows, survey::planner_called(planner),
                                     [](const Row& entry) { return std::optional(entry.planner); });
  if (model == models.end() || row == table_1_rows.end()) return std::nullopt;
  PaperResult result = row->by_model[static_cast<std::size_t>(model - models.begin())];
  result.coverage /= 100.0;
  return result;
}

std::optional<PaperViewResult> paper_view_result(std::string_view planner) {
  if (planner == "see") return PaperViewResult{4.49, 0.0139};
  if (planner == "see++") return PaperViewResult{6.51, 0.0329};
  return std::nullopt;
}

bool is_standard_model(std::string_view mission) {
  return std::ranges::find(models.begin(), models.begin() + 3, mission) != models.begin() + 3;
}

}  // namespace skycap::missions::batch

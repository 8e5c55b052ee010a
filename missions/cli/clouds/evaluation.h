/// What evaluations of whole clouds and of pieces share. For the sources of this room.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include <nlohmann/json.hpp>

#include "geometry/surfaces/mesh.h"
#include "missions/cli/verbs.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/cloud_judge.h"

namespace skycap::missions::cli {

/// What a cloud is compared with.
struct Truth {
  geometry::Mesh model;
  geometry::Mesh beside{};  ///< what a mission's sensor sees beside it: ground, neighbours
  double registration_distance;
  std::size_t samples;
  std::vector<std::uint8_t> is_visible{};  ///< for each sample, if a mission says from where
};

/// Of options.model. What is visible is only looked for if it is asked for. Throws Error.
Truth truth_of(const EvaluateOptions& options, bool wants_visible, const config::Report& report,
               const std::stop_token& stop);

/// The figures of a judgement.
nlohmann::ordered_json evaluation_json(const EvaluateOptions& options, const Truth& truth,
                                       const evaluation::CloudJudgement& judged);

/// The same as options.is_json says.
void print_evaluation(const EvaluateOptions& options, const Truth& truth,
                      const evaluation::CloudJudgement& judged, std::ostream& out);

/// Judges a cloud in pieces, as the options say; returns the exit code.
int split_evaluation(const EvaluateOptions& options, const Console& console);

}  // namespace skycap::missions::cli

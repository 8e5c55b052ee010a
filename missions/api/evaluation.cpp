#include "missions/api/evaluation.h"

#include <algorithm>
#include <string>

#include "geometry/error.h"
#include "missions/evaluation/cloud_evaluator.h"

namespace skycap::missions::api {
namespace {

void validate(std::span<const Eigen::Vector3f> points, const EvaluationRequest& request) {
  if (!(request.distance > 0.0)) {
    throw Error(ErrorKind::bad_config,
                "distance is " + std::to_string(request.distance) + "; it must be above 0 m");
  }
  if (request.samples == 0) {
    throw Error(ErrorKind::bad_config, "samples is 0; it must be above 0");
  }
  if (points.empty()) {
    throw Error(ErrorKind::bad_geometry, "the cloud has no points");
  }
  const auto bad = std::ranges::find_if_not(
      points, [](const Eigen::Vector3f& point) { return point.allFinite(); });
  if (bad != points.end()) {
    throw Error(ErrorKind::bad_geometry, "point " + std::to_string(bad - points.begin()) +
                                             " of the cloud is not finite; remove it");
  }
}

}  // namespace

Evaluation evaluate(std::span<const Eigen::Vector3f> points, const geometry::Mesh& model,
                    const EvaluationRequest& request) {
  validate(points, request);
  geometry::validate(model);
  evaluation::CloudEvaluator evaluator(model, request.samples, request.distance, request.threads);
  evaluator.add(points);
  const evaluation::CloudEvaluation found = evaluator.result();
  return {.coverage = found.coverage,
          .mean = found.accuracy.mean,
          .root_mean_square = found.accuracy.root_mean_square,
          .median = found.accuracy.median,
          .percentile_95 = found.accuracy.percentile_95,
          .largest = found.accuracy.largest,
          .area = found.area,
          .density = found.density()};
}

}  // namespace skycap::missions::api

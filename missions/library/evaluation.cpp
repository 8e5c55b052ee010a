#include "missions/library/evaluation.h"

#include <algorithm>
#include <string>

#include "geometry/error.h"
#include "missions/judge/accuracy.h"
#include "missions/judge/coverage.h"

namespace skycap::missions::library {
namespace {

void validate(std::span<const Eigen::Vector3f> points, const EvaluationRequest& request) {
  if (!(request.distance > 0.0)) {
    throw Error(ErrorKind::bad_config, "distance is " + std::to_string(request.distance) +
                                           "; it must be above zero, in metres");
  }
  if (request.samples == 0) {
    throw Error(ErrorKind::bad_config, "samples is 0; it must be above zero");
  }
  if (points.empty()) {
    throw Error(ErrorKind::bad_geometry, "the cloud has no points; there is nothing to evaluate");
  }
  const auto bad = std::ranges::find_if_not(
      points, [](const Eigen::Vector3f& point) { return point.allFinite(); });
  if (bad != points.end()) {
    throw Error(ErrorKind::bad_geometry, "point " + std::to_string(bad - points.begin()) +
                                             " of the cloud is not finite; leave it out");
  }
}

}  // namespace

Evaluation evaluate(std::span<const Eigen::Vector3f> points, const geometry::Mesh& model,
                    const EvaluationRequest& request) {
  validate(points, request);
  geometry::validate(model);
  const geometry::SurfaceSamples samples = geometry::sample_surface(model, request.samples, 1);
  judge::CoverageMeter meter(samples.points, request.distance);
  meter.add(points);
  judge::AccuracyMeter distances(model, request.threads);
  distances.add(points);
  const judge::CloudAccuracy accuracy = distances.accuracy();
  const double area = geometry::surface_area(model);
  return {.coverage = meter.share(),
          .mean = accuracy.mean,
          .root_mean_square = accuracy.root_mean_square,
          .median = accuracy.median,
          .percentile_95 = accuracy.percentile_95,
          .largest = accuracy.largest,
          .area = area,
          .density = static_cast<double>(points.size()) / area};
}

}  // namespace skycap::missions::library

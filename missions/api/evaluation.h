/// Evaluates clouds against a ground-truth surface, as `skycap evaluate` does.
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::missions::api {

struct EvaluationRequest {
  double distance = 0.005;  ///< r_d: maximum distance of a point from a covered surface sample [m]
  std::size_t samples = 100'000;  ///< number of surface samples; their positions are deterministic
  unsigned threads = 0;           ///< zero: one per processor; does not affect the result
};

/// Coverage and accuracy of a cloud. Accuracy values are distances of the points from the surface
/// [m].
struct Evaluation {
  double coverage = 0.0;  ///< covered fraction of the surface, in [0, 1]
  double mean = 0.0;
  double root_mean_square = 0.0;
  double median = 0.0;
  double percentile_95 = 0.0;
  double largest = 0.0;
  double area = 0.0;     ///< surface area [m^2]
  double density = 0.0;  ///< points per square metre of surface
};

/// Evaluates a cloud. Throws Error{bad_geometry} if the mesh has no surface, or if the cloud is
/// empty or contains non-finite points. Throws Error{bad_config} if the distance or the number of
/// samples is not positive.
Evaluation evaluate(std::span<const Eigen::Vector3f> points, const geometry::Mesh& model,
                    const EvaluationRequest& request = {});

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< public name for user programs
}

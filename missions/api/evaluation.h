/// A cloud against the true surface, as `skycap evaluate` judges it.
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::missions::api {

struct EvaluationRequest {
  double distance = 0.005;        ///< a surface point with a point this near is covered: r_d [m]
  std::size_t samples = 100'000;  ///< surface points that are asked, the same ones each time
  unsigned threads = 0;           ///< zero: all processors; does not change the result
};

/// Distances are those of the cloud's points from the surface [m].
struct Evaluation {
  double coverage = 0.0;  ///< share of the surface, in [0, 1]
  double mean = 0.0;
  double root_mean_square = 0.0;
  double median = 0.0;
  double percentile_95 = 0.0;
  double largest = 0.0;
  double area = 0.0;     ///< of the surface [m^2]
  double density = 0.0;  ///< points of the cloud for each square metre of it
};

/// Throws Error{bad_geometry} for a mesh without a surface, a cloud without points or with points
/// that are not finite, and Error{bad_config} for a distance or a number of samples that is not
/// above zero.
Evaluation evaluate(std::span<const Eigen::Vector3f> points, const geometry::Mesh& model,
                    const EvaluationRequest& request = {});

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< the name in programs of users
}

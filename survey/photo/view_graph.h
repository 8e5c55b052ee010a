/// Which photos a matcher can register to one another, and photos that connect a plan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/pose/pose.h"
#include "survey/photo/visibility.h"

namespace skycap::survey::photo {

/// Two photos that share samples.
struct PhotoPair {
  std::uint32_t first = 0, second = 0;  ///< first < second
  double shared = 0.0;                  ///< fraction of the smaller set of samples
  double parallax = 0.0;                ///< mean over the shared samples [rad]
  double scale = 1.0;                   ///< ratio of mean distances there, at least 1
};

/// When two photos register to one another.
struct EdgeRule {
  double min_shared = 0.5;
  double max_parallax = 30.0 * geometry::radians_per_degree;  ///< mean, at shared samples [rad]
  double max_scale = 2.0;
};

/// All pairs that share at least `min_shared`, by their first and second photo. `observed` are the
/// samples of each photo.
std::vector<PhotoPair> shared_pairs(std::span<const geometry::View> photos,
                                    const IndexLists& observed, const TargetSamples& samples,
                                    double min_shared, unsigned threads);

struct ViewGraph {
  std::size_t photos = 0;
  std::vector<PhotoPair> edges;
  std::vector<std::uint32_t> part;    ///< of each photo; parts are numbered by their first photo
  std::vector<std::uint32_t> degree;  ///< of each photo
  std::vector<std::size_t> parts;     ///< photos of each part, greatest first
  std::size_t min_degree() const;
  bool is_connected(std::size_t degree_wanted) const {
    return parts.size() <= 1 && min_degree() >= degree_wanted;
  }
};

/// The graph whose edges are the pairs that keep the rule.
ViewGraph view_graph(std::span<const geometry::View> photos, const IndexLists& observed,
                     const TargetSamples& samples, const EdgeRule& rule, unsigned threads);

/// Candidates that join the parts of a graph and raise degrees below `degree_wanted`: again and
/// again the one that joins most parts (worth 10 each) and raises most low degrees (worth 1 each),
/// never nearer than `same_position` to a photo. Where no photo alone helps, the one that comes
/// nearest to another part. Ends when the graph is connected, when no candidate helps, or at
/// `max_photos`. Indices of `candidates`.
std::vector<std::uint32_t> connecting_photos(std::span<const geometry::View> photos,
                                             const IndexLists& observed,
                                             std::span<const geometry::View> candidates,
                                             const IndexLists& observed_by_candidates,
                                             const TargetSamples& samples, const EdgeRule& rule,
                                             std::size_t degree_wanted, double same_position,
                                             std::size_t max_photos, unsigned threads);

}  // namespace skycap::survey::photo

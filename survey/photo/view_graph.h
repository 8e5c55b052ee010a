/// Graph of the photos that a matcher can register to each other, and photos that connect it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/angle.h"
#include "geometry/pose/pose.h"
#include "survey/photo/visibility.h"

namespace skycap::survey::photo {

/// Pair of photos that share samples.
struct PhotoPair {
  std::uint32_t first = 0, second = 0;  ///< Indices of the photos, with first < second.
  double shared = 0.0;    ///< Shared samples as a fraction of the smaller set of samples.
  double parallax = 0.0;  ///< Mean parallax over the shared samples [rad].
  double scale = 1.0;     ///< Ratio of the mean distances to them, at least 1.
};

/// Conditions under which two photos register to each other.
struct EdgeRule {
  double min_shared = 0.5;
  double max_parallax =
      30.0 * geometry::radians_per_degree;  ///< Mean over the shared samples [rad].
  double max_scale = 2.0;
};

/// Minimum fraction of the smaller photo's samples that a pair must share to be matched, and
/// maximum mean parallax of a pair [rad]. Other pairs take most of the matching time and seldom
/// pass geometric verification.
inline constexpr double min_shared_to_match = 0.2;
inline constexpr double max_parallax_to_match = 42.0 * geometry::radians_per_degree;

/// Returns all pairs that share at least `min_shared`, sorted by first and second photo. `observed`
/// contains the samples of each photo.
std::vector<PhotoPair> shared_pairs(std::span<const geometry::View> photos,
                                    const IndexLists& observed, const TargetSamples& samples,
                                    double min_shared, unsigned threads);

struct ViewGraph {
  std::size_t photos = 0;
  std::vector<PhotoPair> edges;
  std::vector<std::uint32_t>
      part;  ///< Part of each photo. Parts are numbered by their first photo.
  std::vector<std::uint32_t> degree;  ///< Number of edges of each photo.
  std::vector<std::size_t> parts;     ///< Number of photos in each part, in descending order.
  /// Number of photos that an incremental registration reaches. It starts with an edge and adds
  /// photos with at least two edges to registered photos. Maximum over all edges.
  std::size_t registered = 0;
  std::size_t min_degree() const;
  bool is_connected(std::size_t degree_wanted) const {
    return parts.size() <= 1 && min_degree() >= degree_wanted;
  }
};

/// Returns the graph with an edge for each pair that satisfies the rule.
ViewGraph view_graph(std::span<const geometry::View> photos, const IndexLists& observed,
                     const TargetSamples& samples, const EdgeRule& rule, unsigned threads);

/// Returns the indices of candidates that connect the parts of a graph and increase degrees below
/// `degree_wanted`. Repeatedly adds the candidate with the largest value: 10 for each part joined
/// and 1 for each low degree increased. If no single photo has a positive value, adds the candidate
/// closest to another part. Afterwards adds candidates until an incremental registration reaches
/// all photos, see ViewGraph::registered. Candidates closer than `same_position` [m] to a photo are
/// skipped. Ends when the graph is connected, when no candidate helps, or at `max_photos`.
std::vector<std::uint32_t> connecting_photos(std::span<const geometry::View> photos,
                                             const IndexLists& observed,
                                             std::span<const geometry::View> candidates,
                                             const IndexLists& observed_by_candidates,
                                             const TargetSamples& samples, const EdgeRule& rule,
                                             std::size_t degree_wanted, double same_position,
                                             std::size_t max_photos, unsigned threads);

}  // namespace skycap::survey::photo

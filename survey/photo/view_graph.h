/// Graph of the photos that a matcher can register to each other, and photos that connect it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/pose/pose.h"
#include "survey/photo/visibility.h"

namespace skycap::survey::photo {

/// Pair of photos in which a feature matcher can find the same surface.
struct PhotoPair {
  std::uint32_t first = 0, second = 0;  ///< Indices of the photos, with first < second.
  /// Samples that can be matched, see EdgeRule, as a fraction of the smaller set of samples.
  double matchable = 0.0;
};

/// Conditions under which two photos register to each other. A sample can be matched if the affine
/// map between its images in both photos is moderate: its transition tilt, which is the ratio of
/// its singular values, and the ratio of the distances. The transition tilt grows with the parallax
/// and, strongly, with the incidence. Source: Morel and Yu, "ASIFT: a new framework for fully
/// affine invariant image comparison", SIAM J. Imaging Sciences 2(2), 2009: SIFT features tolerate
/// about 2. Limits: measured with COLMAP, see docs/development/results/2026-11-26-photo-plans.md.
struct EdgeRule {
  double min_matchable = 0.3;  ///< Fraction of the smaller set of samples.
  double max_tilt = 1.8;       ///< Transition tilt, at least 1.
  double max_scale = 2.0;      ///< Ratio of the distances, at least 1.
};

/// Returns the transition tilt of the images of a plane in two photos, at least 1. The rays are
/// unit vectors from the plane to the photos, with positive cosines of incidence.
double transition_tilt(const Observation& a, const Observation& b);

/// Minimum fraction of the smaller photo's samples that can be matched in a pair for the matcher.
/// Other pairs take most of the matching time and seldom pass geometric verification.
inline constexpr double min_matchable_to_match = 0.1;

/// Returns all pairs with at least `min_matchable`, sorted by first and second photo. `observed`
/// contains the samples of each photo. rule.min_matchable is not used.
std::vector<PhotoPair> matchable_pairs(std::span<const geometry::View> photos,
                                       const IndexLists& observed, const TargetSamples& samples,
                                       const EdgeRule& rule, double min_matchable,
                                       unsigned threads);

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
  std::vector<char> is_registered;  ///< 1 for each of these photos.
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

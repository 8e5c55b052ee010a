#include "missions/evaluation/reliability.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "geometry/points/point_grid.h"

namespace skycap::missions::evaluation {
namespace {

using survey::surfel::EstimatedPatch;

/// Patches indexed by position and normal.
class PatchGrid {
 public:
  PatchGrid(std::span<const EstimatedPatch> patches, double reach)
      : patches_(patches), reach_(reach), grid_(reach) {
    for (const EstimatedPatch& patch : patches) grid_.insert(patch.position);
  }

  std::optional<float> share_at(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) {
    near_.clear();
    grid_.find_within(position, reach_, near_);
    std::optional<geometry::Neighbour> nearest;
    for (const geometry::Neighbour& here : near_) {
      if (patches_[here.index].normal.dot(normal) <= 0.0F) continue;
      if (!nearest || here < *nearest) nearest = here;
    }
    if (!nearest) return std::nullopt;
    return patches_[nearest->index].covered_share;
  }

 private:
  std::span<const EstimatedPatch> patches_;
  double reach_;
  geometry::PointGrid grid_;
  std::vector<geometry::Neighbour> near_;
};

double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

}  // namespace

Reliability reliability(std::span<const EstimatedPatch> estimate,
                        const geometry::SurfaceSamples& samples,
                        std::span<const std::uint8_t> is_covered,
                        std::span<const std::uint8_t> counts, double reach) {
  PatchGrid patches(estimate, reach);
  Reliability found;
  double counted = 0.0;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    if (!counts.empty() && counts[i] == 0) continue;
    ++counted;
    const auto share = patches.share_at(samples.points[i], samples.normals[i]);
    const double covered = is_covered[i] != 0 ? 1.0 : 0.0;
    if (!share) {
      ++found.unknown_share;
      found.unknown_covered += covered;
      continue;
    }
    const double last = Reliability::bands_count - 1;
    const double band = std::clamp(std::floor(*share * (last + 1.0)), 0.0, last);
    Reliability::Band& sums = found.bands[static_cast<std::size_t>(band)];
    sums.estimated += *share;
    sums.covered += covered;
    ++sums.share;
  }
  for (Reliability::Band& band : found.bands) {
    found.error += ratio(std::abs(band.estimated - band.covered), counted - found.unknown_share);
    band = {ratio(band.estimated, band.share), ratio(band.covered, band.share),
            ratio(band.share, counted)};
  }
  found.unknown_covered = ratio(found.unknown_covered, found.unknown_share);
  found.unknown_share = ratio(found.unknown_share, counted);
  return found;
}

}  // namespace skycap::missions::evaluation

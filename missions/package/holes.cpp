#include "missions/package/holes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>

#include "geometry/points/point_grid.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using survey::surfel::EstimatedPatch;
using survey::surfel::MissingReason;

/// Neighbouring patches on a surface are one to two patch sizes apart. Predicted patches are less
/// dense.
constexpr double links_per_patch = 3.0;
constexpr double patches_per_hole = 4.0;

double missing_area(const EstimatedPatch& patch) {
  return patch.area * (1.0 - patch.covered_share);
}

/// Returns the side length of a square patch of typical area.
double usual_side(std::span<const EstimatedPatch> patches) {
  std::vector<float> areas;
  for (const EstimatedPatch& patch : patches) areas.push_back(patch.area);
  if (areas.empty()) return 0.0;
  const auto middle = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
  std::ranges::nth_element(areas, middle);
  return std::sqrt(static_cast<double>(*middle));
}

/// Disjoint sets. The smallest member represents its set.
class Sets {
 public:
  explicit Sets(std::size_t size) : parents_(size) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t member) {
    while (parents_[member] != member) {
      member = parents_[member] = parents_[parents_[member]];
    }
    return member;
  }
  void join(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parents_;
};

/// Returns the maximum distance to other patches of the same hole, based on the patch's own size
/// because predicted patches may be much larger than measured ones. The size is limited, because
/// the area of predicted patches underestimates their size and a few very large patches must not
/// connect all others.
double compute_link_distance(const EstimatedPatch& patch, double usual) {
  const double side = std::sqrt(static_cast<double>(patch.area));
  return links_per_patch * std::clamp(side, 0.5 * usual, 4.0 * usual);
}

/// Connects patches with the same reason if one is within the link distance of the other. `usual`
/// is the typical side length.
Sets connected(std::span<const EstimatedPatch> hole_patches, double usual) {
  Sets sets(hole_patches.size());
  std::vector<double> links;
  for (const EstimatedPatch& patch : hole_patches)
    links.push_back(compute_link_distance(patch, usual));
  const double longest = *std::ranges::max_element(links);
  // The grid search uses a margin for rounding; distances are compared exactly later.
  geometry::PointGrid before((1.0 + 1e-5) * longest);
  std::vector<geometry::Neighbour> near;
  for (std::size_t i = 0; i < hole_patches.size(); ++i) {
    near.clear();
    before.find_within(hole_patches[i].position, before.cell_size(), near);
    for (const geometry::Neighbour& neighbour : near) {
      const EstimatedPatch& other = hole_patches[neighbour.index];
      const auto apart = static_cast<double>((hole_patches[i].position - other.position).norm());
      const bool is_near = apart <= std::max(links[i], links[neighbour.index]);
      if (is_near && hole_patches[i].reason == other.reason) sets.join(i, neighbour.index);
    }
    before.insert(hole_patches[i].position);
  }
  return sets;
}

Hole make_hole(std::span<const EstimatedPatch> hole_patches,
               const std::vector<std::size_t>& members, std::span<const geometry::View> views) {
  Hole hole{.reason = hole_patches[members.front()].reason, .num_patches = members.size()};
  Vector3d normal = Vector3d::Zero();
  for (const std::size_t i : members) {
    const double area = missing_area(hole_patches[i]);
    hole.area += area;
    hole.centre += area * hole_patches[i].position.cast<double>();
    normal += area * hole_patches[i].normal.cast<double>();
  }
  hole.centre = hole.area > 0.0 ? Vector3d(hole.centre / hole.area)
                                : hole_patches[members.front()].position.cast<double>();
  // Patches that face in all directions have no common normal.
  constexpr double min_agreement = 0.1;
  if (normal.norm() > min_agreement * hole.area) hole.normal = normal.normalized();
  for (const std::size_t i : members) {
    hole.radius =
        std::max(hole.radius, (hole_patches[i].position.cast<double>() - hole.centre).norm());
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double distance = (views[i].position - hole.centre).norm();
    if (i > 0 && distance >= hole.view_distance) continue;
    hole.nearest_view = i;
    hole.view_distance = distance;
  }
  return hole;
}

}  // namespace

MissingSurface missing_surface(std::span<const EstimatedPatch> patches,
                               std::span<const geometry::View> views) {
  const double side = usual_side(patches);
  MissingSurface missing{.link = links_per_patch * side,
                         .min_hole_area = patches_per_hole * side * side};
  std::vector<EstimatedPatch> hole_patches;
  for (const EstimatedPatch& patch : patches) {
    missing.area += patch.area;
    if (patch.reason == MissingReason::none) {
      missing.rest += missing_area(patch);
    } else {
      hole_patches.push_back(patch);
    }
  }
  if (hole_patches.empty() || side <= 0.0) return missing;
  Sets sets = connected(hole_patches, side);
  std::map<std::size_t, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < hole_patches.size(); ++i) groups[sets.find(i)].push_back(i);
  for (const auto& [first, members] : groups) {
    const Hole hole = make_hole(hole_patches, members, views);
    if (hole.area >= missing.min_hole_area) {
      missing.holes.push_back(hole);
    } else {
      ++missing.smaller;
      missing.smaller_area += hole.area;
    }
  }
  std::ranges::stable_sort(missing.holes, std::greater(), &Hole::area);
  return missing;
}

std::vector<EstimatedPatch> true_patches(const geometry::SurfaceSamples& samples, double area,
                                         std::span<const std::uint8_t> is_covered,
                                         std::span<const std::uint8_t> is_visible) {
  const auto share = static_cast<float>(area / static_cast<double>(samples.points.size()));
  std::vector<EstimatedPatch> patches;
  for (std::size_t i = 0; i < is_covered.size(); ++i) {
    const bool is_hidden = !is_visible.empty() && is_visible[i] == 0;
    const MissingReason reason = is_covered[i] != 0 ? MissingReason::none
                                 : is_hidden        ? MissingReason::unreachable
                                                    : MissingReason::never_seen;
    patches.push_back(
        {samples.points[i], samples.normals[i], share, is_covered[i] != 0 ? 1.0F : 0.0F, reason});
  }
  return patches;
}

const char* to_string(MissingReason reason) {
  switch (reason) {
    case MissingReason::seen_too_thinly:
      return "undersampled";
    case MissingReason::never_seen:
      return "unobserved";
    case MissingReason::unreachable:
      return "unreachable";
    case MissingReason::none:
      break;
  }
  return "covered";
}

}  // namespace skycap::missions::package

// Keys of the section `volumetric`.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {

namespace {

using survey::volumetric::GainSettings;
using survey::volumetric::RayPattern;
using Settings = survey::volumetric::VolumetricSettings;

auto setting(auto member) {
  return [member](auto& m) -> auto& { return m.planner.volumetric.*member; };
}
auto gain(auto member) {
  return [member](auto& m) -> auto& { return m.planner.volumetric.gain.*member; };
}
auto rays(auto member) {
  return [member](auto& m) -> auto& { return m.planner.volumetric.rays.*member; };
}

/// Returns the keys of candidate views and their selection.
std::vector<Key> candidate_keys() {
  return {
      otherwise("130; in a benchmark, the maximum number of views required by see",
                integer_key("volumetric.view_limit", "views", between(1, 1e6),
                            setting(&Settings::view_limit),
                            "V: maximum number of views of a volumetric survey.")),
      number_key("volumetric.candidates_per_view", "", above(0, 1e4),
                 setting(&Settings::candidates_per_view),
                 "Number of candidate views on the sphere per view of the view limit."),
      otherwise("centroid of the surface",
                vector_key("volumetric.sphere_centre", "m", between(-1e6, 1e6),
                           setting(&Settings::sphere_centre), "Centre of the candidate sphere.")),
      otherwise("view distance plus the mean distance of the surface from its centroid",
                number_key("volumetric.sphere_radius", "m", above(0, 1e6),
                           setting(&Settings::sphere_radius), "Radius of the candidate sphere.")),
      number_key("volumetric.cost_weight", "", between(0, 1e6), setting(&Settings::cost_weight),
                 "Weight of the path length to a candidate relative to its gain; both are "
                 "normalised by their sums over all candidates."),
      choice_key("volumetric.ties", {"first", "nearest"}, setting(&Settings::ties),
                 "Selection among candidates of equal utility."),
  };
}

/// Returns the keys of the gain variants.
std::vector<Key> gain_keys() {
  return {
      choice_key("volumetric.visibility", {"code", "paper"}, gain(&GainSettings::visibility),
                 "Factor of the visibility weight of rse, oa and uv at a voxel of occupancy p: p "
                 "as in the evaluation code, or 1 - p as published."),
      choice_key("volumetric.rse_end", {"code", "paper"}, gain(&GainSettings::rear_side_end),
                 "Rays that end on a surface and are counted by rse: all rays, as in the "
                 "evaluation code, or only rays from an uncertain voxel, as published."),
      choice_key("volumetric.af_share", {"all_rays", "hitting_rays"},
                 gain(&GainSettings::area_share),
                 "Denominator of the fractions in af: all rays, or only rays with a hit (occupied "
                 "or shadowed voxel)."),
  };
}

/// Returns the keys of candidate rays and of map updates.
std::vector<Key> map_keys() {
  return {
      number_key("volumetric.rays_per_pixel", "1/px", above(0, 1),
                 rays(&RayPattern::rays_per_pixel),
                 "Rays per pixel of a candidate's image, along rows and along columns."),
      number_key("volumetric.window_begin", "fraction", between(0, 1),
                 rays(&RayPattern::window_begin),
                 "First column and row with rays, as a fraction of the image."),
      number_key("volumetric.window_end", "fraction", between(0, 1), rays(&RayPattern::window_end),
                 "Last column and row with rays, as a fraction of the image."),
      otherwise("radius of the sphere",
                number_key("volumetric.ray_depth", "m", above(0, 1e6),
                           setting(&Settings::ray_depth), "Length of rays without a hit.")),
      otherwise(
          "18 voxels",
          number_key("volumetric.shadow_length", "m", above(0, 1e6),
                     setting(&Settings::shadow_length),
                     "s: distance behind measurements up to which voxels are marked as occluded.")),
      boolean_key("volumetric.thinned", setting(&Settings::downsampled),
                  "Insert only the stored points (spaced by planner.spacing) into the voxels, "
                  "instead of complete scans."),
      boolean_key("volumetric.carve_no_returns", setting(&Settings::carve_no_returns),
                  "Mark space along no-return pixels as free, up to ray_depth."),
  };
}

}  // namespace

std::vector<Key> volumetric_keys() { return joined({candidate_keys(), gain_keys(), map_keys()}); }

}  // namespace skycap::missions::config

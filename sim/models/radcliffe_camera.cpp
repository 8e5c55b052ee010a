#include "sim/models/radcliffe_camera.h"

#include <numbers>

#include "sim/models/radcliffe_elements.h"

namespace skycap::sim::models {

using std::numbers::pi;

double radcliffe::Plan::bay_angle() const { return 2.0 * pi / table.projecting_bays; }
double radcliffe::Plan::arched_bay(int i) const { return i * bay_angle(); }
double radcliffe::Plan::niche_bay(int i) const { return (i + 0.5) * bay_angle(); }

std::vector<double> radcliffe::Plan::columns() const {
  const double within_pair = table.column_spacing / table.column_axis_radius;
  std::vector<double> azimuths;
  for (int i = 0; i < table.projecting_bays; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double pair = arched_bay(i) + side * (0.25 * bay_angle() + table.wide_bay_shift);
      for (int j = 0; j < table.columns_in_a_group; ++j) {
        azimuths.push_back(pair + (j - 0.5 * (table.columns_in_a_group - 1)) * within_pair);
      }
    }
  }
  return azimuths;
}

Parts radcliffe_camera(const RadcliffeTable& table, const RadcliffeOptions& options) {
  const double scale = table.longest_side / table.total_height;
  const radcliffe::Plan plan{
      table, {options.fineness.chord_error / scale}, options.has_fluted_columns};
  Parts parts;
  parts.push_back({"body", radcliffe::body(plan)});

  radcliffe::add_pediments(plan, parts);
  radcliffe::add_keystones(plan, parts);
  radcliffe::add_arch_glazing(plan, parts);
  radcliffe::add_north_steps(plan, parts);

  radcliffe::add_columns(plan, parts);
  radcliffe::add_window_frames(plan, parts);
  radcliffe::add_niche_frames(plan, parts);
  radcliffe::add_festoons(plan, parts);
  radcliffe::add_cornice_blocks(plan, parts);

  radcliffe::add_balustrade(plan, parts);
  radcliffe::add_vases(plan, parts);

  radcliffe::add_buttresses(plan, parts);
  radcliffe::add_drum_window_frames(plan, parts);
  radcliffe::add_dome_ribs(plan, parts);
  radcliffe::add_lantern_order(plan, parts);

  for (Part& part : parts) transform(part.mesh, Eigen::Affine3d(Eigen::Scaling(scale)));
  return parts;
}

}  // namespace skycap::sim::models

#include "missions/photo/photo_summary.h"

#include <fmt/format.h>

#include "missions/config/mission_document.h"

namespace skycap::missions::photo {
namespace {

using survey::photo::MissingReason;
using survey::photo::PhotoFigures;
using survey::photo::PhotoPlanResult;

std::string percent(double share) { return fmt::format("{:.1f}%", 100.0 * share); }

std::string missing_text(const PhotoPlanResult& result) {
  std::string text;
  for (std::size_t i = 0; i < survey::photo::missing_reasons; ++i) {
    const double area = result.missing_area[i];
    if (area <= 0.0) continue;
    text +=
        fmt::format("  missing   {:.1f} m^2 ({} of the exposed surface): {}\n", area,
                    percent(area / result.exposed_area), describe(static_cast<MissingReason>(i)));
  }
  return text;
}

std::string row(const std::string& name, const PhotoFigures& figures, const PhotoTour& tour) {
  return fmt::format("  {:<16} {:>6} {:>8.0f} {:>8.1f} {:>13} {:>10}\n", name, figures.photos,
                     tour.length, tour.duration / 60.0, percent(figures.completeness),
                     percent(figures.share(figures.satisfied)));
}

std::string patterns_text(const PhotoMission& mission) {
  std::string text = fmt::format("  {:<16} {:>6} {:>8} {:>8} {:>13} {:>10}\n", "", "photos",
                                 "tour m", "minutes", "completeness", "satisfied");
  text += row("plan", mission.result.figures, mission.tour);
  for (std::size_t i = 0; i < mission.result.patterns.size(); ++i) {
    const survey::photo::PatternResult& pattern = mission.result.patterns[i];
    const std::string name = to_string(pattern.pattern);
    text += row(name, pattern.figures, mission.patterns[i].whole);
    text += row(name + ", pruned", pattern.pruned, mission.patterns[i].pruned);
  }
  return text;
}

}  // namespace

std::string describe(MissingReason reason) {
  switch (reason) {
    case MissingReason::occluded:
      return "occluded from most free positions";
    case MissingReason::min_standoff:
      return "too close to obstacles or outside the airspace";
    case MissingReason::incidence:
      return "visible only at more than the maximum incidence";
    case MissingReason::gimbal:
      return "outside the gimbal's range";
    case MissingReason::height:
      return "visible only from below the minimum height";
    case MissingReason::not_taken:
      return "attainable, but requires too many photos for its area";
  }
  return "";
}

std::string plan_text(const config::MissionSetup& setup, const PhotoMission& mission) {
  const PhotoPlanResult& result = mission.result;
  std::string text = fmt::format("{}: {} photos with {}, GSD {:.2f} mm at {:.2f} m\n", setup.name,
                                 mission.plan.photos.size(), mission.plan.camera.name,
                                 1e3 * mission.plan.gsd, result.view_distance);
  text += fmt::format(
      "  surface   {:.1f} m^2 exposed, {} of it attainable; expected completeness {} of the "
      "exposed "
      "surface\n",
      result.exposed_area, percent(result.figures.share(result.figures.attainable)),
      percent(result.figures.completeness));
  text += fmt::format("  partners  {} or more: {} of the exposed, {} of the attainable surface\n",
                      config::photo_setup(*setup.document).options.rule.min_partners,
                      percent(result.figures.share(result.figures.satisfied)),
                      percent(result.figures.attainable_share(result.figures.satisfied)));
  text += missing_text(result);
  if (result.bound.photos > 0) {
    text += fmt::format(
        "  bound     the same samples require at least {} photos; the plan has {} without "
        "connecting photos\n",
        result.bound.photos, result.repaired_photos);
  }
  if (result.connecting > 0) {
    text += fmt::format("  graph     {} photos added so that all photos can be registered\n",
                        result.connecting);
  }
  return text + patterns_text(mission) +
         "  limits    windows, glass, water, thin wires and plain walls are not modelled\n";
}

std::string warnings_text(const PhotoMission& mission) {
  std::string text;
  for (const std::string& warning : mission.warnings) text += "Warning: " + warning + ".\n";
  return text;
}

}  // namespace skycap::missions::photo

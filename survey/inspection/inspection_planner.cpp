#include "survey/inspection/inspection_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/interrupted.h"
#include "geometry/parallel.h"
#include "geometry/random_numbers.h"

namespace skycap::survey::inspection {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Returns the parts as one text; numbers have up to four digits.
template <typename... Parts>
std::string joined_text(const Parts&... parts) {
  std::ostringstream text;
  text.precision(4);
  (text << ... << parts);
  return text.str();
}

/// Returns the cloud in random order, so that its first points are a sample of the surface.
StructureCloud shuffled(const StructureCloud& cloud, geometry::RandomNumbers& random) {
  std::vector<std::size_t> order(cloud.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  StructureCloud result;
  result.median_radius = cloud.median_radius;
  for (const std::size_t i : order) {
    result.points.push_back(cloud.points[i]);
    result.normals.push_back(cloud.normals[i]);
    result.radii.push_back(cloud.radii[i]);
  }
  return result;
}

/// Returns the number of points of the first phase of the search.
std::size_t first_phase_targets(std::size_t points) {
  constexpr std::size_t large = 30'000, min_targets = 3000;
  const std::size_t targets = points < large ? points / 3 : points / 8;
  return std::min(points, std::max(targets, min_targets));
}

SpaceOptions space_options(const InspectionOptions& options, const InspectionSite& site,
                           const StructureCloud& cloud, unsigned threads) {
  constexpr double margin = 2.0, distance_margin = 2.0, range_share = 0.65;
  SpaceOptions space;
  space.box = cloud.box();
  space.box.min().array() -= options.camera.range + margin;
  space.box.max().array() += options.camera.range + margin;
  // Cells and nodes have sides of about a metre.
  if (site.min_height) {
    space.min_height = *site.min_height;
    space.box.min().z() = std::max(space.box.min().z(), space.min_height - margin);
  }
  if (site.max_height) {
    space.max_height = *site.max_height;
    space.box.max().z() = std::min(space.box.max().z(), space.max_height + margin);
  }
  if ((space.box.sizes().array() <= 0.0).any()) {
    throw Error(ErrorKind::bad_geometry,
                "the height limits leave no space around the structure; check site.min_height and "
                "site.max_height");
  }
  // The search divides the box into cells of one cubic metre.
  constexpr double max_volume = 1e8;
  if (const Eigen::Vector3d sides = space.box.sizes();
      !(sides.array().max(1.0).prod() <= max_volume)) {
    throw Error(ErrorKind::bad_geometry,
                joined_text("the structure with the range around it spans ", sides.x(), " x ",
                            sides.y(), " x ", sides.z(),
                            " m, which is too large; lower the range, remove distant points, or "
                            "divide the structure"));
  }
  space.clearance = options.planned_clearance();
  space.max_distance =
      std::max(options.planned_clearance() + distance_margin, range_share * options.camera.range);
  space.distance = site.distance;
  space.is_free = site.is_free;
  space.threads = threads;
  return space;
}

/// Returns the smallest distance of a flight from all obstacles [m].
double verified_distance(const InspectionOptions& options, const InspectionSite& site,
                         const StructureCloud& cloud, std::span<const FlightSample> flight) {
  // The flight leaves a chord by at most a dt^2 / 8.
  const double chord = options.limits.acceleration * sample_interval * sample_interval / 8.0;
  if (!site.segment_distance) return nearest_distance(flight, cloud).points - chord;
  const double up_to = options.planned_clearance() + options.camera.range;
  double nearest = up_to;
  for (std::size_t i = 1; i < flight.size(); ++i) {
    nearest = std::min(nearest,
                       site.segment_distance(flight[i - 1].position, flight[i].position, nearest));
  }
  return nearest - chord;
}

EvaluationOptions evaluation_options(const InspectionOptions& options, unsigned threads) {
  EvaluationOptions evaluation;
  evaluation.camera = options.camera;
  evaluation.limits = options.limits;
  evaluation.min_pitch = options.pitch.min;
  evaluation.max_pitch = options.pitch.max;
  evaluation.threads = threads;
  return evaluation;
}

/// Route of one of the searches.
struct Proposal {
  const SearchedRoute* route;
  std::size_t search;
};

/// Returns all improvements, best first.
std::vector<Proposal> ranked(const std::vector<SearchResult>& results) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (const SearchedRoute& route : results[i].improvements) proposals.push_back({&route, i});
  }
  std::ranges::stable_sort(proposals, [](const Proposal& a, const Proposal& b) {
    return std::tuple(a.route->missing, a.route->duration, a.search) <
           std::tuple(b.route->missing, b.route->duration, b.search);
  });
  return proposals;
}

/// Verifies routes, best first, and returns the first one that keeps clearance and limits. Sets the
/// largest distance of a route, if `best_distance` is not null.
std::optional<InspectionPlan> find_verified_plan(
    const InspectionOptions& options, const InspectionSite& site, const StructureCloud& cloud,
    const std::vector<SearchResult>& results, unsigned threads, double* best_distance = nullptr) {
  InspectionPlan plan;
  plan.smoothing = make_smoothing(options.limits);
  for (const Proposal& proposal : ranked(results)) {
    std::vector<FlightSample> samples =
        sample_flight(proposal.route->vertices, plan.smoothing, sample_interval);
    const double distance = verified_distance(options, site, cloud, samples);
    if (best_distance != nullptr) *best_distance = std::max(*best_distance, distance);
    if (distance < options.planned_clearance()) continue;
    FlightEvaluation evaluation =
        evaluate_flight(samples, cloud, evaluation_options(options, threads));
    if (!evaluation.keeps_limits()) continue;
    plan.vertices = proposal.route->vertices;
    plan.samples = std::move(samples);
    plan.evaluation = std::move(evaluation);
    plan.meets_goal = proposal.route->meets_goal();
    plan.verified_clearance = distance;
    plan.search = proposal.search;
    plan.first_duration = results[proposal.search].first_duration;
    return plan;
  }
  return std::nullopt;
}

InspectionPlan verified_plan(const InspectionOptions& options, const InspectionSite& site,
                             const StructureCloud& cloud, const std::vector<SearchResult>& results,
                             unsigned threads) {
  double best_distance = 0.0;
  std::optional<InspectionPlan> plan =
      find_verified_plan(options, site, cloud, results, threads, &best_distance);
  if (plan) return *std::move(plan);
  throw Error(
      ErrorKind::bad_geometry,
      best_distance > 0.0
          ? joined_text("the search found no flight that keeps the clearance of ",
                        options.planned_clearance(), " m from all surfaces (best: ", best_distance,
                        " m); raise inspection.moves or lower the clearance")
          : "the search found no flight that keeps the clearance and the motion limits; raise "
            "inspection.moves, or lower the clearance or inspection.max_speed");
}

/// Returns the number of points by which a flight misses each share of the goal.
PerRule<std::size_t> missing_points(const FlightEvaluation& evaluation, const CoverageGoal& goal,
                                    const ViewCandidates& candidates) {
  const std::size_t points = candidates.attainable.size();
  const PerRule<std::size_t> allowed = goal.allowed_unseen(candidates.attainable, points);
  PerRule<std::size_t> missing{};
  for (std::size_t rule = 0; rule < sight_rules; ++rule) {
    const std::size_t unseen = points - evaluation.seen[rule];
    if (goal.shares[rule] > 0.0 && unseen > allowed[rule]) missing[rule] = unseen - allowed[rule];
  }
  return missing;
}

/// Requires more views of the points that the evaluation does not see by the rules that are missed.
void require_more_views(const FlightEvaluation& evaluation, const PerRule<std::size_t>& missing,
                        const ViewCandidates& candidates, SearchOptions& search) {
  const std::size_t points = candidates.attainable.size();
  constexpr std::uint8_t max_more = 100;
  for (std::size_t rule = 0; rule < sight_rules; ++rule) {
    if (missing[rule] == 0) continue;
    search.more_views[rule].resize(points, 0);
    for (std::size_t i = 0; i < points; ++i) {
      const bool is_seen = (evaluation.rules_seen[i] >> rule & 1U) != 0;
      std::uint8_t& more = search.more_views[rule][i];
      if (!is_seen && candidates.attainable[i] > rule && more < max_more) ++more;
    }
  }
}

/// Throws Error{bad_config} if a flight lasts longer than a day.
void require_short_flight(std::span<const double> durations, const Smoothing& smoothing) {
  constexpr double max_duration = 24.0 * 3600.0;
  if (flight_duration(durations, smoothing) <= max_duration) return;
  throw Error(ErrorKind::bad_config,
              "the limits of motion allow no flight around the structure in a day; raise the "
              "limits of speed, acceleration, jerk or yaw");
}

/// Legs of a polygon that overlap a time of flight, each within the reach of the smoothing.
class LegTimes {
 public:
  LegTimes(std::span<const double> durations, const Smoothing& smoothing)
      : reach_(smoothing.reach()) {
    double time = smoothing.reach();
    for (const double duration : durations) {
      starts_.push_back(time);
      time += duration;
    }
    starts_.push_back(time);
  }
  std::size_t count() const { return starts_.size() - 1; }
  double start(std::size_t leg) const { return starts_[leg]; }
  double end(std::size_t leg) const { return starts_[leg + 1]; }
  bool affects(std::size_t leg, double time) const {
    return start(leg) < time + reach_ && end(leg) > time - reach_;
  }

 private:
  std::vector<double> starts_;  // flight times of the vertices
  double reach_;
};

/// Returns the times of a flight at which it exceeds the acceleration or the jerk.
std::vector<double> find_excesses(std::span<const Vertex> vertices,
                                  std::span<const double> durations, const Smoothing& smoothing,
                                  const MotionLimits& limits) {
  // Half of the tolerances of the evaluation, so that planned flights remain as they are.
  constexpr double acceleration_share = 1.005, jerk_share = 1.02, min_length = 1e-6;
  const LegTimes legs(durations, smoothing);
  std::vector<double> times;
  IntervalCurve curve;
  for (std::size_t i = 0; i <= vertices.size(); ++i) {
    curve.set(vertices, durations, smoothing, i);
    const double origin = legs.start(i == 0 ? 0 : i - 1);
    const std::vector<double>& jumps = curve.jumps();
    for (std::size_t k = 0; k < jumps.size(); ++k) {
      const double acceleration = curve.acceleration(jumps[k]).head<3>().norm();
      if (acceleration > acceleration_share * limits.acceleration) {
        times.push_back(origin + jumps[k]);
      }
      if (k == 0 || jumps[k] - jumps[k - 1] < min_length) continue;
      const double middle = 0.5 * (jumps[k - 1] + jumps[k]);
      if (curve.jerk(middle).head<3>().norm() > jerk_share * limits.jerk) {
        times.push_back(origin + middle);
      }
    }
  }
  return times;
}

/// Lengthens the delays of legs until the flight keeps the limits of acceleration and jerk. Both
/// are proportional to the speed of the polygon, so that this ends.
void slow_legs(std::vector<Vertex>& vertices, const Smoothing& smoothing,
               const MotionLimits& limits, const std::stop_token& stop) {
  constexpr double step = 0.1;
  constexpr int max_rounds = 200;
  for (int round = 0; round < max_rounds; ++round) {
    if (stop.stop_requested()) throw skycap::Interrupted();
    const std::vector<double> durations = leg_durations(vertices, smoothing);
    const std::vector<double> excesses = find_excesses(vertices, durations, smoothing, limits);
    if (excesses.empty()) return;
    const LegTimes legs(durations, smoothing);
    for (std::size_t leg = 0; leg < legs.count(); ++leg) {
      const bool is_fast =
          std::ranges::any_of(excesses, [&](double time) { return legs.affects(leg, time); });
      if (is_fast) vertices[leg].delay += step * durations[leg];
    }
  }
}

/// Returns the samples of a flight on a leg. The first and the last leg include the rest.
std::span<const FlightSample> samples_of(std::span<const FlightSample> flight, const LegTimes& legs,
                                         std::size_t leg) {
  const auto at = [&](double time) {
    return std::min(flight.size() - 1,
                    static_cast<std::size_t>(std::max(0.0, std::floor(time / sample_interval))));
  };
  const std::size_t begin = leg == 0 ? 0 : at(legs.start(leg));
  const std::size_t end = leg + 1 == legs.count()
                              ? flight.size() - 1
                              : std::min(flight.size() - 1, at(legs.end(leg)) + 1);
  return flight.subspan(begin, end - begin + 1);
}

/// Returns the violations of a leg: clearance, heights and pitch.
std::vector<std::string> find_problems(const InspectionOptions& options, const InspectionSite& site,
                                       const StructureCloud& cloud,
                                       std::span<const FlightSample> leg) {
  std::vector<std::string> problems;
  const double distance = verified_distance(options, site, cloud, leg);
  if (distance < options.planned_clearance()) {
    std::size_t nearest = 0;
    double min_distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < leg.size(); ++i) {
      const double found = verified_distance(options, site, cloud, leg.subspan(i, 2));
      if (found >= min_distance) continue;
      min_distance = found;
      nearest = i;
    }
    const auto centimetres = [](double length) { return 0.01 * std::round(100.0 * length); };
    const Vector3d& at = leg[nearest].position;
    problems.push_back(joined_text(
        centimetres(std::max(distance, 0.0)), " m from the nearest obstacle at (",
        centimetres(at.x()), ", ", centimetres(at.y()), ", ", centimetres(at.z()), "); at least ",
        options.planned_clearance(), " m required (clearance ", options.clearance, " m + ",
        options.flown_deviation, " m for the flown curve)"));
  }
  constexpr double rounding = 1e-6;
  double min_z = leg.front().position.z(), max_z = min_z;
  double min_pitch = leg.front().pitch, max_pitch = min_pitch;
  for (const FlightSample& sample : leg) {
    min_z = std::min(min_z, sample.position.z());
    max_z = std::max(max_z, sample.position.z());
    min_pitch = std::min(min_pitch, sample.pitch);
    max_pitch = std::max(max_pitch, sample.pitch);
  }
  if (site.min_height && min_z < *site.min_height - rounding) {
    problems.push_back(
        joined_text("height ", min_z, " m is below the minimum of ", *site.min_height, " m"));
  }
  if (site.max_height && max_z > *site.max_height + rounding) {
    problems.push_back(
        joined_text("height ", max_z, " m is above the maximum of ", *site.max_height, " m"));
  }
  if (min_pitch < options.pitch.min - rounding || max_pitch > options.pitch.max + rounding) {
    constexpr double degrees = geometry::degrees_per_radian;
    problems.push_back(joined_text("the gimbal pitch is outside of ", degrees * options.pitch.min,
                                   " to ", degrees * options.pitch.max, " degrees"));
  }
  return problems;
}

}  // namespace

void InspectionOptions::validate() const {
  camera.validate();
  limits.validate();
  const auto require = [](bool is_valid, const std::string& what) {
    if (!is_valid) throw Error(ErrorKind::bad_config, what);
  };
  require(clearance > 0.0 && std::isfinite(clearance), "clearance must be positive");
  require(flown_deviation >= 0.0 && std::isfinite(flown_deviation),
          "flown_deviation must not be negative");
  require(camera.range > planned_clearance(),
          joined_text("range (", camera.range, " m) must be greater than the clearance (",
                      planned_clearance(), " m); raise the range or lower the clearance"));
  require(pitch.min < pitch.max, "the minimum pitch must be less than the maximum pitch");
  for (const double share : goal.shares) {
    require(share >= 0.0 && share <= 1.0, "shares must be between 0 and 1");
  }
  require(goal.min_views >= 1, "min_views must be at least 1");
  require(moves >= 1, "moves must be at least 1");
  require(searches >= 1, "searches must be at least 1");
  require(candidates >= 1, "candidates must be at least 1");
}

InspectionPlan plan_inspection(const InspectionOptions& options, const InspectionSite& site,
                               const InspectionRun& run) {
  options.validate();
  const auto report = [&](const std::string& what) {
    if (run.report) run.report(what);
  };
  const auto check_stop = [&] {
    if (run.stop.stop_requested()) throw skycap::Interrupted();
  };
  const unsigned threads = geometry::thread_count(run.threads);
  report("computing normals");
  geometry::RandomNumbers random(run.seed, 0);
  const StructureCloud cloud = shuffled(make_structure_cloud(site.points, site.normals), random);
  check_stop();
  report("computing the distance field");
  const ReachableSpace space(cloud, space_options(options, site, cloud, threads));
  check_stop();

  report("choosing viewpoints");
  const SightCells cells(cloud, options.camera, space.box());
  TourOptions tour;
  tour.candidates = options.candidates;
  tour.targets = first_phase_targets(cloud.size());
  tour.pitch = options.pitch;
  tour.threads = threads;
  tour.share = 0.0;
  for (std::size_t rule = 0; rule < sight_rules; ++rule) {
    if (options.goal.shares[rule] <= 0.0) continue;
    tour.level = static_cast<std::uint32_t>(rule + 1);
    tour.share = options.goal.shares[rule];
  }
  const ViewCandidates candidates = draw_candidates(space, cells, tour, random);
  check_stop();
  const std::vector<Vertex> first = make_first_tour(space, cells, candidates, tour, run.stop);
  const Smoothing smoothing = make_smoothing(options.limits);
  require_short_flight(leg_durations(first, smoothing), smoothing);

  SearchOptions search;
  search.limits = options.limits;
  search.goal = options.goal;
  search.pitch = options.pitch;
  search.moves = options.moves;
  search.first_phase_targets = tour.targets;
  std::vector<SearchResult> results(options.searches);
  geometry::parallel_for(options.searches, threads, [&](std::size_t i) {
    geometry::RandomNumbers own(run.seed, i + 1);
    SearchProgress progress;
    if (i == 0) {
      progress = [&](double share, double duration) {
        report(joined_text("searching, ", std::round(100.0 * share), "%, flight of ",
                           std::round(duration), " s"));
      };
    }
    results[i] = search_route(space, cells, candidates, first, search, own, run.stop, progress);
  });
  check_stop();
  report("verifying the flight");
  InspectionPlan plan = verified_plan(options, site, cloud, results, threads);
  // The weights of the search leave out the last few points if they take long. By the rule "pixel"
  // it also counts points that a nearer one hides in each of their few views.
  PerRule<std::size_t> missing = missing_points(plan.evaluation, options.goal, candidates);
  const auto sum = [](const PerRule<std::size_t>& counts) {
    return counts[0] + counts[1] + counts[2];
  };
  constexpr int max_repairs = 3;
  for (int repair = 0; sum(missing) > 0 && repair < max_repairs; ++repair) {
    report(joined_text("adding views of ", sum(missing), " points"));
    if (plan.meets_goal) require_more_views(plan.evaluation, missing, candidates, search);
    constexpr std::size_t move_share = 15, min_moves = 500;
    search.moves = std::max(options.moves / move_share, min_moves);
    search.first_phase_targets = cloud.size();
    search.last_phase_share = 1.0;
    search.start_temperature = 0.1;
    search.min_unseen_weight = 1.0;
    geometry::RandomNumbers own(run.seed, options.searches + 1 + static_cast<std::size_t>(repair));
    results.push_back(search_route(space, cells, candidates, plan.vertices, search, own, run.stop));
    check_stop();
    if (results.back().improvements.empty()) continue;
    std::optional<InspectionPlan> repaired =
        find_verified_plan(options, site, cloud, {results.back()}, threads);
    if (!repaired) continue;
    const PerRule<std::size_t> left =
        missing_points(repaired->evaluation, options.goal, candidates);
    if (sum(left) >= sum(missing)) continue;
    missing = left;
    repaired->search = plan.search;
    repaired->first_duration = plan.first_duration;
    plan = *std::move(repaired);
  }
  plan.meets_goal = plan.meets_goal && sum(missing) == 0;
  for (const SearchResult& result : results) plan.evaluated_moves += result.evaluated;
  for (const std::uint8_t level : candidates.attainable) {
    for (std::size_t rule = 0; rule < level; ++rule) ++plan.attainable[rule];
  }
  plan.cells = cells.computed();
  plan.cloud = cloud;
  return plan;
}

GivenPlan follow_vertices(const InspectionOptions& options, const InspectionSite& site,
                          std::vector<Vertex> vertices, const InspectionRun& run) {
  options.validate();
  if (vertices.size() < 2) {
    throw Error(ErrorKind::bad_config, "an inspection flight requires at least two corners");
  }
  const unsigned threads = geometry::thread_count(run.threads);
  geometry::RandomNumbers random(run.seed, 0);
  GivenPlan given;
  InspectionPlan& plan = given.plan;
  plan.cloud = shuffled(make_structure_cloud(site.points, site.normals), random);
  plan.smoothing = make_smoothing(options.limits);
  plan.vertices = std::move(vertices);
  const std::vector<Vertex> before = plan.vertices;
  slow_legs(plan.vertices, plan.smoothing, options.limits, run.stop);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double added = plan.vertices[i].delay - before[i].delay;
    given.slowed_legs += added > 0.0 ? 1 : 0;
    given.added_delay += added;
  }
  const std::vector<double> durations = leg_durations(plan.vertices, plan.smoothing);
  require_short_flight(durations, plan.smoothing);
  plan.samples = sample_flight(plan.vertices, plan.smoothing, sample_interval);
  const LegTimes legs(durations, plan.smoothing);
  for (std::size_t leg = 0; leg < legs.count(); ++leg) {
    if (run.stop.stop_requested()) throw skycap::Interrupted();
    for (std::string& what :
         find_problems(options, site, plan.cloud, samples_of(plan.samples, legs, leg))) {
      given.problems.push_back({leg, std::move(what)});
    }
  }
  if (!given.problems.empty()) return given;
  plan.verified_clearance = verified_distance(options, site, plan.cloud, plan.samples);
  plan.evaluation = evaluate_flight(plan.samples, plan.cloud, evaluation_options(options, threads));
  if (!plan.evaluation.keeps_limits()) {
    given.problems.push_back({std::nullopt, "the flight exceeds the motion limits of the vehicle"});
  }
  return given;
}

}  // namespace skycap::survey::inspection

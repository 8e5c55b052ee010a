#include "survey/photo/photo_planner.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/requirement.h"
#include "geometry/surfaces/sight_lines.h"

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3d;

/// Returns a length in metres or, below one metre, in millimetres.
std::string length_text(double metres) {
  const double value = metres < 1.0 ? 1e3 * metres : metres;
  std::string text = std::to_string(std::round(100.0 * value) / 100.0);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text + (metres < 1.0 ? " mm" : " m");
}

std::string percent_text(double share) {
  const long tenths = std::lround(1e3 * share);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + "%";
}

/// Returns the number of samples for the selection of photos. It is larger for targets that are
/// large in relation to a photo, and smaller for targets that fit into a few photos.
std::size_t samples_for(double area, double view_distance) {
  constexpr double per_square = 1000.0;  // Samples in a square with side d.
  constexpr double usual_samples = 8000.0, max_samples = 20000.0;
  constexpr double small = 4.0, min_samples = 1500.0;  // Targets below 4 d^2 are small.
  const double squares = area / (view_distance * view_distance);
  if (squares < small) {
    const double share = squares / small;
    return static_cast<std::size_t>(std::max(min_samples, usual_samples * share * share));
  }
  return static_cast<std::size_t>(std::clamp(per_square * squares, usual_samples, max_samples));
}

std::size_t candidates_for(std::size_t samples) {
  return std::clamp<std::size_t>(samples / 3, 700, 5000);
}

/// Computes classes, histogram and completeness of the samples of a selection.
PhotoFigures compute_figures(const PhotoChoice& choice, std::size_t samples, std::size_t photos,
                             std::size_t attainable) {
  PhotoFigures figures;
  figures.photos = photos;
  figures.samples = samples;
  figures.attainable = attainable;
  figures.satisfied = choice.satisfied();
  for (std::size_t s = 0; s < samples; ++s) {
    const int k = choice.partners(s);
    const double h = choice.reconstructability(s);
    ++figures.by_partners[static_cast<std::size_t>(std::min(k, 6) + 2)];
    if (k >= 3 || h >= 1.0) {
      ++figures.good;
    } else if (k == 2 || h >= 0.2) {
      ++figures.weak;
    } else {
      ++figures.missing;
    }
  }
  for (std::size_t i = 0; i < figures.by_partners.size(); ++i) {
    const int k = static_cast<int>(i) - 2;
    const double share = figures.share(figures.by_partners[i]);
    figures.completeness += share * expected_completeness(k);
    figures.threefold += share * expected_threefold(k);
  }
  return figures;
}

class Planner {
 public:
  Planner(const PhotoPlanOptions& options, const PhotoSite& site, const PhotoPlanRun& run)
      : options_(options),
        site_(site),
        run_(run),
        camera_(options.camera),
        rule_(options.rule),
        sights_(obstructions(site), run.threads) {
    rule_.view_distance = camera_.distance(options.gsd);
    rule_.nearest_focus = options.camera.nearest_focus;
    require_distance();
    result_.view_distance = rule_.view_distance;
    result_.surface_area = surface_area(site.target);
  }

  PhotoPlanResult plan() {
    report("sampling the target");
    const std::size_t count = samples_for(result_.surface_area, rule_.view_distance);
    chosen_on_ = sampled(count, 2 * run_.seed);
    evaluated_on_ = sampled(count, 2 * run_.seed + 1);
    require_exposed();
    result_.exposed_area = evaluated_on_.area();
    const Observer observer(camera_, rule_, sights_, chosen_on_);
    const Observer evaluator(camera_, rule_, sights_, evaluated_on_);

    report("searching for candidate photos");
    const PhotoChoiceProblem problem = make_problem(observer);
    find_attainable(problem.candidates, evaluator);
    PhotoChoice choice(problem);
    choose(problem, choice);
    set_bound(problem, choice);
    set_views(problem, choice);
    connect(problem, observer);
    set_figures(evaluator);
    compare_patterns(observer, evaluator);
    return std::move(result_);
  }

  std::vector<PhotoFigures> evaluate(const std::vector<std::vector<geometry::View>>& sets) {
    const std::size_t count = samples_for(result_.surface_area, rule_.view_distance);
    evaluated_on_ = sampled(count, 2 * run_.seed + 1);
    const Observer evaluator(camera_, rule_, sights_, evaluated_on_);
    std::vector<PhotoFigures> figures;
    for (const std::vector<geometry::View>& views : sets) {
      figures.push_back(evaluated(views, evaluator));
    }
    return figures;
  }

 private:
  static geometry::Mesh obstructions(const PhotoSite& site) {
    geometry::Mesh all = site.target;
    append(all, site.surroundings);
    return all;
  }

  void report(const std::string& what) const {
    if (run_.report) run_.report(what);
  }

  void require_distance() const {
    const double d = rule_.view_distance, min_standoff = site_.space.min_standoff;
    if (d < min_standoff) {
      throw Error(ErrorKind::bad_config,
                  "photo.gsd (" + length_text(options_.gsd) + ") requires a view distance of " +
                      length_text(d) + ", which is below limits.stand_off (" +
                      length_text(min_standoff) + "): at " + length_text(min_standoff) +
                      " this camera has a GSD of " + length_text(camera_.gsd(min_standoff)) +
                      "; raise photo.gsd or lower limits.stand_off");
    }
    if (d < rule_.nearest_focus) {
      throw Error(ErrorKind::bad_config,
                  "photo.gsd (" + length_text(options_.gsd) + ") requires a view distance of " +
                      length_text(d) + ", which is below the nearest focus of the camera (" +
                      length_text(rule_.nearest_focus) + "); raise photo.gsd");
    }
  }

  TargetSamples sampled(std::size_t count, std::uint64_t seed) const {
    SampleOptions options;
    options.count = count;
    options.seed = seed;
    options.free_length = 1.5 * rule_.view_distance;
    options.min_standoff = site_.space.min_standoff;
    options.ground = site_.ground;
    options.threads = run_.threads;
    return sample_target(site_.target, sights_, options);
  }

  void require_exposed() const {
    const std::size_t exposed = std::min(chosen_on_.size(), evaluated_on_.size());
    const std::size_t all = chosen_on_.size() + chosen_on_.inner;
    constexpr double min_share = 0.1;
    if (static_cast<double>(exposed) >= min_share * static_cast<double>(all)) return;
    throw Error(ErrorKind::bad_geometry,
                "only " + percent_text(static_cast<double>(exposed) / static_cast<double>(all)) +
                    " of the target's surface is exposed (at least 10% is required): the model is "
                    "inside out, an interior model, or below the ground; check the unit and the "
                    "position of the prior data, and exclude other objects with select");
  }

  PatternOptions pattern_options() const {
    return {rule_.view_distance, options_.forward_overlap, options_.side_overlap, site_.foot,
            site_.min_height};
  }

  PatternPhotos make_photos(Pattern pattern) const {
    return pattern_photos(pattern, camera_, site_.target, pattern_options(), site_.space);
  }

  /// Returns the candidates: candidate photos and the photos of all patterns that are compared.
  PhotoChoiceProblem make_problem(const Observer& observer) {
    std::vector<geometry::View> candidates;
    if (options_.flown_pattern) {
      PatternPhotos photos = make_photos(*options_.flown_pattern);
      if (photos.is_too_large) {
        throw Error(ErrorKind::bad_config,
                    "the pattern " + std::string(to_string(*options_.flown_pattern)) +
                        " has more than " + std::to_string(pattern_options().max_views) +
                        " photos; raise photo.gsd or divide the target");
      }
      candidates = std::move(photos.views);
    } else {
      candidates = candidate_photos(observer, site_.space,
                                    {candidates_for(chosen_on_.size()), run_.seed, run_.threads});
      for (const Pattern pattern : options_.patterns) {
        const PatternPhotos photos = make_photos(pattern);
        candidates.insert(candidates.end(), photos.views.begin(), photos.views.end());
      }
    }
    result_.candidates = candidates.size();
    report("computing visibility");
    PhotoChoiceProblem problem =
        photo_choice_problem(std::move(candidates), observer, false, run_.threads);
    if (problem.observed.items.empty()) {
      throw Error(ErrorKind::bad_geometry,
                  "no photo observes the target (" + std::to_string(result_.candidates) +
                      " candidates, " + std::to_string(chosen_on_.inner) +
                      " samples on inner surfaces); check the model's units and normals, "
                      "limits.stand_off and flight.free_space");
    }
    return problem;
  }

  /// Determines the evaluation samples that are satisfied if all candidates are taken.
  void find_attainable(const std::vector<geometry::View>& candidates, const Observer& evaluator) {
    report("computing the attainable surface");
    std::vector<Vector3d> positions;
    std::vector<Observer::Photo> photos;
    for (const geometry::View& view : candidates) {
      positions.push_back(view.position);
      photos.emplace_back(view);
    }
    const std::vector<std::uint32_t> same = same_positions(positions, rule_.same_position());
    const StereoPairs pairs(rule_);
    is_attainable_.assign(evaluated_on_.size(), 0);
    geometry::parallel_for_each(evaluated_on_.size(), run_.threads, [&](std::size_t s) {
      is_attainable_[s] = is_satisfied_by(photos, same, evaluator, pairs, s) ? 1 : 0;
    });
  }

  bool is_satisfied_by(const std::vector<Observer::Photo>& photos,
                       const std::vector<std::uint32_t>& same, const Observer& evaluator,
                       const StereoPairs& pairs, std::size_t sample) const {
    std::vector<Observation> seen;
    std::vector<int> partners;
    for (std::size_t i = 0; i < photos.size(); ++i) {
      if (!evaluator.observes(photos[i], sample)) continue;
      const Observation added =
          make_observation(photos[i].view.position, same[i], evaluator.samples(), sample);
      const auto is_same = [&](const Observation& o) { return o.photo == added.photo; };
      if (std::ranges::any_of(seen, is_same)) continue;
      int own = 0;
      for (std::size_t j = 0; j < seen.size(); ++j) {
        if (!pairs.are_partners(added, seen[j])) continue;
        ++own;
        if (++partners[j] >= rule_.min_partners) return true;
      }
      if (own >= rule_.min_partners) return true;
      seen.push_back(added);
      partners.push_back(own);
    }
    return false;
  }

  void choose(const PhotoChoiceProblem& problem, PhotoChoice& choice) {
    if (options_.flown_pattern) {
      for (std::uint32_t c = 0; c < problem.candidates.size(); ++c) choice.add(c);
      result_.greedy_photos = result_.repaired_photos = problem.candidates.size();
      return;
    }
    PhotoChoice::Limits limits;
    // One photo observes a small fraction of the samples of a large target.
    constexpr double min_gain = 0.002, large = 20.0;  // Fraction of the samples; area in d^2.
    const double d = rule_.view_distance, squares = result_.surface_area / (d * d);
    limits.min_gain =
        min_gain * static_cast<double>(chosen_on_.size()) * std::min(1.0, large / squares);
    limits.max_photos = options_.max_photos;
    if (options_.target_share < 1.0) {
      limits.enough_satisfied = static_cast<std::size_t>(std::ceil(
          options_.target_share * attainable_share() * static_cast<double>(chosen_on_.size())));
    }
    choice.greedy(limits,
                  [&] { report("choosing photos: " + std::to_string(choice.chosen().size())); });
    result_.greedy_photos = choice.chosen().size();
    report("removing photos: " + std::to_string(choice.chosen().size()));
    choice.destroy_and_repair({repair_rounds(result_.greedy_photos), run_.seed}, run_.stop);
    result_.repaired_photos = choice.chosen().size();
  }

  /// Returns the number of rounds of the search for a plan. Each round changes a part of a large
  /// plan, and small plans have few parts.
  std::size_t repair_rounds(std::size_t photos) const {
    constexpr std::size_t photos_per_share = 100, few_photos = 50, rounds_per_photo = 18;
    if (photos < few_photos) return std::min(options_.repair_rounds, rounds_per_photo * photos);
    return options_.repair_rounds * std::max<std::size_t>(1, photos / photos_per_share);
  }

  double attainable_share() const {
    const auto count = std::ranges::count(is_attainable_, 1);
    return static_cast<double>(count) / static_cast<double>(is_attainable_.size());
  }

  void set_bound(const PhotoChoiceProblem& problem, const PhotoChoice& choice) {
    if (options_.flown_pattern) return;
    report("computing the lower bound");
    std::vector<std::uint32_t> satisfied;
    for (std::uint32_t s = 0; s < chosen_on_.size(); ++s) {
      if (choice.is_satisfied(s)) satisfied.push_back(s);
    }
    result_.bound = cover_bound(problem, satisfied, rule_.min_partners + 1, choice.chosen().size());
  }

  /// Stores the selected photos, most useful first.
  void set_views(const PhotoChoiceProblem& problem, const PhotoChoice& choice) {
    const PhotoChoiceProblem part = with_candidates(problem, choice.chosen());
    if (options_.flown_pattern) {
      result_.views = part.candidates;
      return;
    }
    PhotoChoice ordered(part);
    PhotoChoice::Limits all;
    all.min_gain = -1.0;
    ordered.greedy(all);
    for (const std::uint32_t c : ordered.chosen()) result_.views.push_back(part.candidates[c]);
  }

  void connect(const PhotoChoiceProblem& problem, const Observer& observer) {
    report("connecting photos");
    const EdgeRule rule;
    constexpr std::size_t min_degree = 3;
    IndexLists observed = observed_samples(observer, result_.views, run_.threads);
    if (options_.poses == PosesGiven::unknown && !options_.flown_pattern) {
      result_.graph = view_graph(result_.views, observed, chosen_on_, rule, run_.threads);
      std::vector<geometry::View> candidates = fans(result_.graph);
      IndexLists seen = observed_samples(observer, candidates, run_.threads);
      candidates.insert(candidates.end(), problem.candidates.begin(), problem.candidates.end());
      seen.append(problem.observed);
      // A plan that requires more photos to connect it than it has is not worth the search.
      const std::size_t room =
          std::min(result_.views.size(),
                   options_.max_photos - std::min(options_.max_photos, result_.views.size()));
      const std::vector<std::uint32_t> added =
          connecting_photos(result_.views, observed, candidates, seen, chosen_on_, rule, min_degree,
                            rule_.same_position(), room, run_.threads);
      for (const std::uint32_t c : added) result_.views.push_back(candidates[c]);
      result_.connecting = added.size();
      observed = observed_samples(observer, result_.views, run_.threads);
    }
    result_.graph = view_graph(result_.views, observed, chosen_on_, rule, run_.threads);
    result_.matching_pairs = matchable_pairs(result_.views, observed, chosen_on_, rule,
                                             min_matchable_to_match, run_.threads);
    warn_of_graph(min_degree);
  }

  /// Returns fans of photos between each photo and the closest ones that do not register with it.
  std::vector<geometry::View> fans(const ViewGraph& graph) const {
    constexpr std::size_t fans_each = 4;
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t i = 0; i < graph.photos; ++i) {
      std::vector<std::pair<double, std::uint32_t>> others;
      for (std::uint32_t j = 0; j < graph.photos; ++j) {
        if (graph.part[i] == graph.part[j] && graph.is_registered[i] == graph.is_registered[j]) {
          continue;
        }
        const geometry::View &a = result_.views[i], &b = result_.views[j];
        others.emplace_back((a.position - b.position).norm() +
                                0.5 * rule_.view_distance * (a.direction - b.direction).norm(),
                            j);
      }
      std::ranges::sort(others);
      for (std::size_t k = 0; k < std::min(fans_each, others.size()); ++k) {
        pairs.emplace(std::min(i, others[k].second), std::max(i, others[k].second));
      }
    }
    std::vector<geometry::View> result;
    for (const auto& [i, j] : pairs) {
      const std::vector<geometry::View> fan =
          photos_between(result_.views[i], result_.views[j], rule_.view_distance, site_.space);
      result.insert(result.end(), fan.begin(), fan.end());
    }
    return result;
  }

  void warn_of_graph(std::size_t min_degree) {
    const bool is_unknown = options_.poses == PosesGiven::unknown;
    const ViewGraph& graph = result_.graph;
    if (is_unknown && graph.is_connected(min_degree) && graph.registered < graph.photos) {
      result_.warnings.push_back(
          std::to_string(graph.photos - graph.registered) + " of " + std::to_string(graph.photos) +
          " photos cannot be registered without poses, because they do not overlap enough with at "
          "least two other photos; raise photo.max_photos or photo.gsd");
    }
    if (result_.graph.is_connected(is_unknown ? min_degree : 0)) return;
    std::string parts;
    for (const std::size_t photos : result_.graph.parts) {
      parts += (parts.empty() ? "" : ", ") + std::to_string(photos);
    }
    const std::string what = "the photos form " + std::to_string(result_.graph.parts.size()) +
                             " parts that overlap too little to be registered to one another (" +
                             parts + " photos)";
    if (!is_unknown) {
      result_.warnings.push_back(what +
                                 "; import the photo poses into the photogrammetry program, or set "
                                 "photo.poses: unknown, which adds connecting photos");
      return;
    }
    throw Error(
        ErrorKind::bad_config,
        "photo.poses: unknown requires that all photos can be registered to one another, each to "
        "at least " +
            std::to_string(min_degree) + " others; " + what +
            ", or some photos have too few connections; raise photo.max_photos or photo.gsd, or "
            "set photo.poses: known (RTK or PPK)");
  }

  PhotoFigures evaluated(const std::vector<geometry::View>& views, const Observer& evaluator) {
    const PhotoChoiceProblem problem = photo_choice_problem(views, evaluator, true, run_.threads);
    PhotoChoice all(problem);
    for (std::uint32_t i = 0; i < views.size(); ++i) all.add(i);
    return compute_figures(all, evaluated_on_.size(), views.size(), attainable());
  }

  std::size_t attainable() const {
    return static_cast<std::size_t>(std::ranges::count(is_attainable_, 1));
  }

  void set_figures(const Observer& evaluator) {
    report("evaluating the plan");
    const PhotoChoiceProblem problem =
        photo_choice_problem(result_.views, evaluator, true, run_.threads);
    PhotoChoice growing(problem);
    for (std::uint32_t i = 0; i < result_.views.size(); ++i) {
      growing.add(i);
      const PhotoFigures figures =
          compute_figures(growing, evaluated_on_.size(), i + 1, attainable());
      result_.curve.push_back({i + 1, figures.completeness, figures.share(figures.satisfied)});
      result_.figures = figures;
    }
    for (const geometry::View& view : result_.views) {
      result_.observed.push_back(static_cast<std::uint32_t>(evaluator.observed(view).size()));
      const auto hit = sights_.first_hit(view.position, view.direction, 4.0 * rule_.view_distance);
      result_.gsd.push_back(hit ? camera_.gsd(*hit) : 0.0);
    }
    find_missing(growing);
  }

  void find_missing(const PhotoChoice& plan) {
    std::vector<MissingReason> reasons(evaluated_on_.size());
    geometry::parallel_for_each(evaluated_on_.size(), run_.threads, [&](std::size_t s) {
      if (plan.is_satisfied(s)) return;
      reasons[s] = is_attainable_[s] != 0 ? MissingReason::not_taken : find_reason(s);
    });
    for (std::size_t s = 0; s < reasons.size(); ++s) {
      if (plan.is_satisfied(s)) continue;
      result_.missing_area[static_cast<std::size_t>(reasons[s])] += evaluated_on_.area_each;
    }
  }

  /// Returns the condition that alone excludes most photos of a sample.
  MissingReason find_reason(std::size_t sample) const {
    constexpr int directions = 128;
    const Vector3d point = evaluated_on_.points[sample].cast<double>();
    const Vector3d normal = evaluated_on_.normals[sample].cast<double>().normalized();
    const Vector3d first = geometry::any_orthogonal(normal), second = normal.cross(first);
    const double min_cosine = std::cos(rule_.max_incidence);
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    std::array<int, missing_reasons> barred{};
    for (int i = 0; i < directions; ++i) {
      const double z = (i + 0.5) / directions, level = std::sqrt(1.0 - z * z);
      const Vector3d towards =
          level * std::cos(golden * i) * first + level * std::sin(golden * i) * second + z * normal;
      for (const double share : {1.0, 0.64}) {
        if (share * rule_.view_distance < site_.space.min_standoff) continue;
        if (const auto one =
                only_bar(point, towards, share * rule_.view_distance, z < min_cosine)) {
          ++barred[static_cast<std::size_t>(*one)];
        }
      }
    }
    const auto max = std::ranges::max_element(barred);
    return *max == 0 ? MissingReason::occluded : static_cast<MissingReason>(max - barred.begin());
  }

  /// Returns the condition that a photo violates, or nullopt if it violates none or several.
  std::optional<MissingReason> only_bar(const Vector3d& point, const Vector3d& towards,
                                        double distance, bool is_flat) const {
    const Vector3d position = point + distance * towards;
    const ViewLimits& limits = site_.space.limits;
    const double pitch = std::asin(std::clamp(-towards.z(), -1.0, 1.0));
    constexpr double rounding = 1e-6;
    std::optional<MissingReason> bar;
    int bars = 0;
    const auto set = [&](bool is_barred, MissingReason reason) {
      if (is_barred) bar = reason, ++bars;
    };
    const bool is_low = (limits.min_height && position.z() < *limits.min_height - rounding) ||
                        (limits.min_height_at &&
                         position.z() < limits.min_height_at(position.head<2>()) - rounding);
    set(is_low, MissingReason::height);
    set(pitch < limits.min_pitch - rounding || pitch > limits.max_pitch + rounding,
        MissingReason::gimbal);
    set(is_flat, MissingReason::incidence);
    if (bars > 1) return std::nullopt;
    set(!sights_.is_clear(position, point, 0.999), MissingReason::occluded);
    if (bars > 1) return std::nullopt;
    set(!is_low && site_.space.is_free && !site_.space.is_free(position),
        MissingReason::min_standoff);
    return bars == 1 ? bar : std::nullopt;
  }

  /// Selects few photos that satisfy as many samples as all candidates do, with a greedy selection
  /// and the subsequent search.
  PhotoChoice pruned_choice(const PhotoChoiceProblem& own) const {
    PhotoChoice all(own);
    for (std::uint32_t c = 0; c < own.candidates.size(); ++c) all.add(c);
    PhotoChoice pruned(own);
    PhotoChoice::Limits limits;
    limits.min_gain = 1e-3;
    limits.enough_satisfied = all.satisfied();
    pruned.greedy(limits);
    constexpr std::size_t part_of_rounds = 3;  // The photos are only compared with the plan.
    const std::size_t rounds =
        std::min(options_.repair_rounds, repair_rounds(pruned.chosen().size()));
    pruned.destroy_and_repair({rounds / part_of_rounds, run_.seed}, run_.stop);
    return pruned;
  }

  void compare_patterns(const Observer& observer, const Observer& evaluator) {
    for (const Pattern pattern : options_.patterns) {
      report(std::string("evaluating the pattern ") + to_string(pattern));
      PatternPhotos photos = make_photos(pattern);
      if (photos.is_too_large) {
        result_.warnings.push_back("the pattern " + std::string(to_string(pattern)) +
                                   " has more than " + std::to_string(pattern_options().max_views) +
                                   " photos and is not compared with the plan");
        continue;
      }
      PatternResult result;
      result.pattern = pattern;
      result.dropped = photos.dropped;
      result.figures = evaluated(photos.views, evaluator);
      const PhotoChoiceProblem own =
          photo_choice_problem(photos.views, observer, false, run_.threads);
      PhotoChoice pruned = pruned_choice(own);
      for (const std::uint32_t c : pruned.chosen()) {
        result.pruned_views.push_back(own.candidates[c]);
      }
      result.pruned = evaluated(result.pruned_views, evaluator);
      result.views = std::move(photos.views);
      result_.patterns.push_back(std::move(result));
    }
  }

  const PhotoPlanOptions& options_;
  const PhotoSite& site_;
  const PhotoPlanRun& run_;
  geometry::PhotoCamera camera_;
  StereoRule rule_;
  geometry::SightLines sights_;
  TargetSamples chosen_on_, evaluated_on_;
  std::vector<char> is_attainable_;  ///< 1 for each attainable evaluation sample.
  PhotoPlanResult result_;
};

void require_surface(const PhotoSite& site) {
  const double area = surface_area(site.target);
  if (area > 0.0 && std::isfinite(area)) return;
  throw Error(
      ErrorKind::bad_geometry,
      "the target has no surface; specify a mesh, a city model or an outline with a height");
}

}  // namespace

const char* to_string(MissingReason reason) {
  constexpr std::array<const char*, missing_reasons> names{"occluded", "stand_off", "incidence",
                                                           "gimbal",   "height",    "not_taken"};
  return names[static_cast<std::size_t>(reason)];
}

void PhotoPlanOptions::validate() const {
  camera.validate();
  require(gsd > 0.0 && std::isfinite(gsd), "gsd", gsd, "more than 0 m");
  StereoRule checked = rule;
  checked.view_distance = 1.0;
  checked.validate();
  for (const double overlap : {forward_overlap, side_overlap}) {
    require(overlap >= 0.0 && overlap <= 0.95, "overlap", overlap, "between 0 and 0.95");
  }
  require(target_share > 0.0 && target_share <= 1.0, "target_share", target_share,
          "more than 0 and at most 1");
  require(max_photos >= 1, "max_photos", static_cast<double>(max_photos), "at least 1");
}

PhotoPlanResult plan_photos(const PhotoPlanOptions& options, const PhotoSite& site,
                            const PhotoPlanRun& run) {
  options.validate();
  require_surface(site);
  return Planner(options, site, run).plan();
}

std::vector<PhotoFigures> evaluate_photos(const PhotoPlanOptions& options, const PhotoSite& site,
                                          const PhotoPlanRun& run,
                                          const std::vector<std::vector<geometry::View>>& sets) {
  options.validate();
  require_surface(site);
  return Planner(options, site, run).evaluate(sets);
}

}  // namespace skycap::survey::photo

#include "missions/package/replan/tour_search.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "geometry/random_numbers.h"
#include "missions/package/replan/leg_doses.h"
#include "missions/package/replan/leg_times.h"
#include "missions/package/replan/observation_sum.h"
#include "missions/package/replan/tour_moves.h"

namespace skycap::missions::package {
namespace {

using geometry::View;

/// Final relative step size of moved views.
constexpr double last_scale = 0.3;

std::vector<View> viewed_from(const Stops& stops) {
  std::vector<View> views;
  for (const auto& stop : stops) views.push_back(stop->view);
  return views;
}

std::vector<ObservationStrength> strengths_in_sight(const TourProblem& problem, const View& view) {
  std::vector<survey::surfel::Observation> observations = problem.observations(view);
  if (problem.remove_occluded) problem.remove_occluded(view, observations);
  return observation_strengths(observations);
}

/// State of the search: a tour with its coverage and duration.
class Search {
 public:
  Search(const TourProblem& problem, const std::vector<View>& tour, double target_coverage,
         std::uint64_t seed)
      : problem_(problem),
        target_coverage_(target_coverage),
        random_(seed, 0),
        moves_(problem, random_),
        legs_(problem),
        leg_doses_(problem),
        covered_(problem.targets) {
    for (const View& view : tour) {
      const std::shared_ptr<Stop> stop = moves_.stop(view);
      stop->strengths = strengths_in_sight(problem, view);
      covered_.add(stop->strengths);
      stops_.push_back(stop);
    }
    leg_doses_.change(covered_, {}, stops_);
    time_ = legs_.verified_time(stops_);
    keep_best();
  }

  void remove_views() {
    while (const auto without = remove_one_view()) {
      stops_ = *without;
      time_ = legs_.verified_time(stops_);
      covered_ = ObservationSum(problem_.targets);
      for (const auto& stop : stops_) covered_.add(stop->strengths);
      leg_doses_.change(covered_, {}, stops_);
    }
    keep_best();
  }

  void anneal(const SearchSettings& settings, const std::stop_token& stop) {
    price_ = 100.0 * settings.price;
    const double fall = std::log(settings.last_temperature / settings.first_temperature);
    const std::size_t moves = settings.moves_per_view * stops_.size();
    for (std::size_t i = 0; i < moves && !stop.stop_requested(); ++i) {
      const double progress = static_cast<double>(i) / static_cast<double>(moves);
      const double temperature = settings.first_temperature * std::exp(progress * fall);
      const double worst = cost(time_) - temperature * std::log(1.0 - random_.uniform());
      const auto move = moves_.propose(stops_, covered_, std::pow(last_scale, progress));
      if (move && accept(*move, worst)) keep_best();
    }
  }

  FoundTour found() const {
    return best_ ? *best_ : FoundTour{viewed_from(stops_), time_, covered_.covered()};
  }

 private:
  double cost(double time) const {
    return time + price_ * std::max(0.0, target_coverage_ - covered_.covered());
  }

  /// Applies the move if the new cost is at most `worst`. Inexpensive checks are made first: until
  /// the last one, the added view observes all that a coarse surface lets it see.
  bool accept(const Move& move, double worst) {
    if (legs_.min(move.stops) > worst) return false;
    if (move.added) {
      const View& view = move.added->view;
      if (!problem_.is_allowed(view) || !problem_.is_in_free_space(view)) return false;
      move.added->strengths = observation_strengths(problem_.observations(view));
    }
    change(move.removed, move.added.get());
    leg_doses_.change(covered_, stops_, move.stops);
    double time = legs_.min(move.stops);
    while (cost(time) <= worst && legs_.ask_next(move.stops)) time = legs_.min(move.stops);
    if (cost(time) <= worst && move.added && problem_.remove_occluded) {
      covered_.remove(move.added->strengths);
      move.added->strengths = strengths_in_sight(problem_, move.added->view);
      covered_.add(move.added->strengths);
    }
    if (cost(time) > worst || (move.added && !problem_.has_return_path(move.added->view))) {
      leg_doses_.change(covered_, move.stops, stops_);
      change_back(move.removed, move.added.get());
      return false;
    }
    stops_ = move.stops;
    time_ = time;
    return true;
  }

  void change(const Stops& removed, const Stop* added) {
    for (const auto& stop : removed) covered_.remove(stop->strengths);
    if (added != nullptr) covered_.add(added->strengths);
  }

  void change_back(const Stops& removed, const Stop* added) {
    if (added != nullptr) covered_.remove(added->strengths);
    for (const auto& stop : removed) covered_.add(stop->strengths);
  }

  void keep_best() {
    const double covered = covered_.covered();
    const auto is_best = [&] {
      return covered >= target_coverage_ && (!best_ || time_ < best_->time);
    };
    if (!is_best()) return;
    time_ = legs_.verified_time(stops_);
    if (is_best()) best_ = FoundTour{viewed_from(stops_), time_, covered};
  }

  /// Returns the fastest tour with one stop less that still has the required coverage.
  std::optional<Stops> remove_one_view() {
    std::optional<Stops> best;
    double min = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < stops_.size(); ++i) {
      Stops without = stops_;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
      covered_.remove(stops_[i]->strengths);
      leg_doses_.change(covered_, stops_, without);
      const bool is_enough = covered_.covered() >= target_coverage_;
      leg_doses_.change(covered_, without, stops_);
      covered_.add(stops_[i]->strengths);
      if (!is_enough) continue;
      const double time = legs_.verified_time(without);
      if (time < min) best = std::move(without), min = time;
    }
    return best;
  }

  const TourProblem& problem_;
  double target_coverage_;
  geometry::RandomNumbers random_;
  TourMoves moves_;
  LegTimes legs_;
  LegDoses leg_doses_;
  ObservationSum covered_;
  Stops stops_;
  double time_ = 0.0;
  double price_ = 0.0;  ///< Cost of missing the whole surface [s].
  std::optional<FoundTour> best_;
};

}  // namespace

FoundTour remove_views(const TourProblem& problem, const std::vector<View>& tour,
                       double target_coverage) {
  Search search(problem, tour, target_coverage, 0);
  search.remove_views();
  return search.found();
}

FoundTour anneal(const TourProblem& problem, const std::vector<View>& tour, double target_coverage,
                 const SearchSettings& settings, const std::stop_token& stop) {
  Search search(problem, tour, target_coverage, settings.seed);
  search.anneal(settings, stop);
  return search.found();
}

double covered_by(const TourProblem& problem, const std::vector<View>& views) {
  ObservationSum covered(problem.targets);
  for (const View& view : views) covered.add(strengths_in_sight(problem, view));
  if (!problem.leg_observations) return covered.covered();
  for (std::size_t i = 0; i <= views.size() && !views.empty(); ++i) {
    const auto* from = i == 0 ? nullptr : &views[i - 1];
    const auto* to = i == views.size() ? nullptr : &views[i];
    covered.add(observation_strengths(problem.leg_observations(from, to)));
  }
  return covered.covered();
}

}  // namespace skycap::missions::package

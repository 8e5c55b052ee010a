#include "missions/package/replan/tour_search.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "geometry/random_numbers.h"
#include "missions/package/replan/dose_sum.h"
#include "missions/package/replan/leg_times.h"
#include "missions/package/replan/tour_moves.h"
#include "missions/package/replan/way_doses.h"

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

/// State of the search: a tour with its coverage and duration.
class Search {
 public:
  Search(const TourProblem& problem, const std::vector<View>& tour, double wanted,
         std::uint64_t seed)
      : problem_(problem),
        wanted_(wanted),
        random_(seed, 0),
        moves_(problem, random_),
        legs_(problem),
        ways_(problem),
        covered_(problem.targets) {
    for (const View& view : tour) {
      const std::shared_ptr<Stop> stop = moves_.stop(view);
      stop->doses = doses_of(problem.looks(view));
      covered_.add(stop->doses);
      stops_.push_back(stop);
    }
    ways_.change(covered_, {}, stops_);
    time_ = legs_.proven(stops_);
    keep_best();
  }

  void spare() {
    while (const auto without = least_without_one()) {
      stops_ = *without;
      time_ = legs_.proven(stops_);
      covered_ = DoseSum(problem_.targets);
      for (const auto& stop : stops_) covered_.add(stop->doses);
      ways_.change(covered_, {}, stops_);
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
      if (move && take(*move, worst)) keep_best();
    }
  }

  FoundTour found() const {
    return best_ ? *best_ : FoundTour{viewed_from(stops_), time_, covered_.covered()};
  }

 private:
  double cost(double time) const {
    return time + price_ * std::max(0.0, wanted_ - covered_.covered());
  }

  /// Applies the move if the new cost is at most `worst`. Inexpensive checks are made first.
  bool take(const Move& move, double worst) {
    if (legs_.least(move.stops) > worst) return false;
    if (move.added) {
      const View& view = move.added->view;
      if (!problem_.is_allowed(view) || !problem_.is_in_free_space(view)) return false;
      move.added->doses = doses_of(problem_.looks(view));
    }
    change(move.removed, move.added.get());
    ways_.change(covered_, stops_, move.stops);
    double time = legs_.least(move.stops);
    while (cost(time) <= worst && legs_.ask_next(move.stops)) time = legs_.least(move.stops);
    if (cost(time) > worst || (move.added && !problem_.has_way_home(move.added->view))) {
      ways_.change(covered_, move.stops, stops_);
      change_back(move.removed, move.added.get());
      return false;
    }
    stops_ = move.stops;
    time_ = time;
    return true;
  }

  void change(const Stops& removed, const Stop* added) {
    for (const auto& stop : removed) covered_.remove(stop->doses);
    if (added != nullptr) covered_.add(added->doses);
  }

  void change_back(const Stops& removed, const Stop* added) {
    if (added != nullptr) covered_.remove(added->doses);
    for (const auto& stop : removed) covered_.add(stop->doses);
  }

  void keep_best() {
    const double covered = covered_.covered();
    const auto is_best = [&] { return covered >= wanted_ && (!best_ || time_ < best_->time); };
    if (!is_best()) return;
    time_ = legs_.proven(stops_);
    if (is_best()) best_ = FoundTour{viewed_from(stops_), time_, covered};
  }

  /// Returns the fastest tour with one stop less that still has the required coverage.
  std::optional<Stops> least_without_one() {
    std::optional<Stops> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < stops_.size(); ++i) {
      Stops without = stops_;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
      covered_.remove(stops_[i]->doses);
      ways_.change(covered_, stops_, without);
      const bool is_enough = covered_.covered() >= wanted_;
      ways_.change(covered_, without, stops_);
      covered_.add(stops_[i]->doses);
      if (!is_enough) continue;
      const double time = legs_.proven(without);
      if (time < least) best = std::move(without), least = time;
    }
    return best;
  }

  const TourProblem& problem_;
  double wanted_;
  geometry::RandomNumbers random_;
  TourMoves moves_;
  LegTimes legs_;
  WayDoses ways_;
  DoseSum covered_;
  Stops stops_;
  double time_ = 0.0;
  double price_ = 0.0;  ///< Cost of missing the whole surface [s].
  std::optional<FoundTour> best_;
};

}  // namespace

FoundTour spare_views(const TourProblem& problem, const std::vector<View>& tour, double wanted) {
  Search search(problem, tour, wanted, 0);
  search.spare();
  return search.found();
}

FoundTour anneal(const TourProblem& problem, const std::vector<View>& tour, double wanted,
                 const SearchSettings& settings, const std::stop_token& stop) {
  Search search(problem, tour, wanted, settings.seed);
  search.anneal(settings, stop);
  return search.found();
}

double covered_by(const TourProblem& problem, const std::vector<View>& views) {
  DoseSum covered(problem.targets);
  for (const View& view : views) covered.add(doses_of(problem.looks(view)));
  if (!problem.way_looks) return covered.covered();
  for (std::size_t i = 0; i <= views.size() && !views.empty(); ++i) {
    const auto* from = i == 0 ? nullptr : &views[i - 1];
    const auto* to = i == views.size() ? nullptr : &views[i];
    covered.add(doses_of(problem.way_looks(from, to)));
  }
  return covered.covered();
}

}  // namespace skycap::missions::package

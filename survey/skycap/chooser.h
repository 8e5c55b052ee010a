/// Which view to fly to next: candidates about the worthiest targets, a batch of views that
/// complement each other, a short tour through them, of which the first stop is flown.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/pose.h"
#include "survey/skycap/view_gain.h"
#include "survey/view_limits.h"

namespace skycap::survey::skycap {

struct ChooserSettings {
  double view_distance = 2.0;  ///< d
  double view_price = 4.0;     ///< what a view costs besides the way to it, in metres of way
  int clusters = 40;           ///< groups of targets that candidates are made for
  int global_directions = 40;  ///< candidates spread evenly around all that is missing
  int refinements = 3;         ///< rounds of moving the best candidates
  int batch = 5;               ///< views planned ahead, at most 6; 1: the best next view only
  double unseen_yield = 1.0;   ///< what comes of guessed gains (GuessYield)
  unsigned threads = 1;        ///< zero: all processors
  std::stop_token stop{};      ///< has choose_view() throw Interrupted
  /// Between frames that are taken on the way to a view, in metres of way; zero: none are.
  double frame_spacing = 0.0;
  bool counts_ways = false, sees_lines = false;  ///< as SkycapConfig says
};

/// Views on the straight way from one view to another as a camera has them that turns evenly
/// meanwhile, in yaw and in pitch: `count` of them, none at the ends.
std::vector<geometry::View> views_between(const geometry::View& from, const geometry::View& to,
                                          std::size_t count);

struct Choice {
  geometry::View view;
  double gain;                  ///< expected newly covered area of this view [m^2]
  std::vector<Sight> with_way;  ///< what it and the straight way there have in sight
  /// That of the most rewarding view anywhere in reach, guesses counted by `unseen_yield`: for stop
  /// rules. With `counts_ways` it is that of a view and the way there.
  double best_gain;
  /// For each target of the field, the probability that the one of the best views of different
  /// places that sees it best sees it, if it is there. What none of them sees is hidden.
  std::vector<float> chances;
};

/// What a field said of views, by their positions and directions. After a refusal the next view is
/// chosen from nearly the same candidates: only the others are asked about. Of one field, one
/// present view and the same settings but for `unseen_yield`.
struct ChoiceMemory {
  using Key = std::array<double, 6>;
  std::map<Key, Gain> gains;
  std::map<Key, std::vector<Sight>> pool;  ///< the last one's views, with the ways to them
};

/// Whether the sensor can be there; must be safe to call from several threads.
using Admission = std::function<bool(const geometry::View&)>;

/// What a view and the frames on the straight way to it have in sight together, ascending: a share
/// is of what any of them covers. A few frames stand for all; without any it is the view's own.
std::vector<Sight> sights_with_way(const GainField& field, const geometry::View& from,
                                   const geometry::View& to, double frame_spacing);

/// The same of a sensor that sees lines only, which stand upright across what it looks along to the
/// left of its nose: a view shows nothing, and the way there what the lines sweep at the view
/// distance, by moving across themselves and by turning.
std::vector<Sight> sights_of_lines(const GainField& field, const geometry::View& from,
                                   const geometry::View& to, double frame_spacing,
                                   double view_distance);

/// The next view from `present`; nothing if no admissible view has any gain. Views farther away
/// than `most_way` are left out. With frames on the way the best views by themselves are batched by
/// what they and the straight ways to them would cover together. The same inputs give the same
/// choice for any number of threads, whatever is remembered.
std::optional<Choice> choose_view(const GainField& field, const ViewLimits& limits,
                                  const Admission& admits, const geometry::View& present,
                                  double most_way, const ChooserSettings& settings,
                                  ChoiceMemory& memory);

}  // namespace skycap::survey::skycap

/// What guesses are worth: how much surface came of those that the last scans should have shown.
#pragma once

#include <algorithm>

namespace skycap::survey::skycap {

class GuessYield {
 public:
  /// A scan was promised `promised` square metres of guesses; it covered `beyond_known` more than
  /// known surface had promised, and `new_territory` where nothing was known nearby. The former may
  /// be relief, or noise, and counts for at most what was promised.
  void learn(double promised, double beyond_known, double new_territory) {
    if (promised <= 0.0) return;
    const double found = std::max({0.0, std::min(beyond_known, promised),
                                   std::min(new_territory, most_at_once * promised)});
    promised_ = memory * promised_ + promised;
    found_ = memory * found_ + found;
    value_ = std::clamp(found_ / promised_, least, most);
  }

  /// Area found for each square metre that was promised; 1 as long as nothing is known. More than 1
  /// where guesses were the beginning of something larger.
  double value() const { return value_; }

 private:
  /// The share of the evidence that a scan keeps of those before it.
  static constexpr double memory = 0.6;
  /// A scan or two without any find must not end a survey, nor one great find keep it going.
  static constexpr double least = 0.15, most = 6.0, most_at_once = 10.0;

  double promised_ = 0.0, found_ = 0.0;  ///< fading sums over the scans [m^2]
  double value_ = 1.0;
};

}  // namespace skycap::survey::skycap

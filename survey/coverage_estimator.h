/// What some planners can say besides their views: how much of the surface they take to be covered.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

namespace skycap::survey::skycap {
class GainField;
struct SurveyBelief;
}  // namespace skycap::survey::skycap

namespace skycap::survey {

class CoverageEstimator {
 public:
  virtual ~CoverageEstimator() = default;

  /// Expected covered share of the surface, seen and guessed.
  virtual double predicted_coverage() const = 0;

  /// All that the planner estimates of the surface.
  virtual skycap::SurveyBelief belief() const = 0;

  /// The rule by which the planner ended the survey, as files name it: "target_coverage",
  /// "min_gain" and so on; "running" if it did not.
  virtual std::string_view stop_rule() const = 0;

  /// What views would cover of all that was measured, from an empty cloud, by so many targets at
  /// most; null before the first scan.
  virtual std::shared_ptr<const skycap::GainField> known_surface(
      std::size_t most_targets) const = 0;

 protected:
  CoverageEstimator() = default;
  CoverageEstimator(const CoverageEstimator&) = default;
  CoverageEstimator& operator=(const CoverageEstimator&) = default;
};

}  // namespace skycap::survey

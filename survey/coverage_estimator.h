/// Optional interface of planners that estimate the covered fraction of the surface.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

namespace skycap::survey::surfel {
class GainField;
struct SurveyEstimate;
}  // namespace skycap::survey::surfel

namespace skycap::survey {

class CoverageEstimator {
 public:
  virtual ~CoverageEstimator() = default;

  /// Returns the expected covered fraction of the measured and predicted surface.
  virtual double predicted_coverage() const = 0;

  /// Returns the complete estimate of the surface.
  virtual surfel::SurveyEstimate estimate() const = 0;

  /// Returns the name of the stopping rule that ended the survey, as used in files, such as
  /// "target_coverage" or "min_gain". Returns "running" if no stopping rule has ended it.
  virtual std::string_view stop_rule() const = 0;

  /// Returns a gain field that predicts how views would cover the measured surface from an empty
  /// cloud. It has at most `max_targets` targets. Returns null before the first scan.
  virtual std::shared_ptr<const surfel::GainField> known_surface(std::size_t max_targets) const = 0;

 protected:
  CoverageEstimator() = default;
  CoverageEstimator(const CoverageEstimator&) = default;
  CoverageEstimator& operator=(const CoverageEstimator&) = default;
};

}  // namespace skycap::survey

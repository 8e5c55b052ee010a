#include "missions/session/survey_record.h"

#include "geometry/error.h"

namespace skycap::missions::session {
namespace {

template <class Field>
double sum_over(const std::vector<EvaluatedView>& views, Field field) {
  double sum = 0.0;
  for (const EvaluatedView& view : views) sum += view.surveyed.*field;
  return sum;
}

}  // namespace

std::size_t SurveyRecord::en_route_frames() const {
  std::size_t count = 0;
  for (const EvaluatedView& evaluated : views) count += evaluated.surveyed.en_route.views.size();
  return count;
}

double SurveyRecord::planning_time() const {
  return sum_over(views, &survey::SurveyedView::planning_time);
}

double SurveyRecord::sensing_time() const {
  return sum_over(views, &survey::SurveyedView::sensing_time);
}

survey::StopReason stop_reason_named(const std::string& name) {
  if (const auto reason = survey::stop_reason_named(name)) return *reason;
  throw Error(ErrorKind::bad_file, "'" + name + "' is not a stop reason");
}

}  // namespace skycap::missions::session

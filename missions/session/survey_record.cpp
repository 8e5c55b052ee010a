#include "missions/session/survey_record.h"

#include "geometry/error.h"

namespace skycap::missions::session {
namespace {

template <class Field>
double sum_over(const std::vector<JudgedView>& views, Field field) {
  double sum = 0.0;
  for (const JudgedView& view : views) sum += view.surveyed.*field;
  return sum;
}

}  // namespace

std::size_t SurveyRecord::frames_on_way() const {
  std::size_t count = 0;
  for (const JudgedView& judged : views) count += judged.surveyed.on_way.views.size();
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

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
  using enum survey::StopReason;
  for (const auto reason :
       {complete, view_limit, distance_limit, time_limit, nowhere_to_go, interrupted}) {
    if (name == name_of(reason)) return reason;
  }
  throw Error(ErrorKind::bad_file, "'" + name + "' is no reason for a survey to stop");
}

const char* name_of(survey::skycap::SkycapStop stop) {
  switch (stop) {
    case survey::skycap::SkycapStop::wanted_coverage:
      return "wanted_coverage";
    case survey::skycap::SkycapStop::little_gain:
      return "little_gain";
    case survey::skycap::SkycapStop::most_length:
      return "most_length";
    case survey::skycap::SkycapStop::most_time:
      return "most_time";
    case survey::skycap::SkycapStop::nothing_in_reach:
      return "nothing_in_reach";
    case survey::skycap::SkycapStop::running:
      break;
  }
  return "running";
}

}  // namespace skycap::missions::session

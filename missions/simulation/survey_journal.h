/// What a simulated survey writes down while it runs, so that one that was interrupted, by Ctrl-C,
/// a kill or a power cut, is continued with the same result as if nothing had happened.
///
/// The first record says which survey it is: version, seed, surface, all keys. Then comes one for
/// each view: where it was taken, what it measured and added, and the way to the next one. Scans
/// are not written: the simulated sensor measures the same again, and the planner, told the same,
/// plans the same, which is checked view by view. Ways are not looked for again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/io/record_log.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/reach_record.h"
#include "missions/session/survey_flight.h"
#include "missions/support/identity.h"
#include "survey/survey_loop.h"

namespace skycap::missions::simulation {

/// The journal's name in the folder of the results; it goes when the survey has ended.
inline constexpr const char* journal_name = "survey.journal";

class SurveyJournal {
 public:
  /// Of a survey that begins: the file is made, in place of what was there, after the first view.
  /// Of one that continues (`resumes`): reads the file, if there is one. Throws Error{bad_file}
  /// naming the file if it is of another survey, saying what is different, or not sound.
  SurveyJournal(std::filesystem::path file, const support::Identity& run,
                const evaluation::SurveyScene& scene, bool resumes);

  /// Views that the file already had.
  std::size_t views() const { return known_.size(); }

  /// Has a survey do again what the file says, and write down what it does after that. `flight`
  /// may be null; both must outlive the survey. What the ports then throw: Error{bad_file} if the
  /// survey goes another way than the file, or the file cannot be written.
  void attach(survey::SurveyPorts& ports, session::SurveyFlight* flight);

 private:
  /// A view that was taken and what came of it.
  struct ViewRecord {
    geometry::View view;
    std::size_t returns = 0;     ///< of the scan
    std::size_t points = 0;      ///< kept so far
    session::ReachRecord reach;  ///< of the views proposed after it
  };

  static std::string text_of(const ViewRecord& record);
  ViewRecord parse(const std::string& text) const;
  void read_known(const std::vector<std::string>& records);
  bool is_known() const { return at_ < known_.size(); }
  void begin_view(const geometry::View& view);
  void end_view(const survey::SurveyedView& view);
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path file_;
  std::string identity_;  ///< the first record
  std::optional<geometry::RecordLog> log_;
  std::vector<ViewRecord> known_;
  std::size_t at_ = 0;  ///< number of the view that the survey is at
  ViewRecord current_;
  session::ReachMemory reach_;
};

}  // namespace skycap::missions::simulation

/// Journal of a simulated survey. A survey interrupted by Ctrl-C, a kill or a power failure can be
/// resumed with an identical result.
///
/// The first record identifies the survey: version, seed, surface, all keys. Each further record
/// describes a view: its pose, the numbers of measured and added points, and the path to the next
/// view. Scans are not stored: the simulated sensor reproduces them, and the planner reproduces its
/// plans, which is checked for each view. Paths are not planned again.
///
/// A second file contains a preview of the measured points for programs that show the survey while
/// it is planned. Its first record contains the number `stride`, and each further record the points
/// of a view: every `stride`-th point of the planner's cloud, in millimetres. The stride is
/// doubled, and the file is rewritten, before the preview exceeds `max_preview_points`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/io/record_log.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/reach_record.h"
#include "missions/session/survey_flight.h"
#include "missions/support/identity.h"
#include "survey/survey_loop.h"

namespace skycap::missions::simulation {

/// File name in the results folder. The file is removed at the end of the survey.
inline constexpr const char* journal_name = "survey.journal";
/// File name of the preview. The file is removed together with the journal.
inline constexpr const char* preview_name = "survey.points";
inline constexpr std::size_t max_preview_points = 100'000;

class SurveyJournal {
 public:
  /// For a new survey, the file is created after the first view and replaces an existing one. With
  /// `resumes`, an existing file is read. Throws Error{bad_file} naming the file if it is damaged
  /// or belongs to another survey; the message lists the differences.
  SurveyJournal(std::filesystem::path file, const support::Identity& run,
                const evaluation::SurveyScene& scene, bool resumes);

  /// Returns the number of views already in the file.
  std::size_t views() const { return known_.size(); }

  /// Modifies the ports so that the survey replays the recorded views and records all later ones.
  /// `flight` may be null. All arguments must outlive the survey. The ports then throw
  /// Error{bad_file} if the survey deviates from the file or the file cannot be written.
  void attach(survey::SurveyCallbacks& callbacks, session::SurveyFlight* flight,
              const survey::Planner& planner);

 private:
  /// View and its results.
  struct ViewRecord {
    geometry::View view;
    std::size_t returns = 0;     ///< Number of returns of the scan.
    std::size_t points = 0;      ///< Number of points in the cloud after the view.
    session::ReachRecord reach;  ///< Reachability of the views proposed after it.
  };

  static std::string to_journal_line(const ViewRecord& record);
  ViewRecord parse(const std::string& text) const;
  void read_known(const std::vector<std::string>& records);
  bool is_known() const { return at_ < known_.size(); }
  void begin_view(const geometry::View& view);
  void end_view(const survey::SurveyedView& view);
  void write_preview(std::span<const Eigen::Vector3f> cloud);
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path file_;
  std::string identity_;  ///< First record of the journal.
  std::optional<geometry::RecordLog> log_;
  std::optional<geometry::RecordLog> preview_;
  std::size_t preview_stride_ = 1;
  std::size_t previewed_ = 0;  ///< Number of points of the cloud that the preview represents.
  std::vector<ViewRecord> known_;
  std::size_t at_ = 0;  ///< Index of the current view.
  ViewRecord current_;
  session::ReachabilityCache reach_;
};

}  // namespace skycap::missions::simulation

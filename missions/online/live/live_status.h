/// Status of a running live survey for programs that show it, and their hold requests. Both are
/// files in the survey's folder (docs/reference/live-protocol.md).
#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "flight/flight_options.h"
#include "geometry/pose/pose.h"
#include "missions/online/live/live_survey.h"

namespace skycap::missions::online {

/// Journal of a live survey (live_survey.h).
inline constexpr const char* live_journal_name = "live.journal";
/// Written every second while the survey runs.
inline constexpr const char* status_name = "live.json";
/// While this file exists, the survey is held: no further leg is released.
inline constexpr const char* hold_name = "live.hold";

/// Writes the status and watches for hold requests in a background thread, because a slow disk must
/// not delay a flight. Errors of the disk do not end a survey; a hold then remains as it was.
class LiveStatus {
 public:
  /// `flight` contains the survey's flight options and must outlive this object.
  LiveStatus(std::filesystem::path folder, const flight::FlightOptions& flight);
  LiveStatus(const LiveStatus&) = delete;
  LiveStatus& operator=(const LiveStatus&) = delete;
  ~LiveStatus();  ///< Removes the status file.

  bool is_held() const { return is_held_; }

  /// Sets the state of the survey. Must not be called while another thread changes it.
  void set_survey(const LiveSurvey& survey);
  /// Sets the estimated position of the vehicle, the direction of the camera, and the battery level
  /// (fraction of a full charge) if it is known.
  void set_vehicle(const geometry::View& view, std::optional<double> battery);
  void set_action(const std::string& text);  ///< Current action as text for the user.

 private:
  void watch(const std::stop_token& stop);
  std::string status_text() const;

  std::filesystem::path folder_;
  const flight::FlightOptions& flight_;
  std::atomic<bool> is_held_ = false;
  mutable std::mutex mutex_;  ///< Guards the values below.
  std::string survey_;        ///< answer_json().
  std::string action_;
  std::optional<geometry::View> vehicle_;
  std::optional<double> battery_;
  std::jthread thread_;
};

}  // namespace skycap::missions::online

/// Handler of the messages of a live survey's clients (docs/reference/live-protocol.md).
#pragma once

#include <functional>
#include <string>

#include "flight/flight_options.h"
#include "missions/online/live/live_options.h"
#include "missions/online/live/live_survey.h"
#include "missions/online/live/wire.h"

namespace skycap::missions::online {

class Session {
 public:
  /// Keeps references to the survey and its options. `mission` is the mission's name. `finish`
  /// writes the package and returns its summary. Unless `finish` throws, the survey is then closed.
  /// settle() calls `show`. While `is_held` returns true, no view is released.
  Session(
      std::string mission, const flight::FlightOptions& flight, const LiveOptions& live,
      LiveSurvey& survey, std::function<std::string()> finish, std::function<void()> show = [] {},
      std::function<bool()> is_held = [] { return false; });

  /// Returns one answer per message. Errors are answered with {"type": "error", "what": ...} and
  /// leave the survey unchanged.
  Message answer(const Message& message);

  /// Calls `show` if the last message has changed the survey. Must be called after its answer was
  /// sent.
  void settle();

  /// Returns whether an answer must not be sent yet, because it contains a view and the survey is
  /// held.
  bool is_held_back(const Message& answer) const;

  bool is_finished() const { return is_finished_; }

 private:
  Message answer_unguarded(const Message& message);
  bool is_added(const ScanNumber& number) const;
  std::string next_text() const;
  void require_in_order(const ScanNumber& number) const;
  Message add_scan(const Message& message);
  Message reject(const Message& message);
  Message present() const;

  std::string mission_;
  const flight::FlightOptions& flight_;
  const LiveOptions& live_;
  LiveSurvey& survey_;
  std::function<std::string()> finish_;
  std::function<void()> show_;
  std::function<bool()> is_held_;
  bool has_changed_ = false;
  bool is_finished_ = false;
};

}  // namespace skycap::missions::online

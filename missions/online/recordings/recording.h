/// What somebody recorded, whatever it was recorded in: scans with poses, one after another.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "flight/flight_options.h"
#include "missions/online/live/live_options.h"
#include "missions/online/live/scan_input.h"
#include "missions/online/recordings/rawlog_sequence.h"

namespace skycap::missions::online {

struct RecordingChoice {
  RawlogChoice rawlog;            ///< for rawlogs alone
  std::size_t count = 1'000'000;  ///< so many of its frames
  /// How images of folders are read; rawlogs say that themselves. `file` and pose are not used.
  ScanInput image;
};

struct Frame {
  std::string id;                   ///< what the recording calls it
  std::string name;                 ///< for the user
  std::function<ScanFound()> scan;  ///< reads it; throws Error{bad_file}
};

class Recording {
 public:
  virtual ~Recording() = default;

  /// What poses are taken from, for the user, where a recording may have several.
  virtual std::string pose_source() const = 0;

  /// The next frame that can be used; nothing at the end. Throws Error{bad_file}.
  virtual std::optional<Frame> next() = 0;
};

/// A rawlog, if it is a file, or else a folder as in recorded_sequence.h, whose scans become the
/// survey's. `note` is told, in a line, of each frame that is left out, and why; `report`, how far
/// it is in what it has to read first. Throws Error{bad_file},
/// and Error{bad_usage} for a choice that it does not have.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& place,
                                          const RecordingChoice& choice,
                                          const flight::CaptureOptions& capture,
                                          const LiveOptions& live,
                                          const std::function<void(const std::string&)>& note,
                                          const std::function<void(const std::string&)>& report);

}  // namespace skycap::missions::online

/// Common interface of recordings in all formats: a sequence of scans with poses.
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
  RawlogChoice rawlog;            ///< Sensor and poses to read; used only for rawlogs.
  std::size_t count = 1'000'000;  ///< Maximum number of frames.
  /// Format of the images in folders; rawlogs contain this information. The file and the pose are
  /// ignored.
  ScanInput image;
};

struct Frame {
  std::string id;                   ///< Identifier of the frame in the recording.
  std::string name;                 ///< Name of the frame for the user.
  std::function<ScanFound()> scan;  ///< Reads the scan. Throws Error{bad_file}.
};

class Recording {
 public:
  virtual ~Recording() = default;

  /// Returns the description of the pose source for the user, or an empty string if the format has
  /// only one.
  virtual std::string pose_source() const = 0;

  /// Returns the next usable frame, or an empty value at the end. Throws Error{bad_file}.
  virtual std::optional<Frame> next() = 0;
};

/// Opens a rawlog (file) or a sequence in a folder (recorded_sequence.h) and converts its scans for
/// a survey. `note` receives one line for each skipped frame with the reason. `report` receives the
/// progress of the initial reading. Throws Error{bad_file}, and Error{bad_usage} for a choice that
/// the recording does not have.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& source,
                                          const RecordingChoice& choice,
                                          const flight::CaptureOptions& capture,
                                          const LiveOptions& live,
                                          const std::function<void(const std::string&)>& note,
                                          const std::function<void(const std::string&)>& report);

}  // namespace skycap::missions::online

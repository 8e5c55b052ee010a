#include "missions/online/recordings/recording.h"

#include <utility>

#include "geometry/error.h"
#include "missions/online/recordings/recorded_sequence.h"

namespace skycap::missions::online {
namespace {

class Folder final : public Recording {
 public:
  Folder(RecordedSequence sequence, ScanInput image, const flight::CaptureOptions& capture,
         const LiveOptions& live)
      : frames_(std::move(sequence.frames)),
        image_(std::move(image)),
        capture_(capture),
        live_(live) {}

  std::string pose_source() const override { return ""; }

  std::optional<Frame> next() override {
    if (next_ == frames_.size()) return std::nullopt;
    const RecordedFrame& frame = frames_[next_++];
    return Frame{frame.id, frame.file.string(), [this, &frame] {
                   ScanInput input = image_;
                   input.file = frame.file;
                   input.world_from_sensor = frame.world_from_sensor;
                   return read_scan(input, capture_, live_);
                 }};
  }

 private:
  std::vector<RecordedFrame> frames_;
  std::size_t next_ = 0;
  ScanInput image_;
  flight::CaptureOptions capture_;
  LiveOptions live_;
};

class Rawlog final : public Recording {
 public:
  Rawlog(RawlogSequence sequence, std::size_t count, const flight::CaptureOptions& capture,
         const LiveOptions& live)
      : sequence_(std::move(sequence)), left_(count), capture_(capture), live_(live) {}

  std::string pose_source() const override { return sequence_.pose_source(); }

  std::optional<Frame> next() override {
    if (left_ == 0) return std::nullopt;
    --left_;
    std::optional<RawlogFrame> frame = sequence_.next();
    if (!frame) return std::nullopt;
    const std::string id = frame->id;
    return Frame{id, id, [this, frame = std::make_shared<const RawlogFrame>(*std::move(frame))] {
                   return make_scan(*frame, capture_, live_);
                 }};
  }

 private:
  RawlogSequence sequence_;
  std::size_t left_;
  flight::CaptureOptions capture_;
  LiveOptions live_;
};

}  // namespace

std::unique_ptr<Recording> open_recording(const std::filesystem::path& source,
                                          const RecordingChoice& choice,
                                          const flight::CaptureOptions& capture,
                                          const LiveOptions& live,
                                          const std::function<void(const std::string&)>& note,
                                          const std::function<void(const std::string&)>& report) {
  if (std::filesystem::is_regular_file(source)) {
    return std::make_unique<Rawlog>(RawlogSequence(source, choice.rawlog, note, report),
                                    choice.count, capture, live);
  }
  if (choice.rawlog.poses || !choice.rawlog.sensor.empty()) {
    throw Error(ErrorKind::bad_usage, "--poses and --sensor require a rawlog");
  }
  RecordedSequence sequence = read_sequence(source, choice.count);
  for (const std::string& remark : sequence.remarks) note(remark);
  for (const std::string& left_out : sequence.notes) note(left_out);
  return std::make_unique<Folder>(std::move(sequence), choice.image, capture, live);
}

}  // namespace skycap::missions::online

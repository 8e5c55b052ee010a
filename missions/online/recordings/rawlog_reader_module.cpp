// Reader of rawlogs based on MRPT. rawlog_reader.cpp loads this module.
#include <cmath>
#include <deque>
#include <utility>

#include <mrpt/io/lazy_load_path.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include "geometry/error.h"
#include "missions/online/recordings/rawlog_reader.h"
#include "missions/online/recordings/rawlog_scans.h"
#include "missions/online/recordings/rawlog_stream.h"

namespace skycap::missions::online {
namespace {

using Eigen::Isometry3d;
using Entry = std::variant<RawlogScan, RawlogPose>;

/// Adapter of RawlogBytes to MRPT's archive interface.
class Archive final : public mrpt::serialization::CArchive {
 public:
  explicit Archive(const std::filesystem::path& file) : bytes_(file) {}

  std::string getArchiveDescription() const override { return "the rawlog"; }
  std::string damage() const { return bytes_.damage(); }

 protected:
  std::size_t read(void* buffer, std::size_t count) override { return bytes_.read(buffer, count); }
  std::size_t write(const void*, std::size_t) override { return 0; }

 private:
  RawlogBytes bytes_;
};

/// Extracts the message from an MRPT exception, whose text has lines before and after it.
std::string exception_message(const std::exception& failure) {
  std::string text = failure.what();
  constexpr std::string_view begin = "Message:";
  if (const auto at = text.find(begin); at != std::string::npos) text.erase(0, at + begin.size());
  text.erase(0, text.find_first_not_of(" \n"));
  return text.substr(0, std::min<std::size_t>(text.find('\n'), 200));
}

/// Returns the folder of the rawlog's external files. MRPT's detectImagesDirectory() does not find
/// folders.
std::string find_image_folder(const std::filesystem::path& file) {
  std::string name = file.filename().string();
  name.erase(std::min(name.find(".rawlog"), name.size()));
  for (const char* extension : {"_Images", "_images", "_IMAGES"}) {
    const std::filesystem::path folder = file.parent_path() / (name + extension);
    if (std::filesystem::is_directory(folder)) return folder.string();
  }
  return (file.parent_path() / "Images").string();
}

class Reader final : public RawlogReader {
 public:
  explicit Reader(std::filesystem::path file)
      : file_(std::move(file)), images_(find_image_folder(file_)), archive_(file_) {}

  std::optional<Entry> next() override {
    while (found_.empty()) {
      const mrpt::serialization::CSerializable::Ptr object = read_object();
      if (is_at_end_) return std::nullopt;
      try {
        add_object(*object);
      } catch (const std::exception& failure) {
        fail(exception_message(failure));
      }
    }
    Entry entry = std::move(found_.front());
    found_.pop_front();
    return entry;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::bad_file, file_.string() + ": entry " + std::to_string(entries_) +
                                         " cannot be read: " + what);
  }

  /// Returns the next object of the file. At the end, returns an empty object and sets
  /// `is_at_end_`.
  mrpt::serialization::CSerializable::Ptr read_object() {
    try {
      auto object = archive_.ReadObject();
      ++entries_;
      if (object) return object;
    } catch (const mrpt::serialization::CExceptionEOF&) {
      if (const std::string damage = archive_.damage(); !damage.empty()) fail(damage);
      if (entries_ == 0) fail("the file is empty");
      is_at_end_ = true;
      return nullptr;
    } catch (const std::bad_alloc&) {
      fail("it requires more than 2 GiB of memory");
    } catch (const std::exception& failure) {
      const std::string damage = archive_.damage();
      fail(damage.empty() ? exception_message(failure) : damage);
    }
    fail("it contains no object");
  }

  void add_object(const mrpt::serialization::CSerializable& object) {
    if (const auto* frame = dynamic_cast<const mrpt::obs::CSensoryFrame*>(&object)) {
      for (const auto& observation : *frame) read_observation(*observation);
    } else if (const auto* actions = dynamic_cast<const mrpt::obs::CActionCollection*>(&object)) {
      read_actions(*actions);
    } else if (const auto* one = dynamic_cast<const mrpt::obs::CObservation*>(&object)) {
      read_observation(*one);
    } else if (const auto* all = dynamic_cast<const mrpt::obs::CRawlog*>(&object)) {
      for (std::size_t i = 0; i < all->size(); ++i) add_object(*all->getAsGeneric(i));
    }
  }

  void read_actions(const mrpt::obs::CActionCollection& actions) {
    if (!moved_) moved_ = Isometry3d::Identity();
    if (const auto in_space = actions.getActionByClass<mrpt::obs::CActionRobotMovement3D>()) {
      *moved_ = *moved_ * to_isometry(in_space->poseChange.getMeanVal());
    } else if (const auto in_plane = actions.getBestMovementEstimation()) {
      *moved_ = *moved_ * to_isometry(mrpt::poses::CPose3D(in_plane->poseChange->getMeanVal()));
    }
  }

  void read_observation(const mrpt::obs::CObservation& observation) {
    const double time = mrpt::Clock::toDouble(observation.timestamp);
    if (const auto* estimate =
            dynamic_cast<const mrpt::obs::CObservationRobotPose*>(&observation)) {
      const Isometry3d platform_from_estimated = to_isometry(estimate->sensorPose);
      found_.emplace_back(
          RawlogPose{PoseSource::estimate, time,
                     to_isometry(estimate->pose.getMeanVal()) * platform_from_estimated.inverse()});
    } else if (const auto* wheels =
                   dynamic_cast<const mrpt::obs::CObservationOdometry*>(&observation)) {
      found_.emplace_back(RawlogPose{PoseSource::odometry, time,
                                     to_isometry(mrpt::poses::CPose3D(wheels->odometry))});
    } else {
      mrpt::io::setLazyLoadPathBase(images_);
      if (auto scan = make_scan(observation)) {
        scan->number = observations_;
        scan->label = observation.sensorLabel;
        scan->time = time;
        scan->moved = moved_;
        found_.emplace_back(std::move(*scan));
      }
    }
    ++observations_;
  }

  std::filesystem::path file_;
  std::string images_;  ///< Folder of the rawlog's external files.
  Archive archive_;
  std::deque<Entry> found_;
  std::optional<Isometry3d> moved_;
  std::size_t entries_ = 0, observations_ = 0;
  bool is_at_end_ = false;
};

}  // namespace
}  // namespace skycap::missions::online

extern "C" [[gnu::visibility("default")]] skycap::missions::online::RawlogReader*
skycap_make_rawlog_reader(const std::filesystem::path& file) {
  return new skycap::missions::online::Reader(file);
}

// Encoder of depth images for rawlogs, based on MRPT's serialisation.
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/serialization/CArchive.h>

#include "missions/scan/rawlog_module.h"

namespace skycap::missions::scan {
namespace {

mrpt::obs::CObservationRobotPose make_pose(const DepthFrame& frame) {
  mrpt::obs::CObservationRobotPose observation;
  observation.timestamp = mrpt::Clock::fromDouble(frame.time);
  observation.sensorLabel = "CARRIER";
  observation.pose.mean =
      mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(frame.world_from_sensor.matrix()));
  return observation;
}

mrpt::obs::CObservation3DRangeScan make_image(const DepthFrame& frame) {
  mrpt::obs::CObservation3DRangeScan scan;
  scan.timestamp = mrpt::Clock::fromDouble(frame.time);
  scan.sensorLabel = "DEPTH";
  scan.maxRange = static_cast<float>(frame.max_range);
  scan.range_is_depth = true;
  scan.rangeUnits = static_cast<float>(frame.unit);
  scan.hasRangeImage = true;
  scan.rangeImage_setSize(frame.image.height, frame.image.width);
  const std::uint16_t* value = frame.image.values.data();
  for (int row = 0; row < frame.image.height; ++row) {
    for (int column = 0; column < frame.image.width; ++column) {
      scan.rangeImage(row, column) = *value++;
    }
  }
  scan.cameraParams.ncols = static_cast<std::uint32_t>(frame.image.width);
  scan.cameraParams.nrows = static_cast<std::uint32_t>(frame.image.height);
  scan.cameraParams.setIntrinsicParamsFromValues(
      frame.focal_length_px.x(), frame.focal_length_px.y(), frame.principal_point_px.x(),
      frame.principal_point_px.y());
  scan.cameraParamsIntensity = scan.cameraParams;
  return scan;
}

}  // namespace
}  // namespace skycap::missions::scan

extern "C" [[gnu::visibility("default")]] void skycap_encode_depth_frame(
    const skycap::missions::scan::DepthFrame& frame, std::vector<std::uint8_t>& bytes) {
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << skycap::missions::scan::make_pose(frame) << skycap::missions::scan::make_image(frame);
  const auto* data = static_cast<const std::uint8_t*>(stream.getRawBufferData());
  bytes.assign(data, data + stream.getTotalBytesCount());
}

// Flight of a laser scanner as a generator of structured arrays.
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "missions/api/laser_scan.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace skycap::python {
namespace {

using missions::api::LaserScan;
using missions::api::Mission;

/// Return as a numpy record. Fields are ordered by size, so that there is no padding.
struct Return {
  double xyz[3];
  double time;
  float intensity, scan_angle;
  std::uint32_t triangle;
  std::uint16_t channel;
  std::uint8_t return_number, number_of_returns;
};
static_assert(sizeof(Return) == 48);

py::dtype return_type() {
  py::list fields;
  fields.append(py::make_tuple("xyz", "<f8", py::make_tuple(3)));
  for (const auto& [name, type] :
       {std::pair("time", "<f8"), std::pair("intensity", "<f4"), std::pair("scan_angle", "<f4"),
        std::pair("triangle", "<u4"), std::pair("channel", "<u2"), std::pair("return_number", "u1"),
        std::pair("returns_of_shot", "u1")}) {
    fields.append(py::make_tuple(name, type));
  }
  return py::dtype::from_args(fields);
}

void append(const sim::LidarReturns& part, Return*& next) {
  for (std::size_t i = 0; i < part.size(); ++i, ++next) {
    Eigen::Map<Eigen::Vector3d>{next->xyz} = part.origin + part.points[i].cast<double>();
    next->time = part.times[i];
    next->intensity = part.intensities[i];
    next->scan_angle = part.scan_angles[i];
    next->triangle = part.triangles[i];
    next->channel = part.channels[i];
    next->return_number = part.return_numbers[i];
    next->number_of_returns = part.number_of_returns[i];
  }
}

/// Scan generator for use by one thread at a time.
class ScanChunks {
 public:
  ScanChunks(const Mission& mission, const missions::api::ScanRequest& request)
      : scan_(mission, request) {}

  py::array next() {
    std::unique_lock<std::mutex> lock(in_use_, std::defer_lock);
    std::span<const sim::LidarReturns> parts;
    std::size_t size = 0;
    {
      py::gil_scoped_release others_go_on;
      lock.lock();
      parts = scan_.next();
      for (const sim::LidarReturns& part : parts) size += part.size();
    }
    if (parts.empty()) throw py::stop_iteration();
    py::array chunk(return_type(), static_cast<py::ssize_t>(size));
    auto* output = static_cast<Return*>(chunk.mutable_data());
    py::gil_scoped_release others_go_on;
    for (const sim::LidarReturns& part : parts) append(part, output);
    return chunk;
  }

 private:
  LaserScan scan_;
  std::mutex in_use_;
};

std::unique_ptr<ScanChunks> scan(const Mission& mission, const std::optional<std::string>& sensor,
                                 const std::optional<std::filesystem::path>& route) {
  py::gil_scoped_release others_go_on;
  return std::make_unique<ScanChunks>(mission,
                                      missions::api::ScanRequest{.sensor = sensor, .route = route});
}

}  // namespace

void bind_scans(py::module_& module) {
  py::class_<ScanChunks>(module, "LaserScan", py::is_final(),
                         "An iterator over the pieces of a laser scanner's flight; see scan().")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &ScanChunks::next);
  module.def(
      "scan", &scan, py::arg("mission"), py::arg("sensor") = py::none(),
      py::arg("route") = py::none(),
      "scan(mission, sensor=None, route=None)\n"
      "--\n"
      "\n"
      "Simulates the flight of a laser scanner over the mission's scene, as `skycap scan`\n"
      "does. Returns an iterator of structured arrays of several hundred thousand returns, in\n"
      "the order of measurement. Memory use does not depend on the length of the flight.\n"
      "\n"
      "sensor: a name of sensors() or the path of a sensor file. route: a file accepted by\n"
      "`skycap scan --route`. None: from the mission.\n"
      "\n"
      "Fields: xyz (3 x float64, world frame, in metres); time (float64, of the pulse, in\n"
      "seconds); intensity (float32, from 0 to 1); scan_angle (float32, azimuth in the\n"
      "sensor's frame, in radians); triangle (uint32, of the scene); channel (uint16);\n"
      "return_number (uint8, from 1); returns_of_shot (uint8).");
}

}  // namespace skycap::python

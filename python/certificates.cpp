// Verification that straight legs keep their clearance.
#include <limits>
#include <optional>
#include <string>

#include <pybind11/stl.h>

#include "flight/clearance/obstacles.h"
#include "flight/route/route.h"
#include "geometry/pose/prism.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interruptible.h"

namespace skycap::python {
namespace {

using Certificate = flight::LegCertificate;
using geometry::Prism;

Prism prism_from(const std::string& name, const Array<double>& footprint, double floor,
                 double ceiling) {
  if (footprint.ndim() != 2 || footprint.shape(1) != 2) {
    throw py::value_error("footprint must have shape (N, 2)");
  }
  Prism prism{.name = name, .footprint = {}, .floor = floor, .ceiling = ceiling};
  for (py::ssize_t i = 0; i < footprint.shape(0); ++i) {
    prism.footprint.emplace_back(footprint.at(i, 0), footprint.at(i, 1));
  }
  return prism;
}

flight::Obstacles obstacles_from(const geometry::Mesh* mesh,
                                 const std::optional<Array<float>>& cloud, double cloud_radius,
                                 std::vector<Prism> no_fly, std::optional<Prism> fence,
                                 std::optional<double> ground_height) {
  flight::Obstacles obstacles;
  if (mesh != nullptr) obstacles.mesh = *mesh;
  if (cloud) {
    const auto points = points_in(*cloud, "cloud");
    obstacles.cloud = {.points = {points.begin(), points.end()}, .radius = cloud_radius};
  }
  obstacles.no_fly = std::move(no_fly);
  obstacles.fence = std::move(fence);
  obstacles.ground_height = ground_height;
  return obstacles;
}

std::vector<Certificate> verify_polyline(const Array<double>& route, double clearance,
                                         const geometry::Mesh* mesh,
                                         const std::optional<Array<float>>& cloud,
                                         double cloud_radius, std::vector<Prism> no_fly,
                                         std::optional<Prism> fence,
                                         std::optional<double> ground_height) {
  if (!(clearance >= 0.0)) throw py::value_error("clearance must be zero or more, in metres");
  const std::vector<Eigen::Vector3d> points = positions_in(route, "route");
  const flight::Obstacles obstacles =
      obstacles_from(mesh, cloud, cloud_radius, std::move(no_fly), std::move(fence), ground_height);
  std::vector<Certificate> certificates;
  run_interruptibly([&](const std::stop_token& stop) {
    certificates = flight::verify_route(points, flight::KnownSpace(obstacles), clearance,
                                        clearance + flight::reported_surplus, stop);
  });
  return certificates;
}

void bind_certificate(py::module_& module) {
  const auto find_point = [](const Certificate& certificate,
                             const Eigen::Vector3d& at) -> py::object {
    if (certificate.verification.closest.kind == flight::ObstacleKind::none) return py::none();
    return to_array(at);
  };
  py::class_<Certificate>(module, "LegCheck", py::is_final(),
                          "Result of the clearance check of a straight leg.")
      .def_property_readonly(
          "is_clear", [](const Certificate& c) { return c.verification.is_verified; },
          "True if every point of the leg keeps the clearance.")
      .def_property_readonly(
          "is_proven",
          [](const Certificate& c) {
            warn_deprecated_name("is_proven", "is_clear");
            return c.verification.is_verified;
          },
          "Former name of is_clear.")
      .def_property_readonly(
          "clearance", [](const Certificate& c) { return c.verification.clearance; },
          "Verified lower bound on the clearance along the leg, in metres, capped at 10 m above "
          "the\nrequired clearance.")
      .def_readonly("obstacle", &Certificate::obstacle,
                    "Name of the nearest obstacle; '' if nothing is in range.")
      .def_property_readonly(
          "on_leg",
          [find_point](const Certificate& c) {
            return find_point(c, c.verification.closest.on_leg);
          },
          "Point of the leg nearest to the obstacle: float64, shape (3,); None if nothing is in "
          "range.")
      .def_property_readonly(
          "on_obstacle",
          [find_point](const Certificate& c) {
            return find_point(c, c.verification.closest.on_obstacle);
          },
          "Nearest point of the obstacle: float64, shape (3,); None if nothing is in range.");
}

}  // namespace

void bind_certificates(py::module_& module) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  py::class_<Prism>(
      module, "Prism", py::is_final(),
      "An upright prism over a simple polygon: Prism(name, footprint, floor=-inf,\n"
      "ceiling=inf). The footprint has the shape (N, 2). All values are in metres, world frame.")
      .def(py::init(&prism_from), py::arg("name"), py::arg("footprint"),
           py::arg("floor") = -infinity, py::arg("ceiling") = infinity)
      .def_readonly("name", &Prism::name, "Name used in messages.")
      .def_readonly("floor", &Prism::floor, "Lower limit, in metres.")
      .def_readonly("ceiling", &Prism::ceiling, "Upper limit, in metres.");
  bind_certificate(module);
  module.def(
      "verify_route", &verify_polyline, py::arg("route"), py::arg("clearance"),
      py::arg("mesh") = static_cast<const geometry::Mesh*>(nullptr), py::arg("cloud") = py::none(),
      py::arg("cloud_radius") = 0.0, py::arg("no_fly") = std::vector<Prism>{},
      py::arg("fence") = py::none(), py::arg("ground_height") = py::none(),
      "verify_route(route, clearance, mesh=None, cloud=None, cloud_radius=0.0, no_fly=(), "
      "fence=None, "
      "ground_height=None)\n--\n\nVerifies for each straight leg of a route, (N, 3) float64 in "
      "metres, that it keeps\n`clearance` metres from all obstacles. Returns a list of N - 1 "
      "LegCheck, or one for a\nsingle point. Distances are exact minima over all points of a leg, "
      "not samples.\n\nmesh: a Mesh; the inside of a closed mesh is occupied. cloud: (N, 3) "
      "float32, each\npoint a ball of `cloud_radius`. no_fly: Prisms to stay out of. fence: a "
      "Prism to stay\ninside. ground_height: z below which space is occupied.");
}

}  // namespace skycap::python

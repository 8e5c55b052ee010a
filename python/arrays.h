/// Arrays of numpy on both sides of the border. What is right as it is, is looked at where it lies;
/// what comes out is read-only and keeps alive whatever holds it. numpy is imported by the first
/// array, not by `import skycap`.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace skycap::python {

namespace py = pybind11;

/// Arrays of this type are taken as they lie in memory if they are aligned; others are converted,
/// which copies.
template <typename Number>
using Array = py::array_t<Number, py::array::c_style | py::array::forcecast |
                                      py::detail::npy_api::NPY_ARRAY_ALIGNED_>;

/// Rows of three as points; `name` opens messages. Throws py::value_error for any other shape.
std::span<const Eigen::Vector3f> points_in(const Array<float>& array, const std::string& name);
std::vector<Eigen::Vector3d> places_in(const Array<double>& array, const std::string& name);
/// Throws py::value_error also for numbers that are not finite.
Eigen::Vector3d vector_in(const Array<double>& array, const std::string& name);

/// From an array or what numpy makes one of. Throws py::value_error unless the numbers are whole
/// and fit 32 bits.
Array<std::uint32_t> indices_in(const py::object& numbers, const std::string& name);

/// From a 4 x 4 matrix. Throws py::value_error unless it turns and shifts and does nothing else, to
/// 1e-6.
Eigen::Isometry3d pose_in(const Array<double>& matrix, const std::string& name);

py::array_t<double> array_of(const Eigen::Vector3d& vector);
py::array_t<double> array_of(const Eigen::Isometry3d& pose);

/// An array of so many rows and columns (none: one axis) over memory that `keeper` keeps alive.
template <typename Number>
py::array_t<Number> view_of(const Number* numbers, py::ssize_t rows, py::ssize_t columns,
                            const py::object& keeper) {
  std::vector<py::ssize_t> shape{rows};
  if (columns > 0) shape.push_back(columns);
  py::array_t<Number> array(std::move(shape), numbers, keeper);
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::array_t<float> view_of(const std::vector<Eigen::Vector3f>& points, const py::object& keeper);
py::array_t<double> view_of(const std::vector<Eigen::Vector3d>& points, const py::object& keeper);

/// Puts a value where Python counts the references to it.
template <typename Value>
std::pair<const Value*, py::capsule> kept(Value&& value) {
  using Kept = std::remove_cvref_t<Value>;
  auto owned = std::make_unique<Kept>(std::forward<Value>(value));
  const Kept* const place = owned.get();
  py::capsule keeper(owned.get(), [](void* kept) { delete static_cast<Kept*>(kept); });
  static_cast<void>(owned.release());
  return {place, std::move(keeper)};
}

}  // namespace skycap::python

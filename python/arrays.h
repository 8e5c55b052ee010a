/// Conversion between numpy arrays and C++ types. Input arrays of the right type are used without a
/// copy. Output arrays are read-only and keep their owner alive. numpy is imported with the first
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

/// Contiguous, aligned arrays of this type are used in place. Other arrays are converted, which
/// makes a copy.
template <typename Number>
using Array = py::array_t<Number, py::array::c_style | py::array::forcecast |
                                      py::detail::npy_api::NPY_ARRAY_ALIGNED_>;

/// Converts rows of three numbers to points. Messages begin with `name`. Throws py::value_error for
/// any other shape.
std::span<const Eigen::Vector3f> points_in(const Array<float>& array, const std::string& name);
std::vector<Eigen::Vector3d> positions_in(const Array<double>& array, const std::string& name);
/// Also throws py::value_error for non-finite numbers.
Eigen::Vector3d vector_in(const Array<double>& array, const std::string& name);

/// Converts an array, or an object that numpy can convert to one. Throws py::value_error unless all
/// numbers are integers that fit into 32 bits.
Array<std::uint32_t> indices_in(const py::object& numbers, const std::string& name);

/// Converts a 4 x 4 matrix. Throws py::value_error unless the matrix is a rigid transformation, to
/// 1e-6.
Eigen::Isometry3d pose_in(const Array<double>& matrix, const std::string& name);

py::array_t<double> to_array(const Eigen::Vector3d& vector);
py::array_t<double> to_array(const Eigen::Isometry3d& pose);

/// Returns an array of `rows` x `columns` numbers (0 columns: one-dimensional) over memory that
/// `keeper` owns.
template <typename Number>
py::array_t<Number> make_array_view(const Number* numbers, py::ssize_t rows, py::ssize_t columns,
                                    const py::object& keeper) {
  std::vector<py::ssize_t> shape{rows};
  if (columns > 0) shape.push_back(columns);
  py::array_t<Number> array(std::move(shape), numbers, keeper);
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::array_t<float> make_array_view(const std::vector<Eigen::Vector3f>& points,
                                   const py::object& keeper);
py::array_t<double> make_array_view(const std::vector<Eigen::Vector3d>& points,
                                    const py::object& keeper);

/// Moves a value into an object with a Python reference count. Returns its address and the owner.
template <typename Value>
std::pair<const Value*, py::capsule> kept(Value&& value) {
  using Kept = std::remove_cvref_t<Value>;
  auto owned = std::make_unique<Kept>(std::forward<Value>(value));
  const Kept* const pointer = owned.get();
  py::capsule keeper(owned.get(), [](void* kept) { delete static_cast<Kept*>(kept); });
  static_cast<void>(owned.release());
  return {pointer, std::move(keeper)};
}

}  // namespace skycap::python

#include "python/arrays.h"

#include <cmath>

namespace skycap::python {
namespace {

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
    text += (axis > 0 ? ", " : "") + std::to_string(array.shape(axis));
  }
  return text + ")";
}

void require_three_columns(const py::array& array, const std::string& name) {
  if (array.ndim() == 2 && array.shape(1) == 3) return;
  throw py::value_error(name + " has shape " + shape_text(array) +
                        "; it must be rows of x y z, shape (N, 3)");
}

}  // namespace

// Eigen's fixed-size vectors contain only their coefficients.
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));

std::span<const Eigen::Vector3f> points_in(const Array<float>& array, const std::string& name) {
  require_three_columns(array, name);
  return {reinterpret_cast<const Eigen::Vector3f*>(array.data()),
          static_cast<std::size_t>(array.shape(0))};
}

std::vector<Eigen::Vector3d> positions_in(const Array<double>& array, const std::string& name) {
  require_three_columns(array, name);
  const auto* first = reinterpret_cast<const Eigen::Vector3d*>(array.data());
  return {first, first + array.shape(0)};
}

Eigen::Vector3d vector_in(const Array<double>& array, const std::string& name) {
  if (array.ndim() != 1 || array.shape(0) != 3) {
    throw py::value_error(name + " has shape " + shape_text(array) +
                          "; it must be x y z, shape (3,)");
  }
  const Eigen::Vector3d vector(array.data());
  if (!vector.allFinite()) throw py::value_error(name + " is not finite");
  return vector;
}

Array<std::uint32_t> indices_in(const py::object& numbers, const std::string& name) {
  const py::array array = py::array::ensure(numbers);
  if (!array) throw py::type_error(name + " must be an array");
  const char kind = array.dtype().kind();
  const bool is_whole = kind == 'u' || kind == 'i';
  const auto fits = [&] {
    if (array.size() == 0 || (kind == 'u' && array.itemsize() <= 4)) return true;
    return array.attr("min")().cast<py::int_>() >= py::int_(0) &&
           array.attr("max")().cast<py::int_>() <= py::int_(0xFFFFFFFFU);
  };
  if (array.size() > 0 && (!is_whole || !fits())) {
    throw py::value_error(name + " must be 32-bit integers");
  }
  return Array<std::uint32_t>(array);
}

Eigen::Isometry3d pose_in(const Array<double>& matrix, const std::string& name) {
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4) {
    throw py::value_error(name + " has shape " + shape_text(matrix) +
                          "; it must be a matrix of shape (4, 4)");
  }
  Eigen::Isometry3d pose;
  pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix.data());
  const Eigen::Matrix3d turn = pose.linear();
  constexpr double tolerance = 1e-6;
  const bool turns = (turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm() < tolerance &&
                     turn.determinant() > 0.0;
  if (!turns || !pose.translation().allFinite() ||
      pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw py::value_error(name +
                          " must be a rigid transformation: a right-handed rotation, a translation "
                          "and the last row 0 0 0 1");
  }
  return pose;
}

py::array_t<double> to_array(const Eigen::Vector3d& vector) {
  return py::array_t<double>(3, vector.data());
}

py::array_t<double> to_array(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
  return py::array_t<double>({4, 4}, rows.data());
}

py::array_t<float> make_array_view(const std::vector<Eigen::Vector3f>& points,
                                   const py::object& keeper) {
  return make_array_view(reinterpret_cast<const float*>(points.data()),
                         static_cast<py::ssize_t>(points.size()), 3, keeper);
}

py::array_t<double> make_array_view(const std::vector<Eigen::Vector3d>& points,
                                    const py::object& keeper) {
  return make_array_view(reinterpret_cast<const double*>(points.data()),
                         static_cast<py::ssize_t>(points.size()), 3, keeper);
}

}  // namespace skycap::python

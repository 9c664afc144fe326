#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <vector>

#include "fascia/fascia.hpp"

// Arrays that the classes of the module give and take.
namespace fascia::python {

namespace py = pybind11;

/// Numbers of any kind and order, as floats without gaps.
using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// An array of `rows` x `columns` (or `rows`, when columns is 0) that is a view of memory which `owner`
/// keeps.
template <class T>
py::array_t<T> view(const T* data, py::ssize_t rows, py::ssize_t columns, const py::handle& owner,
                    bool is_writable = false) {
  std::vector<py::ssize_t> shape{rows};
  if (columns > 0) shape.push_back(columns);
  if (data == nullptr) return py::array_t<T>(shape);
  py::array_t<T> array(shape, data, owner);
  if (!is_writable) array.attr("flags").attr("writeable") = false;
  return array;
}

/// A column-major matrix as an array of 4 x 4.
inline py::array_t<float> matrix_of(const float* numbers) {
  py::array_t<float> matrix({4, 4});
  for (py::ssize_t row = 0; row < 4; ++row)
    for (py::ssize_t column = 0; column < 4; ++column)
      matrix.mutable_at(row, column) = numbers[4 * column + row];
  return matrix;
}

}  // namespace fascia::python

#pragma once

#include <pybind11/pybind11.h>

namespace fascia::python {

/// Adds the class Fit to the module.
void add_fit(pybind11::module_& module);

}  // namespace fascia::python

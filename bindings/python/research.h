#pragma once

#include <pybind11/pybind11.h>

#include "fascia/fascia.hpp"

namespace fascia::python {

/// Adds what fascia/research.h has to the classes: the lattice, fibres, forces, energies and derivatives.
void add_research(pybind11::class_<fascia::api::Asset>& asset_class,
                  pybind11::class_<fascia::api::Face>& face_class);

}  // namespace fascia::python

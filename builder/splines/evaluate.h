#pragma once

#include <cstddef>

#include "builder/splines/spline.h"

namespace fascia::splines {

/// Values of all outputs at `count` points in user coordinates; output k of point i goes to
/// values[i + k * value_stride]. Chooses the widest vector unit of the machine at run time.
void evaluate_points(const SplineCoefficients& spline, const Vec3* points, size_t count, double* values,
                     size_t value_stride);

/// The kernel's exponent when the vector loops know it (1, 3, 5), else 0.
int simd_exponent(const Kernel& kernel);

/// Value of one output at local point `q` (see SplineCoefficients) and its gradient in user units.
double evaluate_gradient(const SplineCoefficients& spline, int output, const Vec3& q, Vec3& gradient);

/// The same on the machine's vector unit, where the loops know the kernel; the last digits depend on it.
double evaluate_gradient_in_vectors(const SplineCoefficients& spline, int output, const Vec3& q,
                                    Vec3& gradient);

}  // namespace fascia::splines

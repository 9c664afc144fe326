#pragma once

#include <cmath>
#include <span>

namespace fascia::sim {

/// Activation dynamics: time constants in seconds. First order with separate rise and decay, after Zajac
/// 1989, Critical Reviews in Biomedical Engineering 17(4), eq. 5; 0 follows the excitation immediately.
struct ActivationDynamics {
  double rise = 0.030;
  double decay = 0.050;
};

/// Moves each of `activations` towards its `excitations` over `seconds`, by the exact solution (independent
/// of the step size). Both spans #channels.
inline void follow(const ActivationDynamics& dynamics, double seconds, std::span<const float> excitations,
                   std::span<float> activations) {
  const auto share = [seconds](double constant) {
    return constant > 0.0 ? 1.0 - std::exp(-seconds / constant) : 1.0;
  };
  const double rise = share(dynamics.rise), decay = share(dynamics.decay);
  for (size_t i = 0; i < activations.size() && i < excitations.size(); ++i) {
    const double gap = static_cast<double>(excitations[i]) - activations[i];
    const bool rising = std::abs(excitations[i]) > std::abs(activations[i]);
    activations[i] = static_cast<float>(activations[i] + (rising ? rise : decay) * gap);
  }
}

}  // namespace fascia::sim

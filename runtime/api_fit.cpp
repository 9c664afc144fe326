#include "fascia/fit.h"

#include "runtime/api.h"
#include "runtime/fit.h"

using namespace fascia::runtime;

namespace {

Fit& checked_fit(const fascia_fit* fit) {
  require(fit != nullptr, "the fit is null");
  return *fit->fit;
}

}  // namespace

extern "C" {

fascia_fit_options fascia_default_fit_options(void) {
  const fascia::fit::TrackerOptions usual;
  fascia_fit_options options{};
  options.struct_size = sizeof options;
  options.iterations = usual.iterations;
  options.finds_scale = usual.finds_scale ? 1 : 0;
  options.ridge = static_cast<float>(usual.ridge);
  options.sparsity = static_cast<float>(usual.sparsity);
  options.smoothness = static_cast<float>(usual.smoothness);
  return options;
}

fascia_result fascia_fit_create(fascia_asset* asset, const fascia_fit_landmarks* landmarks,
                                const fascia_fit_options* options, fascia_fit** fit) {
  return guarded([&] {
    require(asset != nullptr, "the asset is null");
    require(landmarks != nullptr, "the landmarks are null");
    require(fit != nullptr, "the fit to write is null");
    auto made = std::make_unique<fascia_fit>();
    made->fit = std::make_unique<Fit>(asset->asset, taken(landmarks, fascia_fit_landmarks{}),
                                      taken(options, fascia_default_fit_options()));
    hand_over(std::move(made), fit);
    return FASCIA_OK;
  });
}

void fascia_fit_release(fascia_fit* fit) {
  released(fit);
}

fascia_result fascia_fit_get_info(const fascia_fit* handle, fascia_fit_info* info) {
  return guarded([&] {
    const Fit& fit = checked_fit(handle);
    hand_out(fascia_fit_info{0, fit.point_count(), fit.dimensions(),
                             static_cast<uint32_t>(fit.names().size()), fit.names().data()},
             info);
    return FASCIA_OK;
  });
}

fascia_result fascia_fit_set_neutral(fascia_fit* fit, const float* points, const float* weights) {
  return guarded([&] {
    checked_fit(fit).set_neutral(points, weights);
    return FASCIA_OK;
  });
}

fascia_result fascia_fit_push(fascia_fit* fit, const float* points, const float* weights,
                              fascia_fit_result* result) {
  return guarded([&] {
    require(result == nullptr || result->struct_size >= 2 * sizeof(uint32_t),
            "struct_size is not set: it must be sizeof the structure");
    const fascia_fit_result found = checked_fit(fit).push(points, weights);
    if (result != nullptr) hand_out(found, result);
    return FASCIA_OK;
  });
}

fascia_result fascia_fit_reset(fascia_fit* fit) {
  return guarded([&] {
    checked_fit(fit).reset();
    return FASCIA_OK;
  });
}

}  // extern "C"

/// \file
/// Fascia's runtime for C++20: the C interface (fascia/fascia.h) with RAII, exceptions and spans. Header
/// only.
///
///     fascia::api::Asset asset = fascia::api::Asset::load(bytes);
///     fascia::api::Face face(asset);
///     face.set("arkit:mouthSmileLeft", 0.8f);
///     face.step(1.0f / 60.0f);
///     std::span<const std::array<float, 3>> positions = face.positions(0);
///
/// Everything that can fail throws fascia::api::Error, except that step returns false for
/// FASCIA_ERROR_DIVERGED, after which a face can be stepped again. Functions without a wrapper can be called
/// with the handle: fascia_face_skinning(face.handle(), ...).
#ifndef FASCIA_FASCIA_HPP
#define FASCIA_FASCIA_HPP

#include "fascia/asset.hpp"
#include "fascia/face.hpp"
#include "fascia/fit.hpp"
#include "fascia/gpu.h"

#endif

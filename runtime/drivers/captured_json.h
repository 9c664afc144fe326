#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "runtime/drivers/curves.h"

namespace fascia::runtime {

/// Curves from JSON that a capture program wrote, told by what stands in it; nothing when it is of no known
/// kind:
///   Audio2Face: {"exportFps", "facsNames": [...], "weightMat": [[...], ...]};
///   Azure speech: {"BlendShapes": [[55 numbers], ...]} at 60 a second, one or a list of them, and visemes as
///     [{"audioOffset", "visemeId"}, ...];
///   frames: a list, bare or in "frames", of objects with a time ("time", "timestamp", "timestampMs", ...)
///   and
///     weights: {NAME: number} or [{"categoryName", "score"}, ...] in "blendShapes" and the like, as
///     MediaPipe's "faceBlendshapes", or beside the time.
/// Throws fascia::Error that names the frame or entry at fault.
std::optional<Curves> read_captured_json(const nlohmann::json& root, const ReadOptions& options);

}  // namespace fascia::runtime

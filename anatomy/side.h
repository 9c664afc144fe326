#pragma once

namespace fascia::anatomy {

/// The subject's side.
enum class Side { midline, left, right };

}  // namespace fascia::anatomy

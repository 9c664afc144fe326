#pragma once

#include <cstddef>

namespace fascia::cli {

/// Rows that are worked on at once.
inline constexpr size_t product_rows = 64;

/// A product's numbers: columns of `rows` floats, `depth` of them; `mix` and `out` with columns of `depth`
/// and `rows` floats, `count` of them.
struct ProductParts {
  const float* const* columns;
  size_t rows, depth;
  const float* mix;
  size_t count;
  float* out;
  float* scratch;  ///< room for product_rows x depth
};

void product_baseline(const ProductParts& parts);
void product_avx2(const ProductParts& parts);
void product_avx512(const ProductParts& parts);

}  // namespace fascia::cli

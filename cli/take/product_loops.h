#pragma once

#include <cstddef>

namespace fascia::cli {

/// A product's numbers: columns of `rows` floats, `depth` of them; `mix` and `out` with columns of `depth`
/// and `rows` floats, `count` of them.
struct ProductParts {
  const float* const* columns;
  size_t rows, depth;
  const float* mix;
  size_t count;
  float* out;
};

void product_baseline(const ProductParts& parts);
void product_avx2(const ProductParts& parts);
void product_avx512(const ProductParts& parts);

}  // namespace fascia::cli

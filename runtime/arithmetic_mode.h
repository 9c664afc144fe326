#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace fascia::runtime {

/// While it lives, this thread's arithmetic is as IEEE 754 has it by default: rounded to nearest, subnormal
/// numbers kept, no traps; afterwards as the host had it. Hosts set other modes (flush to zero is common in
/// audio and game engines), and the same frame has to come out under all of them.
class ArithmeticMode {
 public:
#if defined(__SSE2__)
  ArithmeticMode() : host_(_mm_getcsr()) {
    if ((host_ & control) != usual) _mm_setcsr(usual);
  }
  ~ArithmeticMode() {
    if ((host_ & control) != usual) _mm_setcsr(host_);
  }

 private:
  static constexpr unsigned control = 0xFFC0;  ///< all but the flags of what has happened
  static constexpr unsigned usual = 0x1F80;    ///< traps masked, to nearest, subnormals kept
  unsigned host_;
#else
  ArithmeticMode() {
    std::fegetenv(&host_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~ArithmeticMode() {
    std::fesetenv(&host_);
  }

 private:
  std::fenv_t host_;
#endif

 public:
  ArithmeticMode(const ArithmeticMode&) = delete;
  ArithmeticMode& operator=(const ArithmeticMode&) = delete;
};

}  // namespace fascia::runtime

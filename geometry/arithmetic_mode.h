#pragma once

#if defined(__SSE2__) && !defined(__EMSCRIPTEN__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace fascia {

/// During its lifetime, this thread uses IEEE 754's default arithmetic: rounding to nearest, subnormal
/// numbers, no traps; the destructor restores the host's mode, with the exception flags it had raised and no
/// others. Hosts set other modes (flush to zero is common in audio and game engines), and results must not
/// depend on them.
class ArithmeticMode {
 public:
#if defined(__SSE2__) && !defined(__EMSCRIPTEN__)
  ArithmeticMode() : host_(_mm_getcsr()) {
    _mm_setcsr(usual);
#if defined(__GNUC__)
    // The C library asks the x87 unit how it rounds when it reads and writes decimals.
    asm volatile("fnstcw %0" : "=m"(host_x87_));
    if (host_x87_ != usual_x87) asm volatile("fldcw %0" : : "m"(usual_x87));
#endif
  }
  ~ArithmeticMode() {
    _mm_setcsr(host_);
#if defined(__GNUC__)
    if (host_x87_ != usual_x87) asm volatile("fldcw %0" : : "m"(host_x87_));
#endif
  }

 private:
  static constexpr unsigned usual = 0x1F80;            ///< traps masked, to nearest, subnormals kept
  static constexpr unsigned short usual_x87 = 0x037F;  ///< traps masked, to nearest, full precision
  unsigned host_;
  unsigned short host_x87_ = usual_x87;
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

}  // namespace fascia

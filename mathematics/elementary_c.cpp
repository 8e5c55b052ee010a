/// Elementary functions under their C names, for all code linked into the same program. The linker
/// and the loader prefer definitions of the program to those of a library.

#include <cmath>

#include "mathematics/elementary.h"

namespace math = skycap::mathematics;

extern "C" {

double exp(double x) noexcept { return math::exp(x); }
double exp2(double x) noexcept { return math::exp2(x); }
double expm1(double x) noexcept { return math::expm1(x); }
double log(double x) noexcept { return math::log(x); }
double log2(double x) noexcept { return math::log2(x); }
double log10(double x) noexcept { return math::log10(x); }
double log1p(double x) noexcept { return math::log1p(x); }
double pow(double x, double y) noexcept { return math::pow(x, y); }

double sin(double x) noexcept { return math::sin(x); }
double cos(double x) noexcept { return math::cos(x); }
double tan(double x) noexcept { return math::tan(x); }
double asin(double x) noexcept { return math::asin(x); }
double acos(double x) noexcept { return math::acos(x); }
double atan(double x) noexcept { return math::atan(x); }
double atan2(double y, double x) noexcept { return math::atan2(y, x); }
void sincos(double x, double* sine, double* cosine) noexcept {
  const double of = x;  // `x` may be overwritten by the results
  *sine = math::sin(of);
  *cosine = math::cos(of);
}

double sinh(double x) noexcept { return math::sinh(x); }
double cosh(double x) noexcept { return math::cosh(x); }
double tanh(double x) noexcept { return math::tanh(x); }
double asinh(double x) noexcept { return math::asinh(x); }
double acosh(double x) noexcept { return math::acosh(x); }
double atanh(double x) noexcept { return math::atanh(x); }

double erf(double x) noexcept { return math::erf(x); }

// Double rounding affects about one in 2^28 results.
float expf(float x) noexcept { return static_cast<float>(math::exp(x)); }
float exp2f(float x) noexcept { return static_cast<float>(math::exp2(x)); }
float expm1f(float x) noexcept { return static_cast<float>(math::expm1(x)); }
float logf(float x) noexcept { return static_cast<float>(math::log(x)); }
float log2f(float x) noexcept { return static_cast<float>(math::log2(x)); }
float log10f(float x) noexcept { return static_cast<float>(math::log10(x)); }
float log1pf(float x) noexcept { return static_cast<float>(math::log1p(x)); }
float powf(float x, float y) noexcept { return static_cast<float>(math::pow(x, y)); }

float sinf(float x) noexcept { return static_cast<float>(math::sin(x)); }
float cosf(float x) noexcept { return static_cast<float>(math::cos(x)); }
float tanf(float x) noexcept { return static_cast<float>(math::tan(x)); }
float asinf(float x) noexcept { return static_cast<float>(math::asin(x)); }
float acosf(float x) noexcept { return static_cast<float>(math::acos(x)); }
float atanf(float x) noexcept { return static_cast<float>(math::atan(x)); }
float atan2f(float y, float x) noexcept { return static_cast<float>(math::atan2(y, x)); }
void sincosf(float x, float* sine, float* cosine) noexcept {
  const double of = x;
  *sine = static_cast<float>(math::sin(of));
  *cosine = static_cast<float>(math::cos(of));
}

}  // extern "C"

/// Elementary functions of <cmath> with bit-identical results on all platforms.
///
/// The last bit of sin() or exp() of a standard library depends on the library. In glibc, it also
/// depends on whether the processor supports fused multiply-add. A survey is a long chain of
/// decisions, so that one such bit can change the whole survey. The functions in this header use
/// only IEEE 754 additions, multiplications, divisions and square roots in double precision, in a
/// fixed order. Hence they give the same results on every processor and with every
/// standard-conforming compiler.
///
/// Results are within 0.6 ulp of the exact value; those of sin, cos and tan within 0.8 ulp, of
/// expm1, erf and the hyperbolic functions within 2 ulp.
///
/// A program that links skycap::mathematics uses these functions under their C names, both directly
/// and in all its libraries (elementary_c.cpp). Special values comply with the C standard, annex F.
/// errno is not set.
#pragma once

namespace skycap::mathematics {

double exp(double x);
double exp2(double x);
double expm1(double x);
double log(double x);
double log2(double x);
double log10(double x);
double log1p(double x);
double pow(double x, double y);

double sin(double x);
double cos(double x);
double tan(double x);
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);

double sinh(double x);
double cosh(double x);
double tanh(double x);
double asinh(double x);
double acosh(double x);
double atanh(double x);

double erf(double x);

}  // namespace skycap::mathematics

/// The elementary functions of <cmath>, the same bits everywhere.
///
/// What a library's sin() or exp() returns in the last bit depends on the library and, in glibc, on
/// the processor, which it asks for fused multiply-adds. A survey is a long chain of decisions, so
/// one such bit can become another survey. These functions use nothing but IEEE 754 additions,
/// multiplications, divisions and square roots in double precision, in one order, and so give the
/// same on every processor and with every compiler that keeps to the standard. Results are within
/// 0.6 ulp of the true value, those of sin, cos and tan within 0.8, of expm1, erf and the
/// hyperbolic functions within 2.
///
/// A program that links skycap::mathematics gets them under their names in C, for itself and for
/// all libraries it uses: elementary_c.cpp. Special values are those of the C standard, annex F.
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

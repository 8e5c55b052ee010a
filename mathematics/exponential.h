/// What powers share with exponentials and logarithms.
#pragma once

#include "mathematics/double_double.h"

namespace skycap::mathematics {

/// e^x, x.high not NaN and |x.high| < 1000. Within 0.51 ulp unless the result is subnormal.
double exp(const DoubleDouble& x);

/// The natural logarithm of a positive finite number, to 2^-66 of itself.
DoubleDouble log_of_positive(double x);

}  // namespace skycap::mathematics

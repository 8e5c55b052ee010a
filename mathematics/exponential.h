/// Functions shared by powers, exponentials and logarithms.
#pragma once

#include "mathematics/double_double.h"

namespace skycap::mathematics {

/// Returns e^x within 0.51 ulp, unless the result is subnormal. Requires that x.high is not NaN and
/// |x.high| < 1000.
double exp(const DoubleDouble& x);

/// Returns the natural logarithm of a positive finite number with a relative error of at most
/// 2^-66.
DoubleDouble log_positive(double x);

}  // namespace skycap::mathematics

#include "mathematics/elementary.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mpfr.h>

namespace skycap::mathematics {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// An MPFR number with `bits` bits.
class Exact {
 public:
  static constexpr mpfr_prec_t bits = 300;
  Exact() { mpfr_init2(value, bits); }
  explicit Exact(double from) : Exact() { mpfr_set_d(value, from, MPFR_RNDN); }
  Exact(const Exact&) = delete;
  Exact& operator=(const Exact&) = delete;
  ~Exact() { mpfr_clear(value); }

  mpfr_t value;
};

// Returns the error of `computed` in units in the last place of the nearest double.
double error_in_ulp(double computed, const Exact& exact) {
  const double nearest = mpfr_get_d(exact.value, MPFR_RNDN);
  if (computed == nearest) return 0.0;  // correctly rounded: the error is at most 0.5 ulp
  if (std::isnan(computed) || std::isinf(nearest)) return infinity;
  const double toward_zero = std::nextafter(std::abs(nearest), 0.0);
  const double ulp = std::max(std::abs(nearest) - toward_zero, 0x1p-1074);
  Exact difference(computed);
  mpfr_sub(difference.value, difference.value, exact.value, MPFR_RNDN);
  return std::abs(mpfr_get_d(difference.value, MPFR_RNDN)) / ulp;
}

using UnaryFunction = double (*)(double);
using ExactUnaryFunction = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);

struct Function {
  const char* name;
  UnaryFunction computed;
  ExactUnaryFunction exact;
  double min, max;  // magnitudes of arguments, uniform in the exponent
  double bound;     // [ulp]
};
// NOLINTNEXTLINE(readability-identifier-naming): gtest looks for it
void PrintTo(const Function& function, std::ostream* out) { *out << function.name; }

class Elementary : public testing::TestWithParam<Function> {};

// MPFR is the independent reference, for all magnitudes and, twice as often, near 1.
TEST_P(Elementary, MatchesMpfr) {
  const Function& function = GetParam();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> log_range(std::log2(function.min),
                                                   std::log2(function.max));
  std::uniform_real_distribution<double> plain(-std::min(function.max, 12.0),
                                               std::min(function.max, 12.0));
  Exact exact;
  double worst = 0.0, worst_at = 0.0;
  constexpr int count = 60'000;
  for (int i = 0; i < count; ++i) {
    double x = i % 3 == 0 ? std::exp2(log_range(random)) : plain(random);
    if (i % 2 == 0) x = -x;
    mpfr_set_d(exact.value, x, MPFR_RNDN);
    function.exact(exact.value, exact.value, MPFR_RNDN);
    const double computed = function.computed(x);
    if (mpfr_nan_p(exact.value) != 0) {
      ASSERT_TRUE(std::isnan(computed)) << x;
      continue;
    }
    const double error = error_in_ulp(computed, exact);
    if (error > worst) {
      worst = error;
      worst_at = x;
    }
  }
  EXPECT_LT(worst, function.bound) << "at " << std::hexfloat << worst_at;
  RecordProperty("worst_ulp", std::to_string(worst));
}

INSTANTIATE_TEST_SUITE_P(All, Elementary,
                         testing::Values(Function{"exp", exp, mpfr_exp, 1e-20, 745.0, 0.6},
                                         Function{"exp2", exp2, mpfr_exp2, 1e-20, 1070.0, 0.6},
                                         Function{"expm1", expm1, mpfr_expm1, 1e-20, 709.0, 2.0},
                                         Function{"log", log, mpfr_log, 1e-320, 1e308, 0.6},
                                         Function{"log2", log2, mpfr_log2, 1e-320, 1e308, 0.6},
                                         Function{"log10", log10, mpfr_log10, 1e-320, 1e308, 0.6},
                                         Function{"sin", sin, mpfr_sin, 1e-300, 1e308, 0.8},
                                         Function{"cos", cos, mpfr_cos, 1e-300, 1e308, 0.8},
                                         Function{"tan", tan, mpfr_tan, 1e-300, 1e308, 0.8},
                                         Function{"asin", asin, mpfr_asin, 1e-300, 1.0, 0.6},
                                         Function{"acos", acos, mpfr_acos, 1e-300, 1.0, 0.6},
                                         Function{"atan", atan, mpfr_atan, 1e-300, 1e308, 0.6},
                                         Function{"sinh", sinh, mpfr_sinh, 1e-300, 710.0, 2.0},
                                         Function{"cosh", cosh, mpfr_cosh, 1e-300, 710.0, 2.0},
                                         Function{"tanh", tanh, mpfr_tanh, 1e-300, 100.0, 2.0},
                                         Function{"log1p", log1p, mpfr_log1p, 1e-300, 1e308, 2.0},
                                         Function{"asinh", asinh, mpfr_asinh, 1e-300, 1e308, 2.0},
                                         Function{"acosh", acosh, mpfr_acosh, 1e-300, 1e308, 2.0},
                                         Function{"atanh", atanh, mpfr_atanh, 1e-300, 1.0, 2.0},
                                         Function{"erf", erf, mpfr_erf, 1e-300, 1e308, 2.0}),
                         [](const auto& instance) { return std::string(instance.param.name); });

// Functions of two arguments, with all combinations of magnitudes.
TEST(Elementary, MatchesMpfrForPowAndAtan2) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> exponent(-300.0, 300.0), near(-8.0, 8.0);
  Exact exact, second;
  double worst_angle = 0.0, worst_power = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    const double x =
        (i % 2 == 0 ? -1.0 : 1.0) * std::exp2(i % 3 == 0 ? exponent(random) : near(random));
    const double y =
        (i % 4 < 2 ? -1.0 : 1.0) * std::exp2(i % 5 == 0 ? exponent(random) : near(random));
    mpfr_set_d(exact.value, y, MPFR_RNDN);
    mpfr_set_d(second.value, x, MPFR_RNDN);
    mpfr_atan2(exact.value, exact.value, second.value, MPFR_RNDN);
    worst_angle = std::max(worst_angle, error_in_ulp(atan2(y, x), exact));

    const double base = std::abs(x), to = 700.0 / std::log(base) * near(random) / 8.0;
    mpfr_set_d(exact.value, base, MPFR_RNDN);
    mpfr_set_d(second.value, to, MPFR_RNDN);
    mpfr_pow(exact.value, exact.value, second.value, MPFR_RNDN);
    worst_power = std::max(worst_power, error_in_ulp(pow(base, to), exact));
  }
  EXPECT_LT(worst_angle, 0.6);
  EXPECT_LT(worst_power, 0.6);
}

// The hardest arguments for the reduction by pi / 2: the double closest to a multiple of it (J.-M.
// Muller, Elementary Functions, 11.3.2) and nearby powers of two.
TEST(Elementary, ReducesAnglesNearMultiplesOfQuarterTurn) {
  std::vector<double> angles = {6381956970095103.0 * 0x1p797, 0x1.6ac5b262ca1ffp+849};
  for (int quarters = 1; quarters < 3000; ++quarters) {
    angles.push_back(quarters * 1.5707963267948966);
  }
  for (int e = -30; e < 1024; ++e) angles.push_back(std::ldexp(1.5707963267948966, e));
  Exact exact;
  for (const double angle : angles) {
    const auto error = [&](UnaryFunction computed, ExactUnaryFunction of) {
      mpfr_set_d(exact.value, angle, MPFR_RNDN);
      of(exact.value, exact.value, MPFR_RNDN);
      return error_in_ulp(computed(angle), exact);
    };
    if (std::isinf(angle)) continue;
    EXPECT_LT(error(sin, mpfr_sin), 0.8) << angle;
    EXPECT_LT(error(cos, mpfr_cos), 0.8) << angle;
    EXPECT_LT(error(tan, mpfr_tan), 0.8) << angle;
  }
}

// Arguments with exact results give these results.
TEST(Elementary, ReturnsExactResultsExactly) {
  for (int n = -1074; n < 1024; ++n) {
    EXPECT_EQ(exp2(n), std::ldexp(1.0, n));
    EXPECT_EQ(log2(std::ldexp(1.0, n)), n);
    EXPECT_EQ(pow(2.0, n), std::ldexp(1.0, n));
  }
  double ten = 1.0;
  for (int n = 0; n <= 22; ++n, ten *= 10.0) {
    EXPECT_EQ(pow(10.0, n), ten);
    EXPECT_EQ(log10(ten), n);
  }
  std::mt19937_64 random(3);
  std::uniform_int_distribution<std::int64_t> whole(1, 1 << 26);
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<double>(whole(random));
    EXPECT_EQ(pow(x, 2.0), x * x);
    EXPECT_EQ(pow(x * x, 0.5), x);
    EXPECT_EQ(pow(-x, 1.0), -x);
  }
}

bool is_same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

// C17, annex F.10.
TEST(Elementary, ReturnsSpecialValuesOfC17) {
  struct Case {
    const char* what;
    double computed, expected;
  };
  constexpr double pi = 3.14159265358979312;
  for (const Case& each :
       std::vector<Case>{{"exp(0)", exp(-0.0), 1.0},
                         {"exp(-inf)", exp(-infinity), 0.0},
                         {"exp(inf)", exp(infinity), infinity},
                         {"exp(800)", exp(800.0), infinity},
                         {"exp(-800)", exp(-800.0), 0.0},
                         {"expm1(-0)", expm1(-0.0), -0.0},
                         {"expm1(-inf)", expm1(-infinity), -1.0},
                         {"expm1(inf)", expm1(infinity), infinity},
                         {"exp2(-inf)", exp2(-infinity), 0.0},
                         {"exp2(1024)", exp2(1024.0), infinity},
                         {"log(0)", log(-0.0), -infinity},
                         {"log(1)", log(1.0), 0.0},
                         {"log(-1)", log(-1.0), nan},
                         {"log(inf)", log(infinity), infinity},
                         {"log2(1)", log2(1.0), 0.0},
                         {"log10(1)", log10(1.0), 0.0},
                         {"sin(-0)", sin(-0.0), -0.0},
                         {"sin(inf)", sin(infinity), nan},
                         {"cos(0)", cos(-0.0), 1.0},
                         {"cos(-inf)", cos(-infinity), nan},
                         {"tan(-0)", tan(-0.0), -0.0},
                         {"tan(inf)", tan(infinity), nan},
                         {"asin(-0)", asin(-0.0), -0.0},
                         {"asin(1)", asin(1.0), 0.5 * pi},
                         {"asin(2)", asin(2.0), nan},
                         {"acos(1)", acos(1.0), 0.0},
                         {"acos(-1)", acos(-1.0), pi},
                         {"acos(-2)", acos(-2.0), nan},
                         {"atan(-0)", atan(-0.0), -0.0},
                         {"atan(-inf)", atan(-infinity), -0.5 * pi},
                         {"atan2(0, -0)", atan2(0.0, -0.0), pi},
                         {"atan2(-0, -0)", atan2(-0.0, -0.0), -pi},
                         {"atan2(-0, 0)", atan2(-0.0, 0.0), -0.0},
                         {"atan2(-0, -1)", atan2(-0.0, -1.0), -pi},
                         {"atan2(0, 1)", atan2(0.0, 1.0), 0.0},
                         {"atan2(-1, 0)", atan2(-1.0, -0.0), -0.5 * pi},
                         {"atan2(1, -inf)", atan2(1.0, -infinity), pi},
                         {"atan2(-1, inf)", atan2(-1.0, infinity), -0.0},
                         {"atan2(inf, 1)", atan2(infinity, 1.0), 0.5 * pi},
                         {"atan2(inf, -inf)", atan2(infinity, -infinity), 0.75 * pi},
                         {"atan2(-inf, inf)", atan2(-infinity, infinity), -0.25 * pi},
                         {"atan2(tiny, huge)", atan2(0x1p-1074, 1e300), 0.0},
                         {"atan2(tiny, tiny)", atan2(0x1p-1074, 0x1p-1074), 0.25 * pi},
                         {"atan2(huge, huge)", atan2(-1.7e308, 1.7e308), -0.25 * pi},
                         {"pow(nan, 0)", pow(nan, 0.0), 1.0},
                         {"pow(1, nan)", pow(1.0, nan), 1.0},
                         {"pow(0, -3)", pow(-0.0, -3.0), -infinity},
                         {"pow(0, -2)", pow(-0.0, -2.0), infinity},
                         {"pow(-0, 3)", pow(-0.0, 3.0), -0.0},
                         {"pow(-0, 2.5)", pow(-0.0, 2.5), 0.0},
                         {"pow(-1, inf)", pow(-1.0, -infinity), 1.0},
                         {"pow(0.5, -inf)", pow(0.5, -infinity), infinity},
                         {"pow(-2, inf)", pow(-2.0, infinity), infinity},
                         {"pow(2, -inf)", pow(2.0, -infinity), 0.0},
                         {"pow(-inf, -3)", pow(-infinity, -3.0), -0.0},
                         {"pow(-inf, 3)", pow(-infinity, 3.0), -infinity},
                         {"pow(-inf, 2)", pow(-infinity, 2.0), infinity},
                         {"pow(inf, -0.5)", pow(infinity, -0.5), 0.0},
                         {"pow(-8, 1/3)", pow(-8.0, 1.0 / 3.0), nan},
                         {"pow(-2, 1e300)", pow(-2.0, 1e300), infinity},
                         {"pow(1 - ulp, 1e300)", pow(1.0 - 0x1p-53, 1e300), 0.0},
                         {"sinh(-inf)", sinh(-infinity), -infinity},
                         {"sinh(-0)", sinh(-0.0), -0.0},
                         {"cosh(-inf)", cosh(-infinity), infinity},
                         {"tanh(-inf)", tanh(-infinity), -1.0},
                         {"tanh(-0)", tanh(-0.0), -0.0},
                         {"log1p(-0)", log1p(-0.0), -0.0},
                         {"log1p(-1)", log1p(-1.0), -infinity},
                         {"log1p(-2)", log1p(-2.0), nan},
                         {"log1p(inf)", log1p(infinity), infinity},
                         {"acosh(1)", acosh(1.0), 0.0},
                         {"acosh(0.5)", acosh(0.5), nan},
                         {"acosh(inf)", acosh(infinity), infinity},
                         {"atanh(-0)", atanh(-0.0), -0.0},
                         {"atanh(-1)", atanh(-1.0), -infinity},
                         {"atanh(2)", atanh(2.0), nan},
                         {"asinh(-0)", asinh(-0.0), -0.0},
                         {"asinh(-inf)", asinh(-infinity), -infinity},
                         {"pow(-1, 2^51 + 1)", pow(-1.0, 0x1p51 + 1.0), -1.0},
                         {"erf(-0)", erf(-0.0), -0.0},
                         {"erf(-inf)", erf(-infinity), -1.0}}) {
    EXPECT_TRUE(is_same(each.computed, each.expected))
        << each.what << " is " << each.computed << ", not " << each.expected;
  }
  for (const UnaryFunction function :
       {exp,  exp2, expm1, log,  log2, log10, sin,   cos,   tan,   asin,
        acos, atan, sinh,  cosh, tanh, asinh, acosh, atanh, log1p, erf}) {
    EXPECT_TRUE(std::isnan(function(nan)));
  }
  EXPECT_TRUE(std::isnan(pow(nan, 2.0)) && std::isnan(pow(2.0, nan)));
  EXPECT_TRUE(std::isnan(atan2(nan, 2.0)) && std::isnan(atan2(2.0, nan)));
}

// The loader finds these functions first when the program or its libraries call the C functions by
// name.
TEST(Elementary, ReplacesTheCFunctions) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> argument(0.1, 0.9);
  const auto expect_same = [&](const char* name, UnaryFunction ours) {
    const auto loaded = reinterpret_cast<UnaryFunction>(::dlsym(RTLD_DEFAULT, name));
    ASSERT_NE(loaded, nullptr) << name;
    EXPECT_NE(reinterpret_cast<void*>(loaded), ::dlsym(RTLD_NEXT, name)) << name;
    for (int i = 0; i < 1000; ++i) {
      const double x = argument(random);
      ASSERT_TRUE(is_same(loaded(x), ours(x))) << name << " of " << x;
    }
  };
  const auto expect_same_in_single = [&](const char* name, UnaryFunction ours) {
    const auto loaded = reinterpret_cast<float (*)(float)>(::dlsym(RTLD_DEFAULT, name));
    ASSERT_NE(loaded, nullptr) << name;
    for (int i = 0; i < 1000; ++i) {
      const auto x = static_cast<float>(argument(random));
      ASSERT_EQ(loaded(x), static_cast<float>(ours(x))) << name << " of " << x;
    }
  };
  for (const auto& [name, ours] :
       std::vector<std::pair<const char*, UnaryFunction>>{{"expf", exp},
                                                          {"exp2f", exp2},
                                                          {"expm1f", expm1},
                                                          {"logf", log},
                                                          {"log2f", log2},
                                                          {"log10f", log10},
                                                          {"log1pf", log1p},
                                                          {"sinf", sin},
                                                          {"cosf", cos},
                                                          {"tanf", tan},
                                                          {"asinf", asin},
                                                          {"acosf", acos},
                                                          {"atanf", atan}}) {
    expect_same_in_single(name, ours);
  }
  expect_same("exp", exp);
  expect_same("exp2", exp2);
  expect_same("expm1", expm1);
  expect_same("log", log);
  expect_same("log2", log2);
  expect_same("log10", log10);
  expect_same("log1p", log1p);
  expect_same("sin", sin);
  expect_same("cos", cos);
  expect_same("tan", tan);
  expect_same("asin", asin);
  expect_same("acos", acos);
  expect_same("atan", atan);
  expect_same("sinh", sinh);
  expect_same("cosh", cosh);
  expect_same("tanh", tanh);
  expect_same("asinh", asinh);
  expect_same("atanh", atanh);
  expect_same("erf", erf);
  for (int i = 0; i < 1000; ++i) {
    const double x = argument(random), y = 8.0 * argument(random) - 4.0;
    ASSERT_TRUE(is_same(std::pow(x, y), pow(x, y)));
    ASSERT_TRUE(is_same(std::atan2(y, x), atan2(y, x)));
    ASSERT_TRUE(is_same(std::acosh(1.0 + x), acosh(1.0 + x)));
    double sine = x, cosine = 0.0;  // the output may overwrite the argument
    ::sincos(sine, &sine, &cosine);
    ASSERT_TRUE(is_same(sine, sin(x)) && is_same(cosine, cos(x)));
    const auto single = static_cast<float>(x), other = static_cast<float>(y);
    ASSERT_EQ(std::pow(single, other), static_cast<float>(pow(single, other)));
    ASSERT_EQ(std::atan2(other, single), static_cast<float>(atan2(other, single)));
    float single_sine = single, single_cosine = 0.0F;
    ::sincosf(single_sine, &single_sine, &single_cosine);
    ASSERT_EQ(single_sine, static_cast<float>(sin(single)));
    ASSERT_EQ(single_cosine, static_cast<float>(cos(single)));
  }
}

}  // namespace
}  // namespace skycap::mathematics

#include "geometry/requirement.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"

namespace skycap {
namespace {

std::string error_message(double value) {
  try {
    require(false, "sensor.width", value, "above 0");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_config);
    return error.what();
  }
  return "";
}

TEST(Requirement, NamesFieldValueAndRule) {
  EXPECT_EQ(error_message(-0.25), "sensor.width is -0.25; it must be above 0");
  EXPECT_EQ(error_message(1234567.0), "sensor.width is 1.23457e+06; it must be above 0");
  EXPECT_EQ(error_message(NAN), "sensor.width is nan; it must be above 0");
  EXPECT_EQ(error_message(-1.234567e-300), "sensor.width is -1.23457e-300; it must be above 0");
}

TEST(Requirement, DoesNotThrowWhenMet) { EXPECT_NO_THROW(require(true, "x", 0.0, "zero")); }

}  // namespace
}  // namespace skycap

// Text files of other programs: byte order marks, line ends, numbers.
#include "geometry/io/text/plain_text.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/io/text/text_scanner.h"

namespace skycap::geometry {
namespace {

TEST(PlainText, RemovesByteOrderMarkAndNormalisesLineEnds) {
  for (const std::string text : {"a\nb\n\nc",
                                 "\xEF\xBB\xBF"
                                 "a\nb\n\nc",
                                 "a\r\nb\r\n\r\nc", "a\rb\r\rc", "a\rb\n\r\nc"}) {
    EXPECT_EQ(plain_text(text), "a\nb\n\nc") << text;
  }
  EXPECT_EQ(plain_text(""), "");
  EXPECT_EQ(plain_text("\r"), "\n");
}

// U+00E4, U+20AC and U+1F600 have two, three and four bytes in UTF-8.
TEST(PlainText, ReadsUtf16InBothByteOrders) {
  const std::string utf8 = "a\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80";
  const std::u16string units = u"a\u00E4\u20AC\U0001F600";
  for (const bool is_big_endian : {false, true}) {
    std::string bytes = is_big_endian ? "\xFE\xFF" : "\xFF\xFE";
    for (const char16_t unit : units) {
      const char high = static_cast<char>(unit >> 8), low = static_cast<char>(unit & 0xFF);
      bytes += is_big_endian ? high : low;
      bytes += is_big_endian ? low : high;
    }
    EXPECT_EQ(plain_text(bytes), utf8);
    EXPECT_EQ(as_utf8(bytes), utf8);
  }
  EXPECT_EQ(as_utf8(std::string("<\0?\0", 4)), "<?");  // without a byte order mark
  EXPECT_EQ(as_utf8(std::string("\0<\0?", 4)), "<?");
}

TEST(PlainText, ReadsNumbersInCommonNotations) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(number_in("+1.5e2"), 150.0);
  EXPECT_EQ(number_in("-.25"), -0.25);
  EXPECT_EQ(number_in("1e999"), infinity);
  EXPECT_EQ(number_in("-1e999"), -infinity);
  EXPECT_EQ(number_in("1e-999"), 0.0);
  for (const char* text : {"inf", "+Inf", "INFINITY", "1.#INF", "1.#INF00"}) {
    EXPECT_EQ(number_in(text), infinity) << text;
  }
  EXPECT_EQ(number_in("-1.#INF"), -infinity);
  for (const char* text : {"nan", "NaN", "-nan", "-nan(ind)", "nan(snan)", "1.#QNAN", "-1.#IND"}) {
    ASSERT_TRUE(number_in(text).has_value()) << text;
    EXPECT_TRUE(std::isnan(*number_in(text))) << text;
  }
  for (const char* text : {"", "+", "++1", "1,5", "1.5m", "one", "0x10", "1.5.2"}) {
    EXPECT_FALSE(number_in(text).has_value()) << text;
  }
  EXPECT_EQ(number_with_comma("1,5"), 1.5);
  EXPECT_EQ(number_with_comma("1.5"), 1.5);
  EXPECT_FALSE(number_with_comma("1,000,5").has_value());
  EXPECT_FALSE(number_with_comma("1.000,5").has_value());
  EXPECT_TRUE(has_decimal_comma("-0,5"));
  EXPECT_FALSE(has_decimal_comma("0.5"));
}

TEST(TextScanner, CountsLinesWithAnyLineEnds) {
  for (const std::string text : {"\xEF\xBB\xBF"
                                 "a b\n\nc\n",
                                 "a b\r\n\r\nc\r\n", "a b\r\rc\r"}) {
    TextScanner scanner("file", text);
    EXPECT_EQ(scanner.word_in_line(), "a");
    EXPECT_EQ(scanner.word_in_line(), "b");
    EXPECT_EQ(scanner.word_in_line(), std::nullopt);
    EXPECT_EQ(scanner.word(), "c");
    EXPECT_EQ(scanner.line(), 3U) << text;
    EXPECT_FALSE(scanner.next_line());
  }
  TextScanner scanner("file", "usemtl  Curtain Wall \t\r\nf");
  scanner.word_in_line();
  EXPECT_EQ(scanner.remaining_line(), "Curtain Wall");
  EXPECT_TRUE(scanner.next_line());
}

}  // namespace
}  // namespace skycap::geometry

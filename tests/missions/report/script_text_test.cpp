#include "missions/report/script_text.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::missions::report {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

// HTML 13.2.5.4: within a script only "</script" and "<!--" mean anything, and both begin with '<'.
TEST(ScriptJson, CanNeitherEndItsScriptNorOpenAComment) {
  const Json json = {{"name", "</script><!-- \u2028 \u2029 <script>"}, {"</script>", 1}};
  const std::string text = script_json(json);
  EXPECT_THAT(text, Not(HasSubstr("<")));
  EXPECT_THAT(text, Not(HasSubstr("\u2028")));
  EXPECT_THAT(text, Not(HasSubstr("\u2029")));
  EXPECT_EQ(Json::parse(text), json);  // and still says the same
}

TEST(HtmlText, HasNoCharacterThatMeansAnything) {
  EXPECT_EQ(html_text("<a href=\"x\">'&'</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
}

// RFC 4648, section 10.
TEST(Base64, IsTheStandards) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

/// The twin of page/cloud.js, written from the header's words, with a list of bits.
std::string bytes_of_base93(const std::string& text) {
  const auto digit = [](char c) { return static_cast<std::size_t>(c - (c > '<' ? 34 : 33)); };
  std::vector<bool> bits;
  const auto put = [&](std::size_t number, int count) {
    for (int bit = 0; bit < count; ++bit) bits.push_back((number >> bit & 1) != 0);
  };
  std::size_t i = 0;
  for (; i + 1 < text.size(); i += 2) {
    const std::size_t number = digit(text[i]) + 93 * digit(text[i + 1]);
    put(number, number % 8192 < 93 * 93 - 8192 ? 14 : 13);
  }
  if (i < text.size()) put(digit(text[i]), static_cast<int>(8 - bits.size() % 8));
  std::string bytes(bits.size() / 8, '\0');
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] | (bits[bit] ? 1 << bit % 8 : 0));
  }
  return bytes;
}

// Of every length, since the end is the difficult part; all zeros and all ones are the extremes.
TEST(Base93, ReadsBack) {
  std::mt19937_64 random(7);
  for (std::size_t size = 0; size < 300; ++size) {
    std::string noise(size, ' ');
    for (char& c : noise) c = static_cast<char>(random());
    for (const std::string& bytes : {noise, std::string(size, '\0'), std::string(size, '\xff')}) {
      const std::string text = base93(bytes);
      EXPECT_EQ(bytes_of_base93(text), bytes) << size;
      EXPECT_LE(text.size(), (16 * size + 12) / 13 + 1);
      EXPECT_TRUE(std::ranges::all_of(text, [](char c) { return c > ' ' && c < 127 && c != '<'; }));
    }
  }
}

// printf 'alert(1)' | openssl dgst -sha256 -binary | base64
TEST(PolicyHash, IsTheShaOfTheText) {
  EXPECT_EQ(policy_hash("alert(1)"), "'sha256-bhHHL3z2vDgxUt0W3dWQOrprscmda2Y5pLsLg4GF+pI='");
}

}  // namespace
}  // namespace skycap::missions::report

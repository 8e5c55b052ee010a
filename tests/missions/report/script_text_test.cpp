#include "missions/report/script_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::missions::report {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

// HTML 13.2.5.4: within a script only "</script" and "<!--" have a meaning, and both begin with
// '<'.
TEST(ScriptJson, EscapesScriptEndAndComments) {
  const Json json = {{"name", "</script><!-- \u2028 \u2029 <script>"}, {"</script>", 1}};
  const std::string text = script_json(json);
  EXPECT_THAT(text, Not(HasSubstr("<")));
  EXPECT_THAT(text, Not(HasSubstr("\u2028")));
  EXPECT_THAT(text, Not(HasSubstr("\u2029")));
  EXPECT_EQ(Json::parse(text), json);  // the content is unchanged
}

TEST(HtmlText, EscapesSpecialCharacters) {
  EXPECT_EQ(html_text("<a href=\"x\">'&'</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
}

// RFC 4648, section 10.
TEST(Base64, MatchesStandardExamples) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

// printf 'alert(1)' | openssl dgst -sha256 -binary | base64
TEST(PolicyHash, MatchesSha256OfScript) {
  EXPECT_EQ(policy_hash("alert(1)"), "'sha256-bhHHL3z2vDgxUt0W3dWQOrprscmda2Y5pLsLg4GF+pI='");
}

}  // namespace
}  // namespace skycap::missions::report

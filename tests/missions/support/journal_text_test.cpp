#include "missions/support/journal_text.h"

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/version.h"
#include "tests/support/complaint.h"

namespace skycap::missions::support {
namespace {

const Identity run{7, {{"scene.model", "builtin:teapot"}, {"limits.max_views", "12"}}};
const std::string cure = "start again without --resume";

std::string make_identity(const Identity& given) {
  return identity_text(given, {{"format", journal_format}, {"surface", "abc"}});
}

std::string error_message(const std::string& found, const std::string& expected) {
  return testing_support::thrown_message([&] { require_same_survey("j", found, expected, cure); });
}

TEST(JournalIdentity, ContainsVersionSeedAndKeys) {
  const auto json = nlohmann::ordered_json::parse(make_identity(run));
  EXPECT_EQ(json.at("version"), version);
  EXPECT_EQ(json.at("seed"), 7);
  EXPECT_EQ(json.at("format"), journal_format);
  EXPECT_EQ(json.at("limits.max_views"), "12");
  EXPECT_NO_THROW(require_same_survey("j", make_identity(run), make_identity(run), cure));
}

TEST(JournalIdentity, NamesChangedSettings) {
  Identity other = run;
  other.settings[1].value = "13";
  EXPECT_EQ(
      error_message(make_identity(run), make_identity(other)),
      "j: cannot resume: limits.max_views changed from \"12\" to \"13\"; restore it, or " + cure);
}

// Earlier journals count rejected views as unreachable, and have no format entry.
TEST(JournalIdentity, ReportsVersionOfJournalInOtherFormat) {
  const std::string end = ", whose journals cannot be resumed by this version; " + cure;
  EXPECT_EQ(error_message(R"({"version": "0.1.0", "seed": 7})", make_identity(run)),
            "j: was written by version 0.1.0" + end);
  EXPECT_EQ(error_message(R"({"version": "0.1.0", "seed": 7, "format": 2})", make_identity(run)),
            "j: was written by version 0.1.0" + end);
  EXPECT_EQ(error_message(R"({"version": "9.0.0", "seed": 7, "format": 4})", make_identity(run)),
            "j: was written by version 9.0.0" + end);
  EXPECT_EQ(error_message(R"({"version": 3, "seed": 7})", make_identity(run)),
            "j: was written by version (unknown)" + end);
}

// Journals of scans have no format entry.
TEST(JournalIdentity, RequiresFormatOnlyWhenPresent) {
  const std::string identity = identity_text(run, {{"formats", "las"}});
  EXPECT_NO_THROW(require_same_survey("j", identity, identity, cure));
}

TEST(JournalIdentity, RejectsInvalidIdentity) {
  EXPECT_EQ(error_message("[1, 2]", make_identity(run)), "j: is not a journal");
}

}  // namespace
}  // namespace skycap::missions::support

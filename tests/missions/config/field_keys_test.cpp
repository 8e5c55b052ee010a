#include "missions/config/field_keys.h"

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/config/mission_keys.h"
#include "missions/config/resolve.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string read_source(const std::string& source) {
  std::ifstream file(std::filesystem::path(SKYCAP_SOURCE_DIR) / source);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Returns the fields named in the errors of validate() functions: names in quotes, and the first
/// words of sentences.
std::set<std::string> find_fields(const std::string& source) {
  static const std::regex field(R"re("([a-z]+(?:[_.][a-z]+)*)(?:"|(?= (?:is|has|must)\b)))re");
  const std::string text = read_source(source);
  std::set<std::string> fields;
  for (std::sregex_iterator found(text.begin(), text.end(), field), end; found != end; ++found) {
    fields.insert((*found)[1]);
  }
  return fields;
}

/// Quoted words that are not fields, and fields that missions cannot set.
const std::set<std::string> not_from_missions = {
    "continuation_steps",  // constant of the planner
    "noise.table", "stereo.disparity_sigma_px", "stereo.disparity_step_px"  // only in sensor files
};

TEST(FieldKeys, NameExistingMissionKeys) {
  ASSERT_FALSE(config::field_keys.empty());
  for (const config::FieldKey& known : config::field_keys) {
    EXPECT_NE(config::find_key(known.key), nullptr) << known.field << ": " << known.key;
  }
}

TEST(FieldKeys, CoverEveryFieldInLibraryErrors) {
  std::size_t fields = 0;
  for (const char* source :
       {"geometry/pose/camera.cpp", "sim/sensors/depth_camera_config.cpp", "sim/sensors/noise.cpp",
        "survey/view_limits.cpp", "survey/see/see_config.cpp", "survey/surfel/surfel_config.cpp",
        "survey/volumetric/volumetric_config.cpp"}) {
    for (const std::string& field : find_fields(source)) {
      if (not_from_missions.contains(field)) continue;
      EXPECT_NE(config::find_field_key(field), "") << source << " complains of " << field;
      ++fields;
    }
  }
  EXPECT_GE(fields, 40U);
}

TEST(FieldKeys, AddKeyAndLineToErrorMessages) {
  const std::string message = testing_support::thrown_message([] {
    config::parse_mission(
        "scene: {model: 'builtin:teapot'}\nevaluation: {coverage_distance: 0.005}\n"
        "planner:\n  name: skycap\n  ablation: {coverage_model: true}\n  min_gain: 1\n",
        "m.yaml");
  });
  EXPECT_THAT(message, HasSubstr("m.yaml:6: key planner.min_gain is 1; it must be"));
  EXPECT_THAT(message, Not(HasSubstr("stop.min_gain")));
}

}  // namespace
}  // namespace skycap::missions

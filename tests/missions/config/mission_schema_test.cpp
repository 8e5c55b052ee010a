// The key table, the JSON Schema, the reference manual and the shipped missions are consistent.
#include <filesystem>
#include <set>
#include <sstream>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "missions/config/key_sections.h"
#include "missions/config/mission_keys.h"
#include "missions/config/resolve.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/not_empty.h"

namespace skycap::missions {
namespace {

using Json = nlohmann::json;

const std::filesystem::path source = SKYCAP_SOURCE_DIR;

Json shipped_schema() {
  return Json::parse(tests::read_content(source / "missions" / "mission.schema.json"));
}

/// Collects the paths of all properties of a schema except sections.
void collect_paths(const Json& section, const std::string& prefix, std::set<std::string>& paths) {
  for (const auto& [name, property] : section["properties"].items()) {
    if (property.contains("properties")) {
      EXPECT_EQ(property["additionalProperties"], false) << prefix + name;
      collect_paths(property, prefix + name + ".", paths);
    } else {
      paths.insert(prefix + name);
    }
  }
}

const Json& find_property(const Json& schema, const std::string& path) {
  const Json* property = &schema;
  std::istringstream parts(path);
  for (std::string part; std::getline(parts, part, '.');) {
    property = &(*property)["properties"][part];
  }
  return *property;
}

TEST(MissionSchema, HasSameKeysAsReader) {
  std::set<std::string> in_schema, in_reader;
  collect_paths(shipped_schema(), "", in_schema);
  for (const config::Key& key : config::mission_keys()) in_reader.insert(key.path);
  EXPECT_EQ(in_schema, in_reader);
}

TEST(MissionKeys, BelongToTheirSectionAndAreUnique) {
  std::set<std::string> paths;
  for (const config::KeySection& section : config::key_sections) {
    for (const config::Key& key : section.keys()) {
      EXPECT_EQ(key.path.substr(0, key.path.find('.')) == section.name, !section.name.empty())
          << key.path;
      EXPECT_TRUE(paths.insert(key.path).second) << key.path;
    }
  }
  EXPECT_EQ(paths.size(), config::mission_keys().size());
}

// For each key, the reader rejects values outside the limits in the schema.
TEST(MissionSchema, HasSameTypesAndRangesAsReader) {
  const Json schema = shipped_schema();
  for (const config::Key& key : testing_support::not_empty(config::mission_keys())) {
    const Json& property = find_property(schema, key.path);
    const Json& number = key.type == config::KeyType::vector ? property["items"] : property;
    if (key.type == config::KeyType::choice) {
      EXPECT_EQ(property["enum"], Json(key.choices)) << key.path;
    }
    const auto is_rejected = [&](const std::string& value) {
      const std::string text = key.type == config::KeyType::vector
                                   ? "[" + value + ", " + value + ", " + value + "]"
                                   : value;
      try {
        config::parse_mission("seed: 1", "m", {{"--set", key.path, text}});
      } catch (const Error& error) {
        return std::string(error.what()).find("; it must be ") != std::string::npos &&
               std::string(error.what()).starts_with("--set: key " + key.path + " ");
      }
      return false;
    };
    const auto beyond = [](double limit, double sign) {
      return std::to_string(limit + sign * std::max(1.0, 1e-3 * std::abs(limit)));
    };
    for (const char* min : {"minimum", "exclusiveMinimum"}) {
      if (!number.contains(min)) continue;
      EXPECT_TRUE(is_rejected(std::to_string(static_cast<long long>(number[min]) - 1))) << key.path;
    }
    if (number.contains("exclusiveMinimum")) {
      EXPECT_TRUE(is_rejected("0")) << key.path;
    }
    if (number.contains("maximum")) {
      EXPECT_TRUE(is_rejected(beyond(number["maximum"], 1.0))) << key.path;
    }
    EXPECT_TRUE(is_rejected("{a: 1}")) << key.path;
  }
}

TEST(MissionSchema, MatchesShippedFile) {
  EXPECT_EQ(tests::read_content(source / "missions" / "mission.schema.json"),
            config::mission_json_schema())
      << "run: build/release/skycap check --schema > missions/mission.schema.json";
}

/// Returns the rows of a key table in any order, because the page groups them by section.
std::multiset<std::string> key_rows(const std::string& text) {
  std::multiset<std::string> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("| `")) rows.insert(line);
  }
  return rows;
}

/// Returns the generated parts of a page (docs/generate_reference.py).
std::string generated_parts(const std::string& page) {
  std::string parts;
  for (auto begin = page.find("<!-- generated: "); begin != std::string::npos;
       begin = page.find("<!-- generated: ", begin + 1)) {
    parts += page.substr(begin, page.find("<!-- end of generated -->", begin) - begin);
  }
  return parts;
}

TEST(MissionReference, ListsEveryKeyAsPrintedByProgram) {
  const std::filesystem::path page = source / "docs" / "reference" / "mission-file.md";
  const auto printed = key_rows(config::mission_key_table());
  EXPECT_GE(printed.size(), config::mission_keys().size());
  EXPECT_EQ(key_rows(generated_parts(tests::read_content(page))), printed)
      << "run: docs/generate_reference.py --program build/release";
}

TEST(ShippedMissions, AreValid) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source / "missions")) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_NO_THROW(config::read_mission(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 4U);
}

const survey::see::SeeConfig& see_config(const config::MissionSetup& setup) {
  return std::get<survey::see::SeeConfig>(setup.survey().planner.method);
}

// Table 1 and section IV of the paper.
TEST(ShippedMissions, HaveParametersOfPaper) {
  for (const char* name : {"teapot", "bunny", "dragon"}) {
    const config::MissionSetup mission =
        config::read_mission(source / "missions" / (std::string(name) + ".yaml"));
    EXPECT_EQ(see_config(mission).density, 146'000.0);
    EXPECT_EQ(see_config(mission).resolution_radius, 0.017);
    EXPECT_EQ(see_config(mission).effective_core_threshold(), 4);
    EXPECT_EQ(mission.evaluation().registration_distance, 0.005);
    EXPECT_EQ(mission.scene().longest_side, 1.0);
  }
  const config::MissionSetup radcliffe =
      config::read_mission(source / "missions" / "radcliffe_camera.yaml");
  EXPECT_EQ(see_config(radcliffe).density, 213.0);
  EXPECT_EQ(see_config(radcliffe).resolution_radius, 0.15);
  EXPECT_EQ(radcliffe.sensor().camera.camera.width, 2400);
  EXPECT_EQ(radcliffe.evaluation().registration_distance, 0.05);
  const config::MissionSetup published = config::read_mission(
      source / "missions" / "radcliffe_camera.yaml", {{"--set", "planner.preset", "paper"}});
  EXPECT_EQ(see_config(published).occlusion_search_distance, 1.0);
  EXPECT_EQ(see_config(published).visibility_update_limit, 100U);
}

}  // namespace
}  // namespace skycap::missions

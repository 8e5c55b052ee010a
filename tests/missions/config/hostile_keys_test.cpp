// Wrong, extreme and malicious values for each key in the key table. Each value is rejected in one
// line with file, line and key, or accepted within the key's range.
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/config/mission_keys.h"
#include "missions/config/resolve.h"
#include "missions/support/number_text.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using config::Key;
using config::KeyType;

/// Values by key, as text of a mission file.
using Values = std::map<std::string, std::string>;

/// Returns the mission file: sections are maps, and each key has its own line.
std::string mission_text(const Values& values) {
  std::string text;
  std::vector<std::string> open;  // names of the open sections
  for (const auto& [path, value] : values) {
    std::vector<std::string> parts;
    std::istringstream stream(path);
    for (std::string part; std::getline(stream, part, '.');) parts.push_back(part);
    std::size_t shared = 0;
    while (shared < open.size() && shared + 1 < parts.size() && open[shared] == parts[shared]) {
      ++shared;
    }
    open.resize(shared);
    for (; open.size() + 1 < parts.size(); open.push_back(parts[open.size()])) {
      text += std::string(2 * open.size(), ' ') + parts[open.size()] + ":\n";
    }
    text += std::string(2 * open.size(), ' ') + parts.back() + ": " + value + "\n";
  }
  return text;
}

/// Returns the other keys that a key requires.
Values around(const Key& key) {
  Values values{{"scene.model", "builtin:teapot"}, {"evaluation.coverage_distance", "0.03"}};
  if (key.path.starts_with("flight.")) {
    values["flight.vehicle"] = "generic";
    values["flight.unknown_box.min"] = "[-20, -20, 0]";
    values["flight.unknown_box.max"] = "[20, 20, 20]";
  }
  if (key.path.starts_with("volumetric.")) values["planner.name"] = "rsv";
  return values;
}

/// Values that are invalid for all keys, or valid for strings only.
const std::vector<std::string> hostile = {
    "",
    "~",
    "nan",
    ".nan",
    "inf",
    "-.inf",
    "1e999",
    "-1e999",
    "0x10",
    "1_000",
    "1,5",
    "1e",
    "--1",
    "'1'",
    "\"\"",
    "\"\\e[2J\"",
    "\"a\\nb\"",
    "\"`touch pwned`$(touch pwned)\"",
    "{}",
    "[]",
    "{a: 1}",
    "[[[[[[[[1]]]]]]]]",
    "[1, 2]",
    "[nan, nan, nan]",
    "[1e999, 0, 0]",
    "['1', '2', '3']",
    "[1, 2, 3, 4]",
    "*x",
    "&x 1",
    "!!int 1",
    "<<",
    "yes",
    "True",
    "../../etc/passwd",
    "/dev/zero",
    "builtin:",
    "model:../x",
    "9223372036854775808",
    "-9223372036854775809",
    "1.5",
    "-0",
    "[[0, 0]]",
    "[{corners: [[0, 0], [1, 0], [1, 1]], floor: 0, ceiling: nan}]",
    "[[1e999, 0], [1, 0], [1, 1]]",
    "[{corners: [], floor: 0, ceiling: 1}]",
    std::string(70'000, 'x'),
    "[" + std::string(30'000, '[')};

std::vector<std::string> numbers_about(const config::KeyRange& range) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::vector<std::string> texts;
  for (const double edge : {range.min, range.max}) {
    for (const double number : {edge, std::nextafter(edge, -inf), std::nextafter(edge, inf),
                                std::round(edge), std::round(edge) - 1.0, std::round(edge) + 1.0}) {
      if (std::isfinite(number)) texts.push_back(support::exact_text(number));
    }
  }
  for (const double number : {0.0, 1e-320, 1e-300, 1e-9, 1.0, 1e9, 1e15, 1e300, 1.7e308}) {
    texts.push_back(support::exact_text(number));
    texts.push_back(support::exact_text(-number));
  }
  return texts;
}

std::vector<std::string> values_for(const Key& key) {
  std::vector<std::string> values = hostile;
  const std::vector<std::string> numbers = numbers_about(key.range);
  if (key.type == KeyType::number || key.type == KeyType::integer) {
    values.insert(values.end(), numbers.begin(), numbers.end());
  }
  if (key.type == KeyType::vector) {
    for (const std::string& number : numbers) {
      values.push_back("[" + number + ", " + number + ", " + number + "]");
      values.push_back("[0, " + number + ", 1]");
    }
  }
  values.insert(values.end(), key.choices.begin(), key.choices.end());
  return values;
}

bool is_key_error(const std::string& message) {
  const std::string file = "m.yaml:";
  if (!message.starts_with(file)) return false;
  const std::size_t digits = message.find_first_not_of("0123456789", file.size());
  if (digits == file.size() || message.substr(digits, 2) != ": ") return false;
  const std::string what = message.substr(digits + 2);
  const bool is_yaml_error = what.starts_with("is not valid YAML") || what.starts_with("anchors") ||
                             what.starts_with("aliases") || what.starts_with("tags") ||
                             what.starts_with("lists and maps are nested more");
  if (is_yaml_error) return true;
  if (!what.starts_with("key ")) return false;
  const std::string named = what.substr(4, what.find_first_of(" :", 4) - 4);
  return config::find_key(named) != nullptr || named.find_first_of(".[") != std::string::npos;
}

/// Checks that an accepted number is finite and within the key's range, up to the rounding of
/// degrees.
void expect_in_range(const Key& key, double number, const std::string& value) {
  const double slack = 1e-12 * std::abs(number);
  EXPECT_TRUE(number >= key.range.min - slack && number <= key.range.max + slack)
      << key.path << ": " << value.substr(0, 60) << " is taken as " << number;
}

void expect_sane(const config::MissionDocument& document, const std::string& value) {
  for (const Key& key : config::mission_keys()) {
    const auto taken = key.get(document);
    if (!taken) continue;
    if (const auto* number = std::get_if<double>(&*taken)) expect_in_range(key, *number, value);
    if (const auto* vector = std::get_if<Eigen::Vector3d>(&*taken)) {
      for (const double coordinate : *vector) expect_in_range(key, coordinate, value);
    }
  }
}

/// Returns true if the values are accepted. The test fails if a value outside its range is
/// accepted, or if the error is not one line with a key. `what` describes the values in failures.
bool are_accepted(const Values& values, const std::string& what) {
  try {
    expect_sane(*config::parse_mission(mission_text(values), "m.yaml").document, what);
    return true;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_TRUE(is_key_error(message)) << what << " is refused by " << message.substr(0, 300);
    EXPECT_LT(message.size(), 2000U) << what;
    EXPECT_EQ(message.find_first_of("\n\x1b"), std::string::npos) << what;
    return false;
  }
}

TEST(HostileKeys, AreRejectedByNameOrAcceptedWithinRange) {
  std::size_t rejected = 0, taken = 0;
  for (const Key& key : config::mission_keys()) {
    for (const std::string& value : values_for(key)) {
      Values values = around(key);
      values[key.path] = value;
      ++(are_accepted(values, key.path + ": " + value.substr(0, 60)) ? taken : rejected);
    }
  }
  EXPECT_GT(rejected, 5000U);
  EXPECT_GT(taken, 500U);
}

std::string number_drawn(std::mt19937& random) {
  const double exponent = std::uniform_real_distribution<double>(-12.0, 12.0)(random);
  return support::exact_text((random() % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, exponent));
}

// Random combinations with numbers of all magnitudes. HOSTILE_SEED and HOSTILE_MISSIONS in the
// environment set the seed and the number of missions.
TEST(HostileKeys, AreRejectedOrAcceptedInRandomCombinations) {
  const char *seed = std::getenv("HOSTILE_SEED"), *missions = std::getenv("HOSTILE_MISSIONS");
  std::mt19937 random(seed == nullptr ? 1U : static_cast<unsigned>(std::stoul(seed)));
  const auto& keys = config::mission_keys();
  for (std::size_t i = missions == nullptr ? 2000 : std::stoul(missions); i > 0; --i) {
    Values values;
    std::string what;
    for (std::size_t drawn = 1 + random() % 4; drawn > 0; --drawn) {
      const Key& key = keys[random() % keys.size()];
      const std::vector<std::string> known = values_for(key);
      values.merge(around(key));
      values[key.path] = random() % 2 == 0 ? number_drawn(random) : known[random() % known.size()];
      what += key.path + ": " + values[key.path].substr(0, 60) + "; ";
    }
    are_accepted(values, what);
  }
}

TEST(HostileKeys, AreNotMistakenForOtherKeys) {
  for (const std::string name :
       {"__proto__", "scene", "planner.densty", "a.b.c.d", "Name", "name "}) {
    try {
      config::parse_mission(mission_text({{"scene.model", "builtin:teapot"},
                                          {"evaluation.coverage_distance", "0.03"},
                                          {name, "1"}}),
                            "m.yaml");
      if (name != "name ") ADD_FAILURE() << name << " is taken";
    } catch (const Error& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("m.yaml:")) << error.what();
    }
  }
}

TEST(HostileKeys, AreRejectedQuicklyWhenManyOrLong) {
  const std::string base = "scene: {model: 'builtin:teapot'}\n";
  std::string many = base;
  for (int i = 0; i < 90'000; ++i) many += "k" + std::to_string(i) + ": 1\n";
  EXPECT_THAT(testing_support::thrown_message([&] { config::parse_mission(many, "m.yaml"); }),
              testing::HasSubstr("m.yaml:"));
  EXPECT_THAT(testing_support::thrown_message([&] {
                config::parse_mission(base + "? " + std::string(900'000, 'k') + "\n: 1\n",
                                      "m.yaml");
              }),
              testing::HasSubstr("m.yaml:"));
}

}  // namespace
}  // namespace skycap::missions

// Input errors: each must give exit code 2, a one-line message with a remedy, and no results.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using tests::TestFolder;

/// A mission or mesh with one error, and the expected message. MISSION and FOLDER in the message
/// stand for the mission file and its folder.
struct BadInput {
  const char* name;
  std::string mission;
  std::string message;
  std::string mesh_name = {};  ///< mesh file in the same folder
  std::string mesh = {};
  std::vector<std::string> arguments = {};  ///< after "plan MISSION --out OUT"
};

// NOLINTNEXTLINE(readability-identifier-naming): gtest looks for it
void PrintTo(const BadInput& input, std::ostream* stream) { *stream << input.name; }

const std::string model = "scene: {model: 'builtin:teapot'}\n";
const std::string evaluated = "evaluation: {coverage_distance: 0.005}\n";
const std::string whole = model + evaluated;  // lines 1 and 2

std::string with_mesh(const std::string& file) {
  return "scene: {model: " + file + "}\n" + evaluated;
}

/// Returns a flight section in one line.
const std::string around = "min: [-20, -20, 0], max: [20, 20, 20]";
std::string flight_mission(const std::string& box, const std::string& more = "hold: 1") {
  return "flight: {vehicle: generic, unknown_box: {" + box + "}, " + more + "}\n";
}

std::vector<BadInput> bad_inputs() {
  return {
      {"EmptyFile", "", "MISSION:1: is empty; a mission requires at least scene.model"},
      {"OnlyAComment", "# later\n", "MISSION:1: is empty"},
      {"NotAMap", "- a\n- b\n",
       "MISSION:1: is not a map; a mission must consist of 'key: value' lines"},
      {"BrokenYaml", "scene: {model: x\n", "is not valid YAML"},
      {"TabIndent", "scene:\n\tmodel: x\n", "MISSION:2: is not valid YAML"},
      {"TwoDocuments", whole + "---\n" + whole, "contains more than one YAML document"},
      {"DetailOfAFile", "scene: {model: a.ply, detail: fine}\n" + evaluated,
       "MISSION:1: key scene.detail requires a builtin model; a.ply has a fixed level of detail"},
      {"DuplicateKey", whole + "seed: 1\nseed: 2\n",
       "MISSION:4: key seed is set twice, first in line 3; keep one"},
      {"Alias", "a: &x 1\nb: *x\n", "MISSION:1: anchors ('&name') are not supported"},
      {"AliasBomb", "a: &a [1,1]\nb: &b [*a,*a]\nc: [*b,*b]\n", "MISSION:1: anchors"},
      {"Tag", whole + "seed: !!int 3\n", "MISSION:3: tags"},
      {"BinaryFile",
       std::string("\x7f"
                   "ELF\0\0",
                   6),
       "MISSION: contains binary data; expected a mission file"},
      {"HugeFile", std::string((1 << 20) + 1, '#'), "MISSION: is larger than 1 MiB"},
      {"MissingModel", evaluated, "MISSION:1: key scene.model is missing; set a model"},
      {"MissingDistance", model,
       "MISSION:1: key evaluation.coverage_distance is missing; it must be a number from "
       "1e-06"},
      {"MisspeltKey", whole + "planner:\n  densty: 3\n",
       "MISSION:4: key planner.densty is unknown; did you mean planner.density?"},
      {"MisspeltSection", whole + "planer: {density: 3}\n", "MISSION:3: key planer is unknown"},
      {"UnknownKey", whole + "planner: {character: good}\n",
       "MISSION:3: key planner.character is unknown; expected one of: planner.name, "
       "planner.file, planner.preset"},
      {"SectionIsNumber", whole + "planner: 3\n", "MISSION:3: key planner is a section"},
      {"TextForNumber", whole + "planner: {density: lots}\n",
       "MISSION:3: key planner.density is lots; it must be a number above 0"},
      {"QuotedNumber", whole + "planner: {density: '100'}\n",
       "key planner.density is the string '100'; it must be a number"},
      {"NoValue", whole + "planner:\n  density:\n",
       "MISSION:4: key planner.density has no value; it must be a number above 0"},
      {"NotANumber", whole + "planner: {density: nan}\n", "key planner.density is nan; it must be"},
      {"Infinite", whole + "planner: {density: .inf}\n", "key planner.density is .inf; it must be"},
      {"OverflowingNumber", whole + "planner: {density: 1e999}\n", "is 1e999; it must be"},
      {"FractionForInteger", whole + "seed: 1.5\n",
       "MISSION:3: key seed is 1.5; it must be an integer from 0 to 1e+15"},
      {"NegativeSeed", whole + "seed: -1\n", "key seed is -1; it must be an integer"},
      {"ListForNumber", whole + "seed: [1]\n", "key seed is a list; it must be an integer"},
      {"YesForBoolean", whole + "planner: {facing_test: yes}\n",
       "key planner.facing_test is yes; it must be true or false"},
      {"UnknownChoice", whole + "planner: {name: psychic}\n",
       "MISSION:3: key planner.name is psychic; it must be see++, see, skycap, "},
      {"ShortVector", whole + "start: {position: [1, 2]}\n",
       "key start.position is a list; it must be a list of three numbers"},
      {"AngleTooWide", whole + "sensor: {horizontal_fov_deg: 180}\n",
       "key sensor.horizontal_fov_deg is 180; it must be a number from 0.1 to 179 [degrees]"},
      {"HugeImage", whole + "sensor: {width: 32768, height: 32768}\n",
       "key sensor.width: the image has more than 100 million pixels"},
      {"EmptyRange", whole + "sensor: {min_range: 5, max_range: 4}\n",
       "MISSION:3: key sensor.max_range must be greater than sensor.min_range"},
      {"TwoScales", "scene: {model: 'builtin:teapot', scale: 2, longest_side: 1}\n" + evaluated,
       "MISSION:1: key scene.scale conflicts with scene.longest_side"},
      {"GroundWithoutBox", "scene: {model: 'builtin:teapot', ground: true}\n" + evaluated,
       "key scene.ground requires planner.scene_box"},
      {"NeighboursWithoutAPrior",
       "scene: {model: 'builtin:teapot', neighbours: true}\n" + evaluated,
       "key scene.neighbours requires prior data with role: obstacle"},
      {"EmptyBox", whole + "planner: {scene_box: {min: [0, 0, 0], max: [1, 0, 1]}}\n",
       "key planner.scene_box.max must be greater than planner.scene_box.min"},
      {"StartWithoutAim", whole + "start: {position: [0, 3, 0]}\n",
       "MISSION:3: key start.position requires either start.look_at or start.direction"},
      {"AimWithoutStart", whole + "start: {look_at: [0, 3, 0]}\n",
       "key start.look_at requires start.position"},
      {"NoDirection", whole + "start: {position: [0, 3, 0], direction: [0, 0, 0]}\n",
       "key start.direction must not have zero length"},
      {"NameWithSlash", whole + "name: ../elsewhere\n",
       "MISSION:3: key name: invalid name ../elsewhere"},
      {"NoFrontierPossible", whole + "planner:\n  density: 1000\n  resolution_radius: 0.05\n",
       "with which no point can be a frontier"},
      {"CoreThresholdOf3", whole + "planner: {core_threshold: 3}\n",
       "MISSION:3: key planner.core_threshold is 3; it must be at least 4"},
      {"SpacingAboveRadius", whole + "planner:\n  spacing: 0.5\n",
       "MISSION:4: key planner.spacing is 0.5; it must be less than planner.resolution_radius"},
      {"UnknownBuiltin", "scene: {model: 'builtin:kettle'}\n" + evaluated, "kettle"},
      {"UnknownModel", "scene: {model: 'model:kettle'}\n" + evaluated,
       "model:kettle is not in $SKYCAP_MODELS"},
      {"MissingMesh", with_mesh("none.ply"), "FOLDER/none.ply: "},
      {"UnknownFormat", with_mesh("m.3ds"), "FOLDER/m.3ds: ", "m.3ds", "x"},
      {"EmptyMesh", with_mesh("m.ply"), "FOLDER/m.ply: is empty", "m.ply", ""},
      {"BrokenMesh", with_mesh("m.ply"), "FOLDER/m.ply", "m.ply", "ply\nformat ascii 1.0\nelem"},
      {"HugeIndex", with_mesh("m.off"), "FOLDER/m.off", "m.off",
       "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 4000000000\n"},
      {"HugeCount", with_mesh("m.ply"), "FOLDER/m.ply", "m.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
       "property float y\nproperty float z\nelement face 4000000000\n"
       "property list uchar int vertex_indices\nend_header\n"},
      {"NanVertex", with_mesh("m.off"), "FOLDER/m.off", "m.off",
       "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"NoFaces", with_mesh("m.off"), "FOLDER/m.off", "m.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"},
      {"NoArea", with_mesh("m.off"), "FOLDER/m.off", "m.off",
       "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n"},
      {"EmptyFirstScan", model + "start: {position: [9, 0, 0], direction: [1, 0, 0]}\n" + evaluated,
       "MISSION: the first scan contains no point of the scene; start from a view that sees it"},
      {"FlightWithoutABox", whole + "flight: {vehicle: generic}\n",
       "MISSION:3: key flight.vehicle requires flight.unknown_box"},
      {"UnknownVehicle", whole + "flight: {vehicle: kite}\n",
       "MISSION:3: key flight.vehicle: unknown vehicle kite; expected one of: air_2s, "},
      {"NoVehicleFile", whole + "flight: {vehicle: kite.yaml}\n", "kite.yaml"},
      {"EmptyUnknownBox", whole + flight_mission("min: [0, 0, 0], max: [0, 1, 1]"),
       "key flight.unknown_box.max must be greater than flight.unknown_box.min"},
      {"HalfABoxBeside", whole + flight_mission(around, "extra_unknown_boxes: [[0, 0, 0]]"),
       "key flight.extra_unknown_boxes has 1 corners; list the lower and the upper corner of each "
       "box"},
      {"EmptyBoxBeside",
       whole + flight_mission(around, "extra_unknown_boxes: [[0, 0, 0], [1, 1, 0]]"),
       "key flight.extra_unknown_boxes: an upper corner must be greater than its lower corner"},
      {"ClearanceBelowItsTerms", whole + flight_mission(around, "clearance: 0.5"),
       "MISSION:3: key flight.clearance must be at least the sum of the vehicle's radius (0.5 m) "
       "and the position, tracking and map errors: 1 m"},
      {"MapErrorBelowTheNoise",
       whole + flight_mission(around, "map_error: 0.2") + "sensor: {noise: {sigma: 0.1}}\n",
       "MISSION:3: key flight.map_error must be at least three standard deviations of the sensor "
       "noise: 0.3 m"},
      {"ClimbBelowTheClearance", whole + flight_mission(around, "takeoff_climb: 1"),
       "MISSION:3: key flight.takeoff_climb: a climb of 1 m ends within the clearance of the "
       "ground"},
      {"RallyOfADji",
       whole + "flight: {vehicle: m350_rtk, unknown_box: {" + around + "}, rally: [[30, 0, 0]]}\n",
       "MISSION:3: key flight.rally conflicts with flight.vehicle m350_rtk: DJI vehicles return to "
       "their take-off point only"},
      {"TooMuchWind", whole + flight_mission(around, "wind_speed: 40"),
       "MISSION:3: key flight.wind_speed must be less than the maximum wind of 10 m/s"},
      {"HalfAPlace", whole + "site: {longitude_deg: 3}\n",
       "MISSION:3: key site.longitude_deg: incomplete georeference"},
      {"FirstViewInTheBuilding",
       whole + flight_mission(around) + "start: {position: [1, 1, 9], look_at: [0, 0, 0]}\n",
       "MISSION: the first view at (1, 1, 9) is 0 m from unobserved space"},
      {"FirstViewTooNear",
       whole + flight_mission(around) + "start: {position: [0, -21, 9], look_at: [0, 0, 0]}\n",
       "MISSION: the first view at (0, -21, 9) is 1 m from unobserved space, with a clearance of 2 "
       "m"},
      {"PadInTheBuilding",
       whole + flight_mission(around, "takeoff: [3, 0, 0]") +
           "start: {position: [0, -25, 9], look_at: [0, 0, 0]}\n",
       "MISSION: the end of the take-off climb at (3, 0, 5) is 0 m from unobserved space"},
      {"NoRoomAboveTheGround", whole + "limits: {ground_clearance: 1000}\n",
       "no random start view at the view distance"},
      {"NowhereOutsideTheUnknownBox",
       whole + flight_mission("min: [-99, -99, 0], max: [99, 99, 99]"),
       "no random start view at the view distance"},
      {"BadOption", whole, "--seed: key seed is x; it must be an integer", "", "", {"--seed", "x"}},
      {"UnknownOption", whole, "--sede", "", "", {"--sede", "1"}},
      {"BadSet", whole, "--set seed: missing '='", "", "", {"--set", "seed"}},
      {"ZeroTrials", whole, "--trials", "", "", {"--trials", "0"}},
      {"UnwritableOutput",
       whole,
       "/proc/results: cannot be created",
       "",
       "",
       {"--out", "/proc/results"}},
  };
}

class Program : public testing::TestWithParam<BadInput> {};

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
}

TEST_P(Program, RejectsBadInputWithOneLineAndNoOutput) {
  const BadInput& input = GetParam();
  const TestFolder folder;
  const std::string mission = folder.write("mission.yaml", input.mission);
  if (!input.mesh_name.empty()) folder.write(input.mesh_name, input.mesh);
  std::vector<std::string> arguments{"plan", mission};
  if (std::ranges::find(input.arguments, "--out") == input.arguments.end()) {
    arguments.insert(arguments.end(), {"--out", folder / "out"});
  }
  arguments.insert(arguments.end(), input.arguments.begin(), input.arguments.end());

  const auto run = tests::run_skycap(arguments);

  EXPECT_EQ(run.exit_code, 2);
  std::string message = input.message;
  replace_all(message, "MISSION", mission);
  replace_all(message, "FOLDER", folder.path().string());
  EXPECT_THAT(run.err, testing::StartsWith("skycap: error: "));
  EXPECT_THAT(run.err, HasSubstr(message));
  EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
  EXPECT_EQ(run.err.back(), '\n');
  EXPECT_EQ(run.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

INSTANTIATE_TEST_SUITE_P(BadInput, Program, testing::ValuesIn(bad_inputs()),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(ProgramUsage, RejectsUnknownCommands) {
  const auto run = tests::run_skycap({"soar"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err,
              StartsWith("skycap: error: unknown command 'soar'; expected one of: plan, "));
}

TEST(ProgramUsage, SuggestsCommandsAndOptions) {
  const auto error = [](const std::vector<std::string>& arguments) {
    const auto run = tests::run_skycap(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments.front();
    return run.err;
  };
  EXPECT_EQ(error({"paln", "m.yaml"}),
            "skycap: error: unknown command 'paln'; did you mean 'plan'?\n");
  EXPECT_EQ(error({"help"}), "skycap: error: unknown command 'help'; did you mean '--help'?\n");
  EXPECT_EQ(error({"plan", "m.yaml", "--max-veiws=3"}),
            "skycap: error: unknown option '--max-veiws'; did you mean '--max-views'?\n");
  EXPECT_EQ(error({"plan", "m.yaml", "--progres", "none"}),
            "skycap: error: unknown option '--progres'; did you mean '--progress'?\n");
  EXPECT_EQ(error({"plan", "m.yaml", "--altitude", "3"}),
            "skycap: error: unknown option '--altitude'; see --help\n");
}

TEST(ProgramUsage, RejectsMissingArguments) {
  EXPECT_EQ(tests::run_skycap({}).exit_code, 2);
  EXPECT_EQ(tests::run_skycap({"plan"}).exit_code, 2);
  EXPECT_EQ(tests::run_skycap({"check"}).exit_code, 2);
  EXPECT_EQ(tests::run_skycap({"evaluate"}).exit_code, 2);
  EXPECT_EQ(tests::run_skycap({"model"}).exit_code, 2);
}

TEST(ProgramUsage, PrintsHelpAndVersion) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--help"},
                                             {"plan", "--help"},
                                             {"check", "--help"},
                                             {"evaluate", "--help"},
                                             {"model", "--help"}}) {
    const auto run = tests::run_skycap(arguments);
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_THAT(run.out, HasSubstr("Usage: skycap"));
    EXPECT_EQ(run.err, "");
  }
  EXPECT_THAT(tests::run_skycap({"--version"}).out, testing::StartsWith("skycap 0."));
}

TEST(ProgramUsage, ReportsMissingMissionsAndClouds) {
  EXPECT_THAT(tests::run_skycap({"plan", "/nowhere/m.yaml"}).err,
              HasSubstr("/nowhere/m.yaml: cannot be read (No such file or directory)"));
  EXPECT_THAT(tests::run_skycap({"check", "/proc"}).err, HasSubstr("/proc: is a folder"));
  const auto run = tests::run_skycap(
      {"evaluate", "--cloud", "/nowhere/c.ply", "--model", "builtin:teapot", "--distance", "1"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("/nowhere/c.ply"));
}

TEST(ProgramUsage, RequiresDistanceForEvaluateWithoutMission) {
  const TestFolder folder;
  const std::string cloud = folder.write("c.xyz", "0 0 0\n1 1 1\n");
  const auto run = tests::run_skycap({"evaluate", "--cloud", cloud, "--model", "builtin:teapot"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("missing argument: --distance"));
}

}  // namespace
}  // namespace skycap::missions

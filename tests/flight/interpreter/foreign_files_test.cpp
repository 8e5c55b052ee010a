// Route files of other programs are interpreted like Skycap's files, or rejected for the right
// reason.
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zip.h>

#include "flight/export/parameters.h"
#include "flight/interpreter/mission_interpreter.h"
#include "flight/interpreter/wpml_interpreter.h"
#include "geometry/error.h"
#include "tests/flight/interpreter/spoiled.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// Replaces all occurrences of `from`.
std::string all_replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t count = 0;
  for (std::size_t i = 0; (i = text.find(from, i)) != std::string::npos; i += to.size()) {
    text.replace(i, from.size(), to);
    ++count;
  }
  EXPECT_GT(count, 0U) << "nothing to replace: " << from;
  return text;
}

/// Replaces the line with this number, counted from 1.
std::string with_line(const std::string& text, std::size_t number, const std::string& line) {
  std::vector<std::string> lines = split_lines(text);
  lines.at(number - 1) = line;
  std::string result;
  for (const std::string& one : lines) result += one + "\n";
  return result;
}

const std::string& our_waypoints() {
  static const std::string text =
      write_waypoints(sample_plan(vehicle_profile("generic_ardupilot")));
  return text;
}

void expect_same_flight(const InterpretedRoute& route, const InterpretedRoute& expected) {
  EXPECT_THAT(find_problems(route), IsEmpty());
  ASSERT_FALSE(expected.segments.empty());
  ASSERT_EQ(route.segments.size(), expected.segments.size());
  for (std::size_t i = 0; i < route.segments.size(); ++i) {
    EXPECT_LT((route.segments[i].to - expected.segments[i].to).norm(), 1e-6) << "piece " << i;
  }
  EXPECT_EQ(route.stops.size(), expected.stops.size());
}

struct WaypointsCase {
  const char* name;
  std::string text;
};

class ForeignWaypointsFiles : public testing::TestWithParam<WaypointsCase> {};

TEST_P(ForeignWaypointsFiles, AreInterpretedLikeExportedFiles) {
  const FlightFacts facts = sample_facts(AutopilotType::ardupilot);
  const InterpretedRoute route = interpret(read_waypoints(GetParam().text), facts);
  expect_same_flight(route, interpret(read_waypoints(our_waypoints()), facts));
}

std::vector<WaypointsCase> waypoints_cases() {
  const std::string& good = our_waypoints();
  const auto home = [&](const char* line) { return with_line(good, 2, line); };
  const std::string land = split_lines(good).back();
  const std::string nowhere = split(land, '\t')[0] + "\t0\t3\t21\t0\t0\t0\t0\t0\t0\t0\t1";
  return {
      {"mission_planners_unknown_home", home("0\t1\t0\t0\t0\t0\t0\t0\t0\t0\t0\t1")},
      {"home_without_a_place", home("0\t1\t0\t16\t0\t0\t0\t0\t0\t0\t0\t1")},
      {"relative_home_without_a_place", home("0\t0\t3\t16\t0\t0\t0\t0\t0\t0\t0\t1")},
      {"blank_line_at_the_end", good + "\n"},
      {"blank_lines_between", all_replaced(good, "\n", "\n\n")},
      {"comment", all_replaced(good, "WPL 110\n", "WPL 110\n# by hand\n")},
      {"blanks_between_columns", all_replaced(good, "\t", "  ")},
      {"tab_at_the_end_of_lines", all_replaced(good, "\n", "\t\n")},
      {"apm_planners_version", all_replaced(good, "WPL 110", "WPL 120")},
      {"blank_after_the_header", all_replaced(good, "WPL 110", "WPL 110 ")},
      {"byte_order_mark", "\xEF\xBB\xBF" + good},
      {"carriage_returns", all_replaced(good, "\n", "\r")},
      {"windows_line_ends", all_replaced(good, "\n", "\r\n")},
      {"none_is_current", all_replaced(good, "\n0\t1\t", "\n0\t0\t")},
      {"landing_without_a_place", with_line(good, split_lines(good).size(), nowhere)},
      {"take_off_without_a_place", with_line(good, 3,
                                             "1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t" +
                                                 split(split_lines(good)[2], '\t')[10] + "\t1")},
  };
}

INSTANTIATE_TEST_SUITE_P(Interpreter, ForeignWaypointsFiles, testing::ValuesIn(waypoints_cases()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(RejectedWaypointsFiles, NameTheCause) {
  const auto error_message = [](const std::string& text) {
    return testing_support::thrown_message([&] { read_waypoints(text); });
  };
  EXPECT_THAT(error_message(all_replaced(our_waypoints(), "WPL 110", "WPL 100")),
              HasSubstr("line 1 has version 100, whose columns are in a different order; save the "
                        "mission as QGC WPL 110"));
  EXPECT_THAT(error_message("1,2,3\n"), HasSubstr("line 1 must be \"QGC WPL 110\""));
  EXPECT_THAT(error_message(with_line(our_waypoints(), 4, "2 0 3")),
              HasSubstr("line 4 has 3 fields separated by tabs or blanks; it must have 12"));
}

// PX4 uses a position of zeros literally.
TEST(RejectedWaypointsFiles, IncludePx4LandingsWithoutPosition) {
  MavlinkMission file = sample_file(AutopilotType::px4);
  file.items.back().params[4] = file.items.back().params[5] = 0.0;
  EXPECT_THAT(find_problems(file, AutopilotType::px4), Contains(HasSubstr("has no position")));
}

// ---- .plan -----------------------------------------------------------------------------------

json our_plan() { return json::parse(write_plan(sample_plan(vehicle_profile("generic")))); }

struct PlanCase {
  const char* name;
  std::function<void(json&)> change;
};

class ForeignPlanFiles : public testing::TestWithParam<PlanCase> {};

TEST_P(ForeignPlanFiles, AreInterpretedLikeExportedFiles) {
  // The fence rules are tested elsewhere. A file without a fence violates them.
  FlightFacts facts = sample_facts(AutopilotType::px4);
  facts.no_fly.clear(), facts.fence.reset();
  json plan = our_plan();
  plan["geoFence"]["polygons"] = json::array();
  const InterpretedRoute expected = interpret(read_plan(plan.dump()), facts);
  GetParam().change(plan);
  expect_same_flight(interpret(read_plan(plan.dump()), facts), expected);
}

void each_item(json& plan, const std::function<void(json&)>& change) {
  for (json& item : plan["mission"]["items"]) change(item);
}

void split_position(json& item) {
  item["coordinate"] = {item["params"][4], item["params"][5], item["params"][6]};
  item["params"].erase(item["params"].begin() + 4, item["params"].end());
}

INSTANTIATE_TEST_SUITE_P(
    Interpreter, ForeignPlanFiles,
    testing::Values(
        PlanCase{"without_terrain_height",
                 [](json& p) { each_item(p, [](json& i) { i.erase("AMSLAltAboveTerrain"); }); }},
        PlanCase{"with_the_mode_alone",
                 [](json& p) {
                   each_item(p,
                             [](json& i) { i.erase("AMSLAltAboveTerrain"), i.erase("Altitude"); });
                 }},
        PlanCase{"without_rally_points", [](json& p) { p.erase("rallyPoints"); }},
        PlanCase{"without_fence", [](json& p) { p.erase("geoFence"); }},
        PlanCase{"with_the_first_fence",
                 [](json& p) {
                   p["geoFence"] = {{"polygon", json::array()}, {"version", 1}};
                 }},
        PlanCase{"without_station", [](json& p) { p.erase("groundStation"); }},
        PlanCase{"without_firmware", [](json& p) { p["mission"].erase("firmwareType"); }},
        PlanCase{"without_home", [](json& p) { p["mission"].erase("plannedHomePosition"); }},
        PlanCase{"with_a_home_of_zeros",
                 [](json& p) {
                   p["mission"]["plannedHomePosition"] = {0, 0, 0};
                 }},
        PlanCase{"with_a_home_of_nulls",
                 [](json& p) {
                   p["mission"]["plannedHomePosition"] = {nullptr, nullptr, nullptr};
                 }},
        PlanCase{"without_jump_ids",
                 [](json& p) { each_item(p, [](json& i) { i.erase("doJumpId"); }); }},
        PlanCase{"with_gaps_in_jump_ids",
                 [](json& p) {
                   each_item(p, [](json& i) { i["doJumpId"] = 10 * i["doJumpId"].get<int>(); });
                 }},
        PlanCase{"with_four_parameters_and_a_place", [](json& p) { each_item(p, split_position); }},
        PlanCase{"with_named_parameters_and_a_place",
                 [](json& p) {
                   each_item(p, [](json& i) {
                     split_position(i);
                     for (int k = 0; k < 4; ++k)
                       i["param" + std::to_string(k + 1)] = i["params"][k];
                     i.erase("params");
                   });
                 }}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(RejectedPlanFiles, NameTheCause) {
  const auto error_message = [](const std::function<void(json&)>& change) {
    json plan = our_plan();
    change(plan);
    return testing_support::thrown_message([&] { read_plan(plan.dump()); });
  };
  EXPECT_THAT(error_message([](json& p) {
                p["mission"]["items"][2] = {{"type", "ComplexItem"}, {"complexItemType", "survey"}};
              }),
              HasSubstr("mission.items[2].type must be \"SimpleItem\", but is survey "
                        "(ComplexItem); save it as waypoints first"));
  EXPECT_THAT(error_message([](json& p) { p["mission"]["items"][2]["doJumpId"] = 1; }),
              HasSubstr("mission.items[2].doJumpId must be an integer greater than"));
  EXPECT_THAT(error_message([](json& p) {
                p["geoFence"] = {{"polygon", {{1, 2}, {3, 4}, {5, 6}}}, {"version", 1}};
              }),
              HasSubstr("geoFence.version must be 2"));
}

// ---- .kmz ------------------------------------------------------------------------------------

const FlightPlan& dji_plan() {
  static const FlightPlan plan = sample_plan(vehicle_profile("m350_rtk"));
  return plan;
}

struct Member {
  std::string name, content;
};

std::string make_archive(const std::vector<Member>& members) {
  zip_error_t error;
  zip_source_t* source = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_source_keep(source);
  zip_t* archive = zip_open_from_source(source, ZIP_TRUNCATE, &error);
  for (const Member& member : members) {
    zip_file_add(archive, member.name.c_str(),
                 zip_source_buffer(archive, member.content.data(), member.content.size(), 0),
                 ZIP_FL_ENC_UTF_8);
  }
  EXPECT_EQ(zip_close(archive), 0);
  zip_source_open(source);
  zip_source_seek(source, 0, SEEK_END);
  std::string bytes(static_cast<std::size_t>(zip_source_tell(source)), '\0');
  zip_source_seek(source, 0, SEEK_SET);
  zip_source_read(source, bytes.data(), bytes.size());
  zip_source_close(source);
  zip_source_free(source);
  return bytes;
}

struct KmzCase {
  const char* name;
  std::string bytes;
};

class ForeignKmzFiles : public testing::TestWithParam<KmzCase> {};

TEST_P(ForeignKmzFiles, AreInterpretedLikeExportedFiles) {
  const FlightFacts facts = make_flight_facts(dji_plan());
  const InterpretedRoute expected = interpret(unpack_kmz(write_kmz(dji_plan())), facts);
  expect_same_flight(interpret(unpack_kmz(GetParam().bytes), facts), expected);
}

std::vector<KmzCase> kmz_cases() {
  const KmzContent good = unpack_kmz(write_kmz(dji_plan()));
  const auto packed = [&](const std::string& before, const std::string& between) {
    return make_archive({{before + "wpmz" + between + "template.kml", good.template_kml},
                         {before + "wpmz" + between + "waylines.wpml", good.waylines_wpml}});
  };
  const auto both = [&](const std::function<std::string(const std::string&)>& change) {
    return pack_kmz({change(good.template_kml), change(good.waylines_wpml)});
  };
  std::string without_return = good.waylines_wpml;
  const std::size_t begin = without_return.find("<wpml:globalRTHHeight>");
  without_return.erase(begin, without_return.find("</wpml:globalRTHHeight>") + 23 - begin);
  return {
      {"a_dot_before", packed("./", "/")},
      {"a_folder_before", packed("mission/", "/")},
      {"backslashes", packed("", "\\")},
      {"files_at_the_top",
       make_archive({{"template.kml", good.template_kml}, {"waylines.wpml", good.waylines_wpml}})},
      {"waylines_alone", make_archive({{"wpmz/waylines.wpml", good.waylines_wpml}})},
      {"line_ends_in_coordinates", both([](const std::string& text) {
         return all_replaced(all_replaced(text, "<coordinates>", "<coordinates>\n            "),
                             "</coordinates>", "\n          </coordinates>");
       })},
      {"a_blank_after_the_comma", both([](std::string text) {
         for (std::size_t i = 0; (i = text.find("<coordinates>", i)) != std::string::npos; ++i) {
           text.insert(text.find(',', i) + 1, " ");
         }
         return text;
       })},
      {"line_ends_in_values", both([](const std::string& text) {
         return all_replaced(all_replaced(text, "<wpml:finishAction>", "<wpml:finishAction>\n  "),
                             "</wpml:finishAction>", "\n</wpml:finishAction>");
       })},
      {"byte_order_mark", both([](const std::string& text) { return "\xEF\xBB\xBF" + text; })},
      {"without_return_altitude", pack_kmz({good.template_kml, without_return})},
  };
}

INSTANTIATE_TEST_SUITE_P(Interpreter, ForeignKmzFiles, testing::ValuesIn(kmz_cases()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(RejectedKmzFiles, NameTheCause) {
  const KmzContent good = unpack_kmz(write_kmz(dji_plan()));
  const auto error_message = [](const std::string& bytes) {
    return testing_support::thrown_message([&] { read_kmz(bytes); });
  };
  EXPECT_THAT(error_message(make_archive({{"doc.kml", "<kml/>"}})),
              HasSubstr("wpmz/waylines.wpml is missing; it contains doc.kml"));
  EXPECT_THAT(error_message(make_archive({{"a/waylines.wpml", good.waylines_wpml},
                                          {"b/waylines.wpml", good.waylines_wpml}})),
              HasSubstr("it contains both a/waylines.wpml and b/waylines.wpml; remove one"));
  KmzContent moved = good;
  const std::size_t height = moved.waylines_wpml.find("<wpml:executeHeight>") + 20;
  moved.waylines_wpml.insert(height, "1");
  EXPECT_THAT(error_message(pack_kmz(moved)), HasSubstr("template.kml and waylines.wpml differ"));
}

// Pilot 2: the template is relative to the geoid, the waylines to the ellipsoid.
TEST(ForeignKmzFiles, MayUseDifferentAltitudeReferences) {
  KmzContent kmz = unpack_kmz(write_kmz(dji_plan()));
  const LocalFrame frame(dji_plan().site.origin);
  const double foot = frame.to_geodetic(dji_plan().pad).height;
  const double undulation = dji_plan().site.undulation_for("the test");
  const auto raised = [](std::string text, const std::string& tag, double by) {
    for (std::size_t i = 0; (i = text.find("<wpml:" + tag + ">", i)) != std::string::npos; ++i) {
      const std::size_t begin = text.find('>', i) + 1, end = text.find('<', begin);
      const double value = to_number(text.substr(begin, end - begin)).value();
      text.replace(begin, end - begin, fixed(value + by, 3));
    }
    return text;
  };
  kmz.template_kml =
      raised(raised(kmz.template_kml, "ellipsoidHeight", foot), "height", foot - undulation);
  kmz.template_kml = all_replaced(kmz.template_kml, "relativeToStartPoint", "EGM96");
  kmz.waylines_wpml = all_replaced(raised(kmz.waylines_wpml, "executeHeight", foot),
                                   "relativeToStartPoint", "WGS84");
  const FlightFacts facts = make_flight_facts(dji_plan());
  const InterpretedRoute expected = interpret(unpack_kmz(write_kmz(dji_plan())), facts);
  const InterpretedRoute route = interpret(kmz, facts);
  ASSERT_EQ(route.segments.size(), expected.segments.size());
  EXPECT_THAT(route.problems, IsEmpty());
  for (std::size_t i = 0; i < route.segments.size(); ++i) {
    EXPECT_LT((route.segments[i].to - expected.segments[i].to).norm(), 0.01) << "piece " << i;
  }
}

// ---- parameter files -------------------------------------------------------------------------

TEST(ForeignParameterFiles, MayContainBlanksByteOrderMarkAndComments) {
  const std::vector<Parameter> read = read_parameters(
      "\xEF\xBB\xBF# MAVProxy\r\nRTL_ALT          6300.000000\r\n\r\nFS_THR_ENABLE, 1\r\n");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].name, "RTL_ALT");
  EXPECT_EQ(read[0].value, 6300.0);
  EXPECT_EQ(read[1].name, "FS_THR_ENABLE");
  EXPECT_EQ(read[1].value, 1.0);
}

}  // namespace
}  // namespace skycap::flight

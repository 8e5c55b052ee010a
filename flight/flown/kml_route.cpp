#include <cmath>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <pugixml.hpp>

#include "flight/export/text.h"
#include "flight/flown/imported_route.h"
#include "geometry/error.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

/// Returns the height reference of a shape.
HeightDatum find_datum(pugi::xml_node shape, TrackHeights heights) {
  if (heights == TrackHeights::takeoff) return HeightDatum::takeoff;
  const std::string mode = shape.child("altitudeMode").text().get();
  if (mode == "absolute" || heights == TrackHeights::absolute) return HeightDatum::mean_sea_level;
  throw Error(ErrorKind::bad_file,
              "has the altitude mode \"" +
                  geometry::excerpt(mode.empty() ? "clampToGround" : mode) +
                  "\", whose heights do not refer to a level; use --heights takeoff or absolute");
}

FilePoint make_point(const std::vector<std::string>& lon_lat_height, const std::string& item,
                     HeightDatum datum) {
  std::vector<double> numbers;
  for (const std::string& field : lon_lat_height) {
    if (const auto number = to_number(field)) numbers.push_back(*number);
  }
  const bool is_valid = lon_lat_height.size() == 3 && numbers.size() == 3 &&
                        std::abs(numbers[0]) <= 180.0 && std::abs(numbers[1]) <= 90.0 &&
                        std::abs(numbers[2]) <= 10'000.0;
  if (!is_valid) {
    throw Error(ErrorKind::bad_file,
                item + " is invalid; it must consist of longitude, latitude and height");
  }
  FilePoint point{numbers[1], numbers[0], numbers[2]};
  point.datum = datum;
  return point;
}

/// Returns the LineString of the route.
pugi::xml_node find_line(const pugi::xml_document& document) {
  std::vector<pugi::xml_node> lines;
  for (const pugi::xpath_node found : document.select_nodes("//*[local-name()='LineString']")) {
    const pugi::xml_node line = found.node();
    if (std::strcmp(line.parent().child("name").text().get(), "path") == 0) return line;
    lines.push_back(line);
  }
  if (lines.size() > 1) {
    throw Error(ErrorKind::bad_file, "contains " + std::to_string(lines.size()) +
                                         " lines; it must contain one LineString, or one that is "
                                         "named \"path\"");
  }
  return lines.empty() ? pugi::xml_node() : lines.front();
}

void read_line(pugi::xml_node line, TrackHeights heights, GeodeticRoute& route) {
  route.kind = "KML line";
  const HeightDatum datum = find_datum(line, heights);
  std::istringstream stream(line.child("coordinates").text().get());
  for (std::string tuple; stream >> tuple;) {
    route.items.push_back("point " + std::to_string(route.points.size() + 1));
    route.points.push_back(make_point(split(tuple, ','), route.items.back(), datum));
  }
}

void read_track(pugi::xml_node track, TrackHeights heights, GeodeticRoute& route) {
  route.kind = "KML track";
  route.is_track = true;
  const HeightDatum datum = find_datum(track, heights);
  pugi::xml_node angles = track.child("gx:angles");
  for (const pugi::xml_node coordinates : track.children("gx:coord")) {
    const std::string item = "point " + std::to_string(route.points.size() + 1);
    FilePoint point = make_point(geometry::split_words(coordinates.text().get()), item, datum);
    if (angles) {  // heading, tilt from straight down, roll
      const std::vector<std::string> words = geometry::split_words(angles.text().get());
      if (words.size() > 1) {
        point.yaw_deg = to_number(words[0]).value_or(unspecified);
        point.pitch_deg = to_number(words[1]).value_or(unspecified) - 90.0;
      }
      angles = angles.next_sibling("gx:angles");
    }
    route.points.push_back(point);
    route.items.push_back(item);
  }
}

}  // namespace

GeodeticRoute read_kml_route(const std::string& text, TrackHeights heights) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) {
    throw Error(ErrorKind::bad_file,
                std::string("is not well-formed XML: ") + parsed.description());
  }
  GeodeticRoute route;
  if (const pugi::xml_node line = find_line(document)) {
    read_line(line, heights, route);
  } else if (const auto track = document.select_node("//*[name()='gx:Track']")) {
    read_track(track.node(), heights, route);
  } else {
    throw Error(ErrorKind::bad_file, "contains neither a LineString nor a gx:Track");
  }
  return route;
}

}  // namespace skycap::flight

#include "missions/batch/district/city_text.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

namespace skycap::missions::batch {
namespace {

using Json = nlohmann::ordered_json;
using site_data::SurfaceKind;

/// CityJSON semantic surface types of triangles, by kind.
const char* const surface_types[] = {"WallSurface", "RoofSurface", "GroundSurface", "Window",
                                     "OuterFloorSurface"};

/// Returns the index of a kind's surface type, or null if the kind is unknown.
Json make_surface(SurfaceKind kind) {
  if (kind == SurfaceKind::unknown) return nullptr;
  return static_cast<int>(kind) - 1;
}

Json make_semantics(const site_data::Object& object) {
  Json surfaces = Json::array(), values = Json::array();
  for (const char* type : surface_types) surfaces.push_back({{"type", type}});
  for (const SurfaceKind kind : object.surfaces) values.push_back(make_surface(kind));
  return {{"surfaces", surfaces}, {"values", values}};
}

/// Returns the geometry of an object. `first` is the index of its first vertex in the file.
Json make_geometry(const site_data::Object& object, std::size_t first) {
  Json boundaries = Json::array();
  for (const auto& [a, b, c] : object.mesh.triangles) {
    boundaries.push_back(Json::array({Json::array({first + a, first + b, first + c})}));
  }
  return {{"type", "MultiSurface"},
          {"lod", "2"},
          {"boundaries", boundaries},
          {"semantics", make_semantics(object)}};
}

}  // namespace

std::string city_text(std::span<const site_data::Object* const> objects) {
  Json city = {
      {"type", "CityJSON"},
      {"version", "2.0"},
      {"transform", {{"scale", {city_step, city_step, city_step}}, {"translate", {0, 0, 0}}}},
      {"CityObjects", Json::object()},
      {"vertices", Json::array()}};
  std::size_t vertices = 0;
  for (const site_data::Object* object : objects) {
    city["CityObjects"][object->id] = {
        {"type", "Building"}, {"geometry", Json::array({make_geometry(*object, vertices)})}};
    for (const Eigen::Vector3d& vertex : object->mesh.vertices) {
      Json corner = Json::array();
      for (int axis = 0; axis < 3; ++axis) {
        corner.push_back(std::llround(vertex[axis] / city_step));
      }
      city["vertices"].push_back(std::move(corner));
    }
    vertices += object->mesh.vertices.size();
  }
  return city.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace skycap::missions::batch

#include "missions/site_data/selection.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>

#include "geometry/error.h"

namespace skycap::missions::site_data {
namespace {

using Indices = std::vector<std::size_t>;

/// Returns an object and all its ancestors, from the inside out. Throws Error{bad_file} for cycles.
Indices lineage(const Source& source, const FileContents& contents, std::size_t object) {
  constexpr std::size_t deepest = 64;
  Indices result{object};
  while (const std::optional<std::size_t> parent = contents.objects[result.back()].parent) {
    result.push_back(*parent);
    if (result.size() > deepest) {
      fail_file(source.file, "has the object " + contents.objects[object].id +
                                 ", which contains itself or is nested more than 64 levels deep");
    }
  }
  return result;
}

bool matches(const Selection& select, const FileObject& object) {
  if (!select.ids.empty() && std::ranges::find(select.ids, object.id) == select.ids.end()) {
    return false;
  }
  return std::ranges::all_of(select.attributes, [&](const auto& required) {
    const auto found = object.attributes.find(required.first);
    return found != object.attributes.end() && found->second == required.second;
  });
}

[[noreturn]] void reject(const Source& source, const std::string& what,
                         const FileContents& contents) {
  std::string some;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, contents.objects.size()); ++i) {
    some += (some.empty() ? "" : ", ") + one_line(contents.objects[i].id.substr(0, 100));
  }
  throw Error(ErrorKind::bad_config, source.file.string() + ": contains no object " + what +
                                         (some.empty() ? "" : "; it contains " + some) +
                                         (contents.objects.size() > 5 ? ", ..." : ""));
}

void require_all_met(const Source& source, const FileContents& contents,
                     const std::map<std::size_t, SelectedObject>& selected) {
  std::set<std::string> met;
  for (const auto& [index, object] : selected) met.insert(contents.objects[index].id);
  for (const std::string& id : source.select.ids) {
    if (!met.contains(id)) reject(source, "with id " + id, contents);
  }
  if (selected.empty() && !source.select.attributes.empty()) {
    const auto& [key, value] = *source.select.attributes.begin();
    reject(source, "with " + key + " = " + value, contents);
  }
}

bool has_levels(const FileContents& contents) {
  return std::ranges::any_of(contents.objects, [](const FileObject& object) {
    return std::ranges::any_of(object.polygons,
                               [](const FilePolygon& polygon) { return polygon.lod.has_value(); });
  });
}

/// Returns true if any object is extruded. ObjectBuilder::is_extruded() decides for each object.
bool has_solids(const Source& source, const FileContents& contents) {
  if (!contents.is_outlines) return false;
  return source.base_on_terrain || source.height ||
         std::ranges::any_of(contents.objects, [](const FileObject& object) {
           return !object.has_heights || object.height;
         });
}

struct KeyUse {
  const char* key;
  bool is_set, is_used;
  const char* purpose;
};

}  // namespace

std::vector<SelectedObject> select_objects(const Source& source, const FileContents& contents) {
  const bool selects_all = source.select.ids.empty() && source.select.attributes.empty();
  std::map<std::size_t, SelectedObject> selected;
  for (std::size_t i = 0; i < contents.objects.size(); ++i) {
    const FileObject& object = contents.objects[i];
    if (object.polygons.empty() && object.mesh.triangles.empty()) continue;
    const Indices line = lineage(source, contents, i);
    const auto outermost = std::find_if(line.rbegin(), line.rend(), [&](std::size_t index) {
      return selects_all || matches(source.select, contents.objects[index]);
    });
    if (outermost == line.rend()) continue;
    SelectedObject& result = selected[*outermost];
    result.object = *outermost;
    result.members.push_back(i);
  }
  require_all_met(source, contents, selected);
  std::vector<SelectedObject> result;
  for (auto& [index, object] : selected) result.push_back(std::move(object));
  return result;
}

std::vector<FilePolygon> select_polygons(const FileObject& object, std::optional<double> lod) {
  if (!lod) {
    for (const FilePolygon& polygon : object.polygons) {
      if (polygon.lod && (!lod || *polygon.lod > *lod)) lod = polygon.lod;
    }
  }
  std::vector<FilePolygon> result;
  for (const FilePolygon& polygon : object.polygons) {
    if (!polygon.lod || polygon.lod == lod) result.push_back(polygon);
  }
  return result;
}

void reject_unused(const Source& source, const FileContents& contents) {
  const Selection& select = source.select;
  const bool is_outlines = contents.is_outlines, has_objects = !contents.objects.empty();
  const bool is_based = source.base_on_terrain || source.base;
  const bool has_extruded = has_solids(source, contents);
  const bool has_uncertainty_in_use = source.role != Role::truth;
  const bool is_on_terrain = is_outlines && source.base_on_terrain;
  const std::array<KeyUse, 13> uses{{
      {"base", is_based, has_extruded, "outlines that are extruded"},
      {"height", source.height.has_value(), is_outlines, "polygons of maps"},
      {"height_attribute", !source.height_attribute.empty(), is_outlines, "polygons of maps"},
      {"min_height", source.min_height > 0.0, has_extruded, "outlines that are extruded"},
      {"spacing", source.spacing.has_value(), !contents.points.empty(), "points"},
      {"select.classes", !select.classes.empty(), contents.has_classes, "LAS files"},
      {"select.layer", !select.layer.empty(), is_outlines, "maps"},
      {"select.lod", select.lod.has_value(), has_levels(contents),
       "city models with levels of detail"},
      {"select.id", !select.ids.empty(), has_objects, "files of objects"},
      {"select.attribute", !select.attributes.empty(), has_objects, "files of objects"},
      {"up_axis", source.is_y_up.has_value(), contents.is_scene, "scene models"},
      {"uncertainty", source.uncertainty.has_value(), has_uncertainty_in_use,
       "data other than ground truth"},
      {"vertical", source.vertical.has_value(), !is_on_terrain,
       "data with heights; the base height of these outlines is taken from the terrain"},
  }};
  for (const KeyUse& use : uses) {
    if (!use.is_set || use.is_used) continue;
    throw Error(ErrorKind::bad_config, source.file.string() + ": " + use.key +
                                           " does not apply to this file; it applies to " +
                                           use.purpose + "; remove it");
  }
}

}  // namespace skycap::missions::site_data

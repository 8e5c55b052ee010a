#include "missions/prior/selection.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "geometry/error.h"

namespace skycap::missions::prior {
namespace {

using Indices = std::vector<std::size_t>;

/// An object, what it is part of, and so on, outwards. Throws Error{bad_file} if that never ends.
Indices lineage(const Source& source, const FileContents& contents, std::size_t object) {
  constexpr std::size_t deepest = 64;
  Indices result{object};
  while (const std::optional<std::size_t> parent = contents.objects[result.back()].parent) {
    result.push_back(*parent);
    if (result.size() > deepest) {
      fail_file(source.file, "has the object " + contents.objects[object].id +
                                 ", which is part of itself or nested deeper than 64");
    }
  }
  return result;
}

bool matches(const Selection& select, const FileObject& object) {
  if (!select.ids.empty() && std::ranges::find(select.ids, object.id) == select.ids.end()) {
    return false;
  }
  return std::ranges::all_of(select.attributes, [&](const auto& wanted) {
    const auto found = object.attributes.find(wanted.first);
    return found != object.attributes.end() && found->second == wanted.second;
  });
}

[[noreturn]] void refuse(const Source& source, const std::string& what,
                         const FileContents& contents) {
  std::string some;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, contents.objects.size()); ++i) {
    some += (some.empty() ? "" : ", ") + one_line(contents.objects[i].id.substr(0, 100));
  }
  throw Error(ErrorKind::bad_config, source.file.string() + ": holds no object " + what +
                                         (some.empty() ? "" : "; it holds " + some) +
                                         (contents.objects.size() > 5 ? ", ..." : ""));
}

void require_all_met(const Source& source, const FileContents& contents,
                     const std::map<std::size_t, SelectedObject>& selected) {
  std::set<std::string> met;
  for (const auto& [index, object] : selected) met.insert(contents.objects[index].id);
  for (const std::string& id : source.select.ids) {
    if (!met.contains(id)) refuse(source, "with the id " + id, contents);
  }
  if (selected.empty() && !source.select.attributes.empty()) {
    const auto& [key, value] = *source.select.attributes.begin();
    refuse(source, "with " + key + " = " + value, contents);
  }
}

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

}  // namespace skycap::missions::prior

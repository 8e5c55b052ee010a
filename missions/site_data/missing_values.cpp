#include "missions/site_data/missing_values.h"

#include "missions/site_data/file_reader.h"
#include "missions/site_data/site_transform.h"

namespace skycap::missions::site_data {

MissingValues missing_values(const Source& source) {
  const SharedContents shared = read_contents(source, {});
  const FileContents& contents = *shared;
  MissingValues missing;
  const bool is_in_frame = source.pose || contents.is_local_frame;
  missing.crs = !is_in_frame && contents.crs.empty() && source.crs.empty();
  if (contents.is_outlines) {
    for (const FileObject& object : contents.objects) {
      if (object.polygons.empty() || object.has_heights) continue;
      missing.base = missing.base || !(source.base || source.base_on_terrain);
      const bool has_height = source.height || object.height || !object.height_problem.empty();
      if (!has_height && missing.outline_without_height.empty())
        missing.outline_without_height = one_line(object.id);
    }
  }
  if (missing.crs || source.pose || source.base_on_terrain || source.vertical ||
      contents.vertical || (contents.crs.empty() && source.crs.empty())) {
    return missing;
  }
  missing.vertical = !SiteTransform(source, contents, {}, false).has_own_heights();
  return missing;
}

}  // namespace skycap::missions::site_data

/// Conversion of a file's polygons and meshes to objects in the site frame.
#pragma once

#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/selection.h"
#include "missions/site_data/site_transform.h"

namespace skycap::missions::site_data {

/// Builder of the objects of one file.
class ObjectBuilder {
 public:
  /// All arguments must outlive the builder. Throws all errors of SiteTransform.
  ObjectBuilder(const Source& source, const FileContents& contents, const SiteFrame& site,
                const TerrainHeight& terrain);

  /// Builds an object. Throws Error{bad_config} if an outline has no base or height.
  Object build(const SelectedObject& selected);

  const SiteTransform& transform() const { return transform_; }
  std::size_t dropped_polygons() const { return dropped_; }
  bool has_extruded() const { return has_extruded_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct Rings {
    std::vector<Eigen::Vector3d> corners;
    std::vector<std::uint32_t> begin{0};  ///< Ring offsets as in geometry::add_polygon().
    std::vector<std::size_t> first_ring;  ///< First ring of each polygon.
    std::vector<SurfaceKind> kinds;       ///< Surface kind of each polygon.
  };

  Rings make_rings(const FileObject& object) const;
  bool is_extruded(const FileObject& object) const;
  void add_surfaces(const FileObject& object, Object& result);
  void add_solids(const FileObject& object, Object& result);
  void add_draped(const FileObject& object, Object& result);
  double compute_height(const FileObject& object) const;
  void add_columns(const Rings& bottom, const Rings& top, Object& result);
  double ground_below(std::span<const Eigen::Vector3d> corners) const;
  void place_on_base(bool has_heights, Rings& bottom, Rings& top, double min, double max) const;
  void place_on_terrain(Rings& bottom, Rings& top, double min, double max) const;

  const Source& source_;
  const FileContents& contents_;
  const TerrainHeight& terrain_;
  double ground_z_;  ///< Height of the ground plane where the terrain is unknown [m].
  SiteTransform transform_;
  std::size_t dropped_ = 0;
  bool has_extruded_ = false;
  std::vector<std::string> notes_;
};

}  // namespace skycap::missions::site_data

/// Point cloud of a structure, with the discs that represent its surface between the points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::survey::inspection {

/// Points with normals and disc radii, as a structure of arrays. Mission frame [m].
struct StructureCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< Unit normals. The sign has no meaning.
  std::vector<float> radii;              ///< Disc radii [m].
  float median_radius = 0.0F;            ///< Median of the radii before they are limited [m].

  std::size_t size() const { return points.size(); }
  Eigen::AlignedBox3d box() const;
};

/// Minimum number of distinct points of a structure.
inline constexpr std::size_t min_structure_points = 8;

/// Computes normals and radii. The normal is that of the plane through a point and its 10 nearest
/// neighbours. The radius is the distance of the 6th nearest neighbour, at most 2.5 times the
/// median: then a spot of a randomly sampled surface is in no disc with a probability of exp(-6).
/// `normals` replaces the computed ones if it is not empty. Repeated points are removed. Throws
/// Error{bad_geometry} with fewer than min_structure_points distinct points.
StructureCloud make_structure_cloud(std::span<const Eigen::Vector3f> points,
                                    std::span<const Eigen::Vector3f> normals = {});

/// Depths in all directions around a position: the discs of a cloud, drawn into the six faces of a
/// cube.
class DepthCube {
 public:
  /// `resolution` is the number of pixels along the side of a face.
  explicit DepthCube(int resolution);

  /// Clears the cube and draws the discs `discs` as seen from `eye`.
  void draw(const StructureCloud& cloud, std::span<const std::uint32_t> discs,
            const Eigen::Vector3f& eye);

  /// Returns true if no disc hides a point by more than `tolerance` of its own radius. Points with
  /// distances that exceed the depth of their pixel are hidden.
  bool is_visible(const StructureCloud& cloud, std::uint32_t point, float tolerance = 1.5F) const;

 private:
  void draw_face(std::size_t face, const Eigen::Vector3f& centre, const Eigen::Vector3f& normal,
                 float radius);

  int resolution_;
  std::vector<float> slopes_;  // tangent at the centre of each column or row of a face
  std::vector<float> depths_;
  Eigen::Vector3f eye_ = Eigen::Vector3f::Zero();
};

}  // namespace skycap::survey::inspection

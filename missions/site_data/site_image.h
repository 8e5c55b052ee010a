/// Image of the site from above, such as an orthophoto, as a background of 3-D views.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

struct SiteImage {
  std::string name;  ///< Name of the file.
  std::string jpeg;
  /// Corners in the site frame [m]: top left, top right, bottom right and bottom left.
  std::array<Eigen::Vector2d, 4> corners{};
};

/// Reads the part of a georeferenced image that covers `box` [m, site frame], with at most 2048
/// pixels per side. Throws Error{bad_file} if the image cannot be read or does not cover any part
/// of the box. Throws Error{bad_config} if the position of the image or of the site is unknown.
SiteImage read_site_image(const std::filesystem::path& file, const SiteFrame& site,
                          const Eigen::AlignedBox2d& box);

}  // namespace skycap::missions::site_data

#include "missions/site_data/site_image.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/error.h"
#include "missions/site_data/formats/file_image.h"
#include "missions/site_data/site_transform.h"
#include "missions/support/module.h"

namespace skycap::missions::site_data {

using Eigen::Vector2d;
using Eigen::Vector3d;

FileImage read_image_header(const std::filesystem::path& file) {
  using Read = void(const std::filesystem::path&, FileImage&);
  FileImage image;
  support::module_function<Read>("libskycap_gdal.so", "skycap_read_image_header")(file, image);
  return image;
}

std::string read_image(const std::filesystem::path& file, const ImageWindow& window, int max_side) {
  using Read = void(const std::filesystem::path&, const ImageWindow&, int, std::string&);
  std::string jpeg;
  support::module_function<Read>("libskycap_gdal.so", "skycap_read_image")(file, window, max_side,
                                                                           jpeg);
  return jpeg;
}

namespace {

constexpr int max_side = 2048;  // [px]

/// Transformation between the pixels of an image and the site frame.
class PixelTransform {
 public:
  PixelTransform(const FileImage& image, SiteTransform transform)
      : image_(image), transform_(std::move(transform)) {}

  Vector2d to_site(const Vector2d& pixel) const {
    const std::array<double, 6>& a = image_.affine;
    Vector3d position(a[0] + a[1] * pixel.x() + a[2] * pixel.y(),
                      a[3] + a[4] * pixel.x() + a[5] * pixel.y(), 0.0);
    transform_.to_site(std::span(&position, 1));
    return position.head<2>();
  }

  /// Returns the pixel at a position. The transformation is almost affine, so that Newton's method
  /// with a numerical derivative converges in a few steps.
  Vector2d to_pixel(const Vector2d& position) const {
    Vector2d pixel(0.5 * image_.columns, 0.5 * image_.rows);
    constexpr int steps = 8;
    for (int step = 0; step < steps; ++step) {
      const Vector2d at = to_site(pixel);
      Eigen::Matrix2d slope;
      slope << to_site(pixel + Vector2d(1, 0)) - at, to_site(pixel + Vector2d(0, 1)) - at;
      if (!(std::abs(slope.determinant()) > 0.0)) break;
      pixel += slope.inverse() * (position - at);
      pixel = pixel.cwiseMax(Vector2d(0, 0)).cwiseMin(Vector2d(image_.columns, image_.rows));
    }
    return pixel;
  }

 private:
  const FileImage& image_;
  SiteTransform transform_;
};

}  // namespace

SiteImage read_site_image(const std::filesystem::path& file, const SiteFrame& site,
                          const Eigen::AlignedBox2d& box) {
  const FileImage header = read_image_header(file);
  Source source;
  source.file = file;
  FileContents contents;
  contents.crs = header.crs;
  if (header.crs.empty()) {
    throw Error(
        ErrorKind::bad_config,
        file.string() + ": has no coordinate reference system; set it with gdal_edit.py -a_srs");
  }
  const PixelTransform transform(header, SiteTransform(source, contents, site, false));
  Eigen::AlignedBox2d pixels;
  using enum Eigen::AlignedBox2d::CornerType;
  for (const auto corner : {BottomLeft, BottomRight, TopLeft, TopRight}) {
    pixels.extend(transform.to_pixel(box.corner(corner)));
  }
  ImageWindow window;
  window.column = static_cast<int>(std::floor(pixels.min().x()));
  window.row = static_cast<int>(std::floor(pixels.min().y()));
  window.columns = static_cast<int>(std::ceil(pixels.max().x())) - window.column;
  window.rows = static_cast<int>(std::ceil(pixels.max().y())) - window.row;
  if (window.columns < 1 || window.rows < 1) {
    throw Error(ErrorKind::bad_file, file.string() + ": does not cover the site");
  }
  SiteImage image;
  image.name = file.filename().string();
  const Vector2d first(window.column, window.row);
  const Vector2d last(window.column + window.columns, window.row + window.rows);
  image.corners = {transform.to_site(first), transform.to_site({last.x(), first.y()}),
                   transform.to_site(last), transform.to_site({first.x(), last.y()})};
  image.jpeg = read_image(file, window, max_side);
  return image;
}

}  // namespace skycap::missions::site_data

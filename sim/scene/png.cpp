#include <filesystem>
#include <string>
#include <system_error>

#include <png.h>

#include "geometry/error.h"
#include "sim/scene/render.h"

namespace skycap::sim {
namespace {

png_image empty_png() {
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  return png;
}

}  // namespace

void write_png(const Image& image, const std::filesystem::path& path) {
  png_image png = empty_png();
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  const std::filesystem::path unfinished = path.string() + ".part";
  const bool is_written =
      png_image_write_to_file(&png, unfinished.c_str(), 0, image.pixels.data(), 0, nullptr) != 0;
  std::error_code failure;
  if (is_written) std::filesystem::rename(unfinished, path, failure);
  if (is_written && !failure) return;
  const std::string reason = is_written ? failure.message() : png.message;
  std::filesystem::remove(unfinished, failure);
  throw Error(ErrorKind::bad_file, "cannot write the picture '" + path.string() + "': " + reason);
}

Image read_png(const std::filesystem::path& path) {
  png_image png = empty_png();
  if (png_image_begin_read_from_file(&png, path.c_str()) != 0) {
    png.format = PNG_FORMAT_RGB;
    Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
    image.pixels.resize(static_cast<std::size_t>(png.width) * png.height);
    const png_color black = {0, 0, 0};  // what transparent pixels are laid over
    if (png_image_finish_read(&png, &black, image.pixels.data(), 0, nullptr) != 0) return image;
  }
  throw Error(ErrorKind::bad_file,
              "cannot read the picture '" + path.string() + "': " + png.message);
}

}  // namespace skycap::sim

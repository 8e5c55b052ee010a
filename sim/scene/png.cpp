#include <filesystem>
#include <string>

#include <png.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
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
  png_alloc_size_t size = 0;
  std::string bytes;
  const auto encode = [&](void* memory) {
    return png_image_write_to_memory(&png, memory, &size, 0, image.pixels.data(), 0, nullptr) != 0;
  };
  bool is_encoded = encode(nullptr);
  if (is_encoded) bytes.resize(size), is_encoded = encode(bytes.data());
  if (!is_encoded) {
    throw Error(ErrorKind::bad_file,
                "cannot write the image '" + path.string() + "': " + png.message);
  }
  geometry::write_file(path, bytes);
}

Image read_png(const std::filesystem::path& path) {
  png_image png = empty_png();
  if (png_image_begin_read_from_file(&png, path.c_str()) != 0) {
    png.format = PNG_FORMAT_RGB;
    Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
    image.pixels.resize(static_cast<std::size_t>(png.width) * png.height);
    const png_color black = {0, 0, 0};  // Background of transparent pixels.
    if (png_image_finish_read(&png, &black, image.pixels.data(), 0, nullptr) != 0) return image;
  }
  throw Error(ErrorKind::bad_file, "cannot read the image '" + path.string() + "': " + png.message);
}

}  // namespace skycap::sim

#include <memory>

#include <zip.h>

#include "flight/export/wpml_file.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

constexpr const char* template_name = "wpmz/template.kml";
constexpr const char* waylines_name = "wpmz/waylines.wpml";

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorKind::bad_file, "not a good .kmz file: " + what);
}

struct CloseSource {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};
struct DiscardArchive {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct CloseFile {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using Source = std::unique_ptr<zip_source_t, CloseSource>;
using Archive = std::unique_ptr<zip_t, DiscardArchive>;

std::string extract(zip_t* archive, const char* name) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat(archive, name, 0, &stat) != 0) fail(std::string(name) + " is missing");
  if (stat.size > 100'000'000) fail(std::string(name) + " is larger than 100 MB");
  const std::unique_ptr<zip_file_t, CloseFile> file(zip_fopen(archive, name, 0));
  std::string content(stat.size, '\0');
  if (!file || zip_fread(file.get(), content.data(), content.size()) !=
                   static_cast<zip_int64_t>(content.size())) {
    fail(std::string(name) + " cannot be unpacked");
  }
  return content;
}

void add(zip_t* archive, const char* name, const std::string& content) {
  zip_source_t* source = zip_source_buffer(archive, content.data(), content.size(), 0);
  const zip_int64_t index = zip_file_add(archive, name, source, ZIP_FL_ENC_UTF_8);
  if (index < 0) fail(zip_strerror(archive));
  // 1 January 1980: the same mission is the same file whenever it is written.
  zip_file_set_dostime(archive, static_cast<zip_uint64_t>(index), 0, 0x21, 0);
}

}  // namespace

KmzContent unpack_kmz(const std::string& bytes) {
  zip_error_t error;
  zip_error_init(&error);
  Source source(zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error));
  Archive archive(source ? zip_open_from_source(source.get(), ZIP_RDONLY, &error) : nullptr);
  if (!archive) fail("it is not a zip archive");
  static_cast<void>(source.release());  // the archive owns it now
  return {extract(archive.get(), template_name), extract(archive.get(), waylines_name)};
}

std::string pack_kmz(const KmzContent& content) {
  zip_error_t error;
  zip_error_init(&error);
  Source source(zip_source_buffer_create(nullptr, 0, 0, &error));
  if (!source) fail(zip_error_strerror(&error));
  zip_source_keep(source.get());  // to read what was written after the archive is closed
  Archive archive(zip_open_from_source(source.get(), ZIP_TRUNCATE, &error));
  if (!archive) fail(zip_error_strerror(&error));
  add(archive.get(), template_name, content.template_kml);
  add(archive.get(), waylines_name, content.waylines_wpml);
  if (zip_close(archive.get()) != 0) fail(zip_strerror(archive.get()));
  static_cast<void>(archive.release());

  zip_source_open(source.get());
  zip_source_seek(source.get(), 0, SEEK_END);
  std::string bytes(static_cast<std::size_t>(zip_source_tell(source.get())), '\0');
  zip_source_seek(source.get(), 0, SEEK_SET);
  zip_source_read(source.get(), bytes.data(), bytes.size());
  zip_source_close(source.get());
  return bytes;
}

}  // namespace skycap::flight

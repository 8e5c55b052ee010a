#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>

#include <zip.h>

#include "flight/export/wpml_file.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

constexpr const char* template_name = "wpmz/template.kml";
constexpr const char* waylines_name = "wpmz/waylines.wpml";

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorKind::bad_file, "invalid .kmz file: " + what);
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

/// Returns the last part of a member's name. Some programs use backslashes as separators.
std::string_view last_name(std::string_view name) {
  return name.substr(name.find_last_of("/\\") + 1);
}

std::string entry_name(zip_t* archive, zip_uint64_t index) {
  const char* name = zip_get_name(archive, index, 0);
  return name == nullptr ? "" : name;
}

/// Returns up to three member names for messages.
std::string join_names(zip_t* archive) {
  const auto count = static_cast<zip_uint64_t>(zip_get_num_entries(archive, 0));
  std::string names;
  for (zip_uint64_t i = 0; i < std::min<zip_uint64_t>(count, 3); ++i) {
    names += (i == 0 ? "" : ", ") + entry_name(archive, i);
  }
  return count == 0 ? "no files" : names + (count > 3 ? ", ..." : "");
}

/// Returns the member with that name, or the only one with the same last part. Repacked archives
/// prefix names with "./" or a folder. Returns std::nullopt if there is no match.
std::optional<zip_uint64_t> find(zip_t* archive, const char* name) {
  const zip_int64_t exact = zip_name_locate(archive, name, 0);
  if (exact >= 0) return static_cast<zip_uint64_t>(exact);
  std::optional<zip_uint64_t> found;
  const auto count = static_cast<zip_uint64_t>(zip_get_num_entries(archive, 0));
  for (zip_uint64_t i = 0; i < count; ++i) {
    if (last_name(entry_name(archive, i)) != last_name(name)) continue;
    if (found) {
      fail("it contains both " + entry_name(archive, *found) + " and " + entry_name(archive, i) +
           "; remove one");
    }
    found = i;
  }
  return found;
}

std::string extract(zip_t* archive, zip_uint64_t index) {
  const std::string name = entry_name(archive, index);
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat_index(archive, index, 0, &stat) != 0) fail(name + " cannot be unpacked");
  if (stat.size > 100'000'000) fail(name + " is larger than 100 MB");
  const std::unique_ptr<zip_file_t, CloseFile> file(zip_fopen_index(archive, index, 0));
  std::string content(stat.size, '\0');
  if (!file || zip_fread(file.get(), content.data(), content.size()) !=
                   static_cast<zip_int64_t>(content.size())) {
    fail(name + " cannot be unpacked");
  }
  return content;
}

void add_entry(zip_t* archive, const char* name, const std::string& content) {
  zip_source_t* source = zip_source_buffer(archive, content.data(), content.size(), 0);
  const zip_int64_t index = zip_file_add(archive, name, source, ZIP_FL_ENC_UTF_8);
  if (index < 0) fail(zip_strerror(archive));
  // 1 January 1980, so that a mission gives the same file at any time.
  zip_file_set_dostime(archive, static_cast<zip_uint64_t>(index), 0, 0x21, 0);
}

}  // namespace

KmzContent unpack_kmz(const std::string& bytes) {
  zip_error_t error;
  zip_error_init(&error);
  Source source(zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error));
  Archive archive(source ? zip_open_from_source(source.get(), ZIP_RDONLY, &error) : nullptr);
  if (!archive) fail("it is not a zip archive");
  static_cast<void>(source.release());  // The archive owns it now.
  const auto edited = find(archive.get(), template_name);
  const auto waylines = find(archive.get(), waylines_name);
  if (!waylines) {
    fail(std::string(edited ? "" : template_name) + (edited ? "" : " is missing, and ") +
         waylines_name + " is missing; it contains " + join_names(archive.get()));
  }
  return {edited ? extract(archive.get(), *edited) : "", extract(archive.get(), *waylines)};
}

std::string pack_kmz(const KmzContent& content) {
  zip_error_t error;
  zip_error_init(&error);
  Source source(zip_source_buffer_create(nullptr, 0, 0, &error));
  if (!source) fail(zip_error_strerror(&error));
  // Keeps the source to read the result after the archive is closed.
  zip_source_keep(source.get());
  Archive archive(zip_open_from_source(source.get(), ZIP_TRUNCATE, &error));
  if (!archive) fail(zip_error_strerror(&error));
  add_entry(archive.get(), template_name, content.template_kml);
  add_entry(archive.get(), waylines_name, content.waylines_wpml);
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

#include "tests/fuzz/structure.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

#include <zlib.h>

#include "geometry/io/e57/layout.h"
#include "geometry/io/e57/pages.h"
#include "geometry/io/record_log.h"

namespace skycap::fuzz {
namespace {

using std::string;
using std::string_view;
using Parts = std::vector<string>;

constexpr std::size_t max_parts = 4096, max_inflated = std::size_t{1} << 20;

template <typename Number>
Number number_at(string_view bytes, std::size_t at) {
  Number number{};
  if (at + sizeof number <= bytes.size()) std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

template <typename Number>
void put(string& bytes, std::size_t at, Number number) {
  if (at + sizeof number <= bytes.size()) std::memcpy(bytes.data() + at, &number, sizeof number);
}

template <typename Number>
void append(string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

string joined(const Parts& parts) {
  string bytes;
  for (const string& part : parts) bytes += part;
  return bytes;
}

/// Decompresses until the end of the data or the first error. `window`: see inflateInit2().
string inflated(string_view bytes, int window, std::size_t* used = nullptr) {
  z_stream stream{};
  if (inflateInit2(&stream, window) != Z_OK) return {};
  string content(max_inflated, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(content.data());
  stream.avail_out = static_cast<uInt>(content.size());
  inflate(&stream, Z_FINISH);
  content.resize(stream.total_out);
  if (used != nullptr) *used = stream.total_in;
  inflateEnd(&stream);
  return content;
}

string deflated(string_view content, int window) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY);
  string bytes(deflateBound(&stream, content.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  deflate(&stream, Z_FINISH);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

constexpr int raw = -MAX_WBITS, gzip = 16 + MAX_WBITS, zlib = MAX_WBITS;

// One text or byte sequence.
Parts split_whole(string_view bytes) { return {string(bytes)}; }

// Lines, such as those of tables and journals.
Parts split_lines(string_view bytes) {
  Parts parts;
  while (!bytes.empty() && parts.size() < max_parts) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size() - 1) + 1;
    parts.emplace_back(bytes.substr(0, end));
    bytes.remove_prefix(end);
  }
  return parts;
}

// Journal records: their texts. The join adds checksums and numbers.
Parts split_records(string_view bytes) {
  Parts parts = split_lines(bytes);
  for (string& part : parts) {
    if (part.ends_with('\n')) part.pop_back();
    const std::size_t number = part.find(' ');
    const std::size_t text = number == string::npos ? number : part.find(' ', number + 1);
    if (text != string::npos) part.erase(0, text + 1);
  }
  return parts;
}

string join_records(const Parts& parts) {
  string bytes;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    string text = parts[i];
    std::ranges::replace(text, '\n', ' ');
    text = std::to_string(i + 1) + " " + text;
    std::array<char, 16> head{};
    std::snprintf(head.data(), head.size(), "%08x ",
                  static_cast<unsigned>(geometry::compute_crc32(text)));
    bytes += head.data() + text + "\n";
  }
  return bytes;
}

// PLY and PCD files: lines of the header and the data after it.
Parts split_head(string_view bytes, string_view last_line) {
  Parts parts;
  while (!bytes.empty() && parts.size() < 200) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size() - 1) + 1;
    const string_view line = bytes.substr(0, end);
    parts.emplace_back(line);
    bytes.remove_prefix(end);
    if (line.starts_with(last_line)) break;
  }
  if (!bytes.empty()) parts.emplace_back(bytes);
  return parts;
}
Parts split_ply(string_view bytes) { return split_head(bytes, "end_header"); }
Parts split_pcd(string_view bytes) { return split_head(bytes, "DATA"); }

Parts split_gzip(string_view bytes) { return {inflated(bytes, gzip)}; }
string join_gzip(const Parts& parts) { return deflated(joined(parts), gzip); }

// ZIP archives: name and content of each file, alternating.
Parts split_zip(string_view bytes) {
  constexpr string_view signature = "PK\3\4";
  constexpr std::size_t head = 30;
  Parts parts;
  for (std::size_t at = bytes.find(signature);
       at != string_view::npos && at + head <= bytes.size() && parts.size() < 64;
       at = bytes.find(signature, at)) {
    const std::size_t name_size = number_at<std::uint16_t>(bytes, at + 26);
    const std::size_t begin = at + head + name_size + number_at<std::uint16_t>(bytes, at + 28);
    if (begin > bytes.size()) break;
    parts.emplace_back(bytes.substr(at + head, name_size));
    const string_view rest = bytes.substr(begin);
    std::size_t used = number_at<std::uint32_t>(bytes, at + 18);
    const bool is_stored = number_at<std::uint16_t>(bytes, at + 8) == 0;
    parts.push_back(is_stored ? string(rest.substr(0, used)) : inflated(rest, raw, &used));
    at = std::min(begin + std::max<std::size_t>(used, 1), bytes.size());
  }
  return parts;
}

string join_zip(const Parts& parts) {
  string bytes, directory;
  std::uint16_t count = 0;
  for (std::size_t i = 0; i + 1 < parts.size(); i += 2, ++count) {
    const string name = parts[i].substr(0, 1000), &content = parts[i + 1];
    const string data = deflated(content, raw);
    string entry;  // fields that the local header and the directory have in common
    for (const int field : {20, 0, 8, 0, 33}) append(entry, static_cast<std::uint16_t>(field));
    append(entry, geometry::compute_crc32(content));
    append(entry, static_cast<std::uint32_t>(data.size()));
    append(entry, static_cast<std::uint32_t>(content.size()));
    append(entry, static_cast<std::uint16_t>(name.size()));
    append(entry, std::uint16_t{0});
    directory += string("PK\1\2\x14\0", 6) + entry + string(10, '\0');
    append(directory, static_cast<std::uint32_t>(bytes.size()));
    directory += name;
    bytes += "PK\3\4" + entry + name + data;
  }
  string end = string("PK\5\6\0\0\0\0", 8);
  append(end, count);
  append(end, count);
  append(end, static_cast<std::uint32_t>(directory.size()));
  append(end, static_cast<std::uint32_t>(bytes.size()));
  append(end, std::uint16_t{0});
  return bytes + directory + end;
}

std::uint32_t big_endian(string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i) {
    number = number << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  }
  return number;
}

void append_big_endian(string& bytes, std::uint32_t number) {
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(number >> shift);
}

// PNG images: type and content of each chunk. The image data is one decompressed part.
constexpr string_view png_signature = "\x89PNG\r\n\x1a\n";
Parts split_png(string_view bytes) {
  Parts parts;
  string image;
  for (std::size_t at = png_signature.size(); at + 12 <= bytes.size() && parts.size() < 64;) {
    const std::size_t length = std::min<std::size_t>(big_endian(bytes, at), bytes.size() - at - 12);
    const string chunk(bytes.substr(at + 4, 4 + length));
    at += 12 + length;
    if (!chunk.starts_with("IDAT")) {
      parts.push_back(chunk);
      continue;
    }
    if (image.empty()) parts.emplace_back("IDAT");
    image += chunk.substr(4);
  }
  for (string& part : parts) {
    if (part == "IDAT") part += inflated(image, zlib);
  }
  return parts;
}

string join_png(const Parts& parts) {
  string bytes(png_signature);
  for (const string& part : parts) {
    string chunk = part.substr(0, 4);
    chunk.resize(4, ' ');
    const string content = part.substr(std::min<std::size_t>(4, part.size()));
    chunk += chunk == "IDAT" ? deflated(content, zlib) : content;
    append_big_endian(bytes, static_cast<std::uint32_t>(chunk.size() - 4));
    bytes += chunk;
    append_big_endian(bytes, geometry::compute_crc32(chunk));
  }
  return bytes;
}

// E57 files: the binary sections and the XML section at the end. The reader's target adds the page
// checksums.
Parts split_e57(string_view bytes) {
  namespace e57 = geometry::e57;
  string content;
  for (std::size_t at = 0; at < bytes.size(); at += e57::page_size) {
    content += bytes.substr(at, e57::page_content);
  }
  const auto physical = number_at<std::uint64_t>(content, e57::header::description);
  const std::uint64_t begin =
      physical / e57::page_size * e57::page_content + physical % e57::page_size;
  const auto size = number_at<std::uint64_t>(content, e57::header::description_size);
  if (begin < e57::header::size || begin > content.size() || size > content.size() - begin) {
    return {};
  }
  return {content.substr(0, begin), content.substr(begin, size)};
}

string join_e57(const Parts& parts) {
  namespace e57 = geometry::e57;
  string content = parts.front();
  const std::size_t begin = content.size();
  for (std::size_t i = 1; i < parts.size(); ++i) content += parts[i];
  const std::size_t pages = (content.size() + e57::page_content - 1) / e57::page_content;
  put<std::uint64_t>(content, e57::header::file_size, pages * e57::page_size);
  put<std::uint64_t>(content, e57::header::description,
                     begin / e57::page_content * e57::page_size + begin % e57::page_content);
  put<std::uint64_t>(content, e57::header::description_size, content.size() - begin);
  return e57::sealed(content);
}

// LAS files: the header, each record, and the points. The join adapts the offset of the points.
Parts split_las(string_view bytes) {
  const std::size_t head = number_at<std::uint16_t>(bytes, 94);
  const std::size_t points = number_at<std::uint32_t>(bytes, 96);
  if (head < 227 || head > points || points > bytes.size()) return {};
  Parts parts{string(bytes.substr(0, head))};
  for (std::size_t at = head; at < points && parts.size() < 64;) {
    const std::size_t end =
        at + 54 > points
            ? points
            : std::min<std::size_t>(at + 54 + number_at<std::uint16_t>(bytes, at + 20), points);
    parts.emplace_back(bytes.substr(at, end - at));
    at = end;
  }
  parts.emplace_back(bytes.substr(points));
  return parts;
}

string join_las(const Parts& parts) {
  string bytes = parts.front();
  put(bytes, 94, static_cast<std::uint16_t>(bytes.size()));
  std::uint32_t records = 0;
  for (std::size_t i = 1; i + 1 < parts.size(); ++i, ++records) {
    string record = parts[i];
    if (record.size() >= 54) put(record, 20, static_cast<std::uint16_t>(record.size() - 54));
    bytes += record;
  }
  put(bytes, 96, static_cast<std::uint32_t>(bytes.size()));
  put(bytes, 100, records);
  if (parts.size() > 1) bytes += parts.back();
  return bytes;
}

// Dataflash logs: messages, which begin with A3 95.
Parts split_dataflash(string_view bytes) {
  constexpr string_view mark = "\xA3\x95";
  Parts parts;
  while (!bytes.empty() && parts.size() < max_parts) {
    const std::size_t end = std::min(bytes.find(mark, 2), bytes.size());
    parts.emplace_back(bytes.substr(0, end));
    bytes.remove_prefix(end);
  }
  return parts;
}

// ULog files: the header, then type and content of each message.
Parts split_ulog(string_view bytes) {
  if (bytes.size() < 16) return {};
  Parts parts{string(bytes.substr(0, 16))};
  for (std::size_t at = 16; at + 3 <= bytes.size() && parts.size() < max_parts;) {
    const std::size_t size = number_at<std::uint16_t>(bytes, at);
    parts.emplace_back(bytes.substr(at + 2, 1 + size));
    at += 3 + size;
  }
  return parts;
}

string join_ulog(const Parts& parts) {
  string bytes = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) {
    if (parts[i].empty()) continue;
    const string part = parts[i].substr(0, 65536);
    append(bytes, static_cast<std::uint16_t>(part.size() - 1));
    bytes += part;
  }
  return bytes;
}

// MAVLink frames in the notation of the target: seven bytes with the payload's length at the end,
// then the payload.
Parts split_mavlink(string_view bytes) {
  Parts parts;
  for (std::size_t at = 0; at + 7 <= bytes.size() && parts.size() < max_parts;) {
    const std::size_t size = 7 + static_cast<std::uint8_t>(bytes[at + 6]);
    parts.emplace_back(bytes.substr(at, size));
    at += size;
  }
  return parts;
}

string join_mavlink(const Parts& parts) {
  string bytes;
  for (const string& part : parts) {
    string frame = part.substr(0, 7 + 255);
    if (frame.size() < 7) continue;
    frame[6] = static_cast<char>(frame.size() - 7);
    bytes += frame;
  }
  return bytes;
}

// Messages of a live survey: header and payload, alternating.
Parts split_wire(string_view bytes) {
  Parts parts;
  for (std::size_t at = 0; at + 12 <= bytes.size() && parts.size() < 64;) {
    const std::size_t header = number_at<std::uint32_t>(bytes, at);
    const std::size_t payload = number_at<std::uint32_t>(bytes, at + 4);
    if (header + payload > bytes.size() - at - 12) break;
    parts.emplace_back(bytes.substr(at + 12, header));
    parts.emplace_back(bytes.substr(at + 12 + header, payload));
    at += 12 + header + payload;
  }
  return parts;
}

string join_wire(const Parts& parts) {
  string bytes;
  for (std::size_t i = 0; i + 1 < parts.size(); i += 2) {
    append(bytes, static_cast<std::uint32_t>(parts[i].size()));
    append(bytes, static_cast<std::uint32_t>(parts[i + 1].size()));
    const string body = parts[i] + parts[i + 1];
    append(bytes, geometry::compute_crc32(body));
    bytes += body;
  }
  return bytes;
}

// Messages of a session in the notation of the target: the sensor, then header and payload,
// alternating.
Parts split_session(string_view bytes) {
  if (bytes.empty()) return {};
  Parts parts{string(bytes.substr(0, 1)), ""};
  for (std::size_t at = 1; at < bytes.size() && parts.size() < 64;) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    parts.emplace_back(bytes.substr(at, end - at));
    const std::size_t size = number_at<std::uint16_t>(bytes, end + 1);
    const std::size_t begin = std::min(end + 3, bytes.size());
    parts.emplace_back(bytes.substr(begin, size));
    at = begin + parts.back().size();
  }
  return parts;
}

string join_session(const Parts& parts) {
  string bytes = parts.front().substr(0, 1);
  for (std::size_t i = 2; i + 1 < parts.size(); i += 2) {
    string header = parts[i];
    std::ranges::replace(header, '\n', ' ');
    const string payload = parts[i + 1].substr(0, 65535);
    bytes += header + "\n";
    append(bytes, static_cast<std::uint16_t>(payload.size()));
    bytes += payload;
  }
  return bytes;
}

// Binary glTF: the JSON chunk and the binary chunk.
Parts split_glb(string_view bytes) {
  if (!bytes.starts_with("glTF")) return {};
  Parts parts;
  for (std::size_t at = 12; at + 8 <= bytes.size() && parts.size() < 8;) {
    const std::size_t size = number_at<std::uint32_t>(bytes, at);
    parts.emplace_back(bytes.substr(at + 8, size));
    at += 8 + size;
  }
  return parts;
}

string join_glb(const Parts& parts) {
  string body;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    string part = parts[i];
    part.resize((part.size() + 3) / 4 * 4, i == 0 ? ' ' : '\0');
    append(body, static_cast<std::uint32_t>(part.size()));
    body += (i == 0 ? string("JSON") : string("BIN\0", 4)) + part;
  }
  string bytes = string("glTF\2\0\0\0", 8);
  append(bytes, static_cast<std::uint32_t>(12 + body.size()));
  return bytes + body;
}

using Content = Structure::Content;

constexpr std::string_view trees[] = {
    "plan",          "geojson",     "cityjson",  "summary",     "trial",          "prepared",
    "checkpoint",    "page_survey", "page_scan", "page_trials", "page_benchmark", "page_district",
    "other_results", "kml",         "citygml",   "flown_gpx",   "imported_kml",   "imported_plan",
    "map_geojson",   "map_kml",     "map_osm",   "scene_gltf",  "scene_dae",      "mission",
    "sensor",        "vehicle",     "campaign",  "district",    "photo_camera",   "tiles",
    "mission_edit",  "rewrite",     "studio",    "tally",       "mesh_offset",    "ifc_facts"};
constexpr std::string_view tables[] = {"waypoints",    "litchi",
                                       "csv",          "tum",
                                       "views",        "log",
                                       "flown_csv",    "flown_mrk",
                                       "flown_srt",    "flown_tum",
                                       "parameters",   "sequence",
                                       "timetable",    "imported_csv",
                                       "flight_csv",   "control_points",
                                       "profile",      "survey_journal",
                                       "live_journal", "mesh_obj",
                                       "mesh_off",     "cloud_xyz",
                                       "map_dxf",      "raster_asc",
                                       "raster_xyz",   "pose"};
constexpr std::string_view ply[] = {"mesh_ply", "cloud_ply", "kept_scan"}, pcd[] = {"cloud_pcd"},
                           zip[] = {"kmz"}, gzips[] = {"gzip"}, png[] = {"depth_png"},
                           e57[] = {"cloud_e57", "prior_e57"},
                           las[] = {"cloud_las", "cloud_laz", "prior_las"},
                           dataflash[] = {"dataflash", "flown_dataflash"}, ulog[] = {"flown_ulog"},
                           mavlink[] = {"mavlink"}, wire[] = {"wire"}, session[] = {"session"},
                           records[] = {"records"}, glb[] = {"gltf_facts"};

constexpr Structure structures[] = {
    {"tree", trees, Content::text, split_whole, joined},
    {"table", tables, Content::text, split_lines, joined},
    {"ply", ply, Content::mixed, split_ply, joined},
    {"pcd", pcd, Content::mixed, split_pcd, joined},
    {"zip", zip, Content::text, split_zip, join_zip},
    {"gzip", gzips, Content::text, split_gzip, join_gzip},
    {"png", png, Content::binary, split_png, join_png},
    {"e57", e57, Content::mixed, split_e57, join_e57},
    {"las", las, Content::binary, split_las, join_las},
    {"dataflash", dataflash, Content::binary, split_dataflash, joined},
    {"ulog", ulog, Content::binary, split_ulog, join_ulog},
    {"mavlink", mavlink, Content::binary, split_mavlink, join_mavlink},
    {"wire", wire, Content::mixed, split_wire, join_wire},
    {"session", session, Content::mixed, split_session, join_session},
    {"records", records, Content::text, split_records, join_records},
    {"glb", glb, Content::mixed, split_glb, join_glb},
};

/// Piece of a text, as a position and a length.
struct Piece {
  std::size_t at = 0, size = 0;
};

/// Returns the end of the bracketed or quoted JSON value at a position.
std::size_t find_value_end(string_view text, std::size_t at) {
  int depth = 0;
  bool is_quoted = false;
  for (std::size_t i = at; i < text.size(); ++i) {
    const char c = text[i];
    if (is_quoted && c == '\\') {
      ++i;
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted) {
      depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    }
    if (depth == 0 && !is_quoted) return i + 1;
  }
  return text.size();
}

/// Returns the end of the XML element at a position.
std::size_t find_element_end(string_view text, std::size_t at) {
  const std::size_t name_end = text.find_first_of(" \t\r\n/>", at + 1);
  const std::size_t head = text.find('>', at);
  if (name_end == string_view::npos || head == string_view::npos) return text.size();
  if (text[head - 1] == '/') return head + 1;
  const string close = "</" + string(text.substr(at + 1, name_end - at - 1)) + ">";
  const std::size_t end = text.find(close, head);
  return end == string_view::npos ? head + 1 : end + close.size();
}

/// Returns the end of the line at a position and of the more deeply indented lines after it.
std::size_t find_block_end(string_view text, std::size_t at) {
  const auto indent = [&](std::size_t line) {
    const std::size_t first = text.find_first_not_of(' ', line);
    return (first == string_view::npos ? text.size() : first) - line;
  };
  const std::size_t depth = indent(at);
  std::size_t end = at;
  do {
    end = std::min(text.find('\n', end), text.size() - 1) + 1;
  } while (end < text.size() && indent(end) > depth);
  return end;
}

/// Returns the element at or after a random position: a JSON value, an XML element, or a line with
/// its block.
Piece pick_element(string_view text, std::mt19937& random) {
  const std::size_t at = random() % text.size();
  if (random() % 3 != 0) {
    const std::size_t begin = text.find_first_of("{[\"<", at);
    if (begin != string_view::npos) {
      const bool is_xml = text[begin] == '<' && begin + 1 < text.size() && text[begin + 1] != '/';
      if (text[begin] != '<') return {begin, find_value_end(text, begin) - begin};
      if (is_xml) return {begin, find_element_end(text, begin) - begin};
    }
  }
  const std::size_t line = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
  return {line, find_block_end(text, line) - line};
}

/// Returns the number at or after a random position, with size 0 if there is none.
Piece pick_number(string_view text, std::mt19937& random) {
  const std::size_t at = text.find_first_of("0123456789", random() % text.size());
  if (at == string_view::npos) return {};
  const std::size_t begin = at > 0 && text[at - 1] == '-' ? at - 1 : at;
  const std::size_t end = std::min(text.find_first_not_of("0123456789.eE+-", at), text.size());
  return {begin, end - begin};
}

/// Returns the word at or after a random position.
Piece pick_word(string_view text, std::mt19937& random) {
  const auto is_letter = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':';
  };
  std::size_t begin = random() % text.size();
  while (begin < text.size() && !is_letter(text[begin])) ++begin;
  while (begin > 0 && begin < text.size() && is_letter(text[begin - 1])) --begin;
  std::size_t end = begin;
  while (end < text.size() && is_letter(text[end])) ++end;
  return {begin, end - begin};
}

void change_text(string& text, std::mt19937& random) {
  static constexpr std::array<string_view, 24> values = {
      "0",     "1",     "-1",   "2",     "0.5",        "3",          "255",     "256",
      "65536", "1e308", "-1e9", "1e-30", "4294967296", "2147483647", "nan",     "inf",
      "true",  "false", "null", "[]",    "{}",         "\"\"",       "[1,2,3]", "~"};
  const Piece number = pick_number(text, random), element = pick_element(text, random),
              other = pick_element(text, random), word = pick_word(text, random),
              source = pick_word(text, random);
  const string copy = text.substr(other.at, other.size), name = text.substr(source.at, source.size);
  switch (random() % 8) {
    case 0:
    case 1:
      text.replace(number.at, number.size, values[random() % 16]);
      break;
    case 2:
      text.erase(element.at, element.size);
      break;
    case 3:
      text.insert(element.at, text.substr(element.at, element.size));
      break;
    case 4:
      text.replace(element.at, element.size, copy);
      break;
    case 5:
      text.insert(element.at, copy);
      break;
    case 6:
      text.replace(word.at, word.size, name);
      break;
    default:
      text.replace(element.at, element.size, values[random() % values.size()]);
  }
}

bool is_text(string_view part) {
  return std::ranges::none_of(part.substr(0, 512), [](char c) { return c >= 0 && c < 9; });
}

void change_part(Content content, string& part, std::mt19937& random, std::size_t max,
                 Mutate mutate) {
  const bool changes_text =
      content == Content::text || (content == Content::mixed && is_text(part));
  if (changes_text && !part.empty() && random() % 4 != 0) return change_text(part, random);
  if (part.size() < 16 || random() % 4 == 0) {
    part = mutate(std::move(part), max);
    return;
  }
  // A short window of the same length, so that other positions keep their meaning.
  const std::size_t size = 1 + random() % 8, at = random() % (part.size() - size);
  string window = mutate(part.substr(at, size), size);
  window.resize(size, '\0');
  part.replace(at, size, window);
}

}  // namespace

const Structure* find_structure(string_view reader) {
  for (const Structure& structure : structures) {
    if (std::ranges::find(structure.readers, reader) != structure.readers.end()) return &structure;
  }
  return nullptr;
}

std::span<const Structure> all_structures() { return structures; }

std::string mutated(const Structure& structure, string_view input, std::mt19937& random,
                    std::size_t max, Mutate mutate) {
  Parts parts = structure.split(input);
  if (parts.empty()) return mutate(string(input), max);
  for (auto changes = 1 + random() % 3; changes > 0; --changes) {
    const std::size_t i = random() % parts.size(), other = random() % parts.size();
    const auto choice = parts.size() == 1 ? 9 : random() % 10;
    if (choice == 0) {
      parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(i), string(parts[other]));
    } else if (choice == 1) {
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
    } else if (choice == 2) {
      std::swap(parts[i], parts[other]);
    } else {
      change_part(structure.content, parts[i], random, max, mutate);
    }
  }
  const string output = structure.join(parts);
  return output.size() <= max ? output : mutate(string(input), max);
}

}  // namespace skycap::fuzz

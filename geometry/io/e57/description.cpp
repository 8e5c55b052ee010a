#include "geometry/io/e57/description.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string_view>

#include <pugixml.hpp>

#include "geometry/io/e57/pages.h"

namespace skycap::geometry::e57 {
namespace {

using std::string_view;

constexpr std::size_t max_fields = 1000;  // maximum per record; typical files have about 20

/// Returns a part of a file's text on one line in quotes, for messages.
std::string in_quotes(string_view text) {
  std::string result(text.substr(0, 60));
  for (char& c : result) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7F') c = ' ';
  }
  return '\'' + result + '\'';
}

string_view trimmed(string_view text) {
  constexpr string_view blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Parses a number. Empty text is zero, as required by the standard.
template <typename Number>
Number parse_number(string_view text, const std::string& what) {
  text = trimmed(text);
  if (text.empty()) return Number{};
  if (text.starts_with('+')) text.remove_prefix(1);
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, failure] = std::from_chars(text.data(), end, number);
  if (failure != std::errc() || stop != end) {
    throw_bad_file("has the " + what + " " + in_quotes(text) + ", which is not a valid number");
  }
  return number;
}

double finite_number(string_view text, const std::string& what) {
  const auto number = parse_number<double>(text, what);
  if (!std::isfinite(number)) throw_bad_file("has a " + what + " that is not finite");
  return number;
}

template <typename Number>
Number attribute_or(const pugi::xml_node& node, const char* name, Number otherwise) {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute) return otherwise;
  return parse_number<Number>(attribute.value(),
                              std::string(name) + " of " + in_quotes(node.name()));
}

/// Returns the number in a child of an element, or zero if it does not exist.
double child_number(const pugi::xml_node& node, const char* name) {
  const pugi::xml_node child = node.child(name);
  return finite_number(child.text().get(), std::string(name) + " of a " + node.name());
}

Coding read_coding(const pugi::xml_node& node) {
  const string_view type = node.attribute("type").value();
  if (type == "Integer") return Coding::integer;
  if (type == "ScaledInteger") return Coding::scaled_integer;
  if (type == "String") return Coding::text;
  const string_view precision = node.attribute("precision").value();
  if (type == "Float" && precision == "single") return Coding::single_precision;
  if (type == "Float" && (precision.empty() || precision == "double")) {
    return Coding::double_precision;
  }
  throw_bad_file("has records with a field " + in_quotes(node.name()) + " of type " +
                 in_quotes(type) +
                 "; it must be Integer, ScaledInteger, Float (single or double) or String");
}

Field parse_field(const pugi::xml_node& node) {
  Field field{node.name(), read_coding(node)};
  if (field.coding != Coding::integer && field.coding != Coding::scaled_integer) return field;
  field.minimum = attribute_or(node, "minimum", field.minimum);
  field.maximum = attribute_or(node, "maximum", field.maximum);
  if (field.minimum > field.maximum) {
    throw_bad_file("has a field " + in_quotes(field.name) + " whose minimum is above its maximum");
  }
  if (field.coding == Coding::integer) return field;
  field.scale = attribute_or(node, "scale", field.scale);
  field.offset = attribute_or(node, "offset", field.offset);
  if (!std::isfinite(field.scale) || !std::isfinite(field.offset)) {
    throw_bad_file("has a field " + in_quotes(field.name) + " whose scale or offset is not finite");
  }
  return field;
}

/// Returns whether the rotation is four zeros, which some programs write instead of the identity.
bool is_zero_rotation(const pugi::xml_node& pose) {
  const pugi::xml_node rotation = pose.child("rotation");
  const auto is_zero = [&](const char* name) { return child_number(rotation, name) == 0.0; };
  return rotation && is_zero("w") && is_zero("x") && is_zero("y") && is_zero("z");
}

Eigen::Isometry3d parse_pose(const pugi::xml_node& pose) {
  Eigen::Isometry3d file_from_scan = Eigen::Isometry3d::Identity();
  const pugi::xml_node rotation = pose.child("rotation");
  if (rotation && !is_zero_rotation(pose)) {
    const Eigen::Quaterniond turn(child_number(rotation, "w"), child_number(rotation, "x"),
                                  child_number(rotation, "y"), child_number(rotation, "z"));
    constexpr double tolerance = 0.01;  // tolerance of rounded quaternions
    if (std::abs(turn.norm() - 1.0) > tolerance) {
      throw_bad_file("has a scan whose rotation quaternion has length " +
                     std::to_string(turn.norm()) +
                     "; it must be 1: save the scan again with a valid pose or without a pose");
    }
    file_from_scan.linear() = turn.normalized().toRotationMatrix();
  }
  if (const pugi::xml_node translation = pose.child("translation")) {
    file_from_scan.translation() =
        Eigen::Vector3d(child_number(translation, "x"), child_number(translation, "y"),
                        child_number(translation, "z"));
  }
  return file_from_scan;
}

std::optional<Interval> parse_limits(const pugi::xml_node& limits, const std::string& colour) {
  const pugi::xml_node low = limits.child(("color" + colour + "Minimum").c_str()),
                       high = limits.child(("color" + colour + "Maximum").c_str());
  if (!low || !high) return std::nullopt;
  return Interval{finite_number(low.text().get(), low.name()),
                  finite_number(high.text().get(), high.name())};
}

ScanDescription parse_scan(const pugi::xml_node& node, const pugi::xml_node& points) {
  ScanDescription scan;
  scan.file_from_scan = parse_pose(node.child("pose"));
  scan.section = attribute_or(points, "fileOffset", std::uint64_t{0});
  scan.records = attribute_or(points, "recordCount", std::uint64_t{0});
  for (const pugi::xml_node field : points.child("prototype").children()) {
    if (field.type() != pugi::node_element) continue;
    scan.fields.push_back(parse_field(field));
    if (scan.fields.size() > max_fields) {
      throw_bad_file("has records with more than " + std::to_string(max_fields) + " fields");
    }
  }
  const pugi::xml_node limits = node.child("colorLimits");
  scan.colour_limits = {parse_limits(limits, "Red"), parse_limits(limits, "Green"),
                        parse_limits(limits, "Blue")};
  return scan;
}

}  // namespace

unsigned Field::bits() const {
  switch (coding) {
    case Coding::integer:
    case Coding::scaled_integer:
      return static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(maximum) -
                                                  static_cast<std::uint64_t>(minimum)));
    case Coding::single_precision:
      return 32;
    case Coding::double_precision:
      return 64;
    case Coding::text:
      break;
  }
  return 0;
}

double Field::value(std::uint64_t stored) const {
  if (coding == Coding::double_precision) return std::bit_cast<double>(stored);
  if (coding == Coding::single_precision) {
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(stored)));
  }
  const auto whole = static_cast<std::int64_t>(static_cast<std::uint64_t>(minimum) + stored);
  return static_cast<double>(whole) * scale + offset;
}

std::optional<std::size_t> ScanDescription::field(const std::string& name) const {
  const auto found = std::ranges::find(fields, name, &Field::name);
  if (found == fields.end()) return std::nullopt;
  return static_cast<std::size_t>(found - fields.begin());
}

Description parse_description(std::string xml) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer_inplace(
      xml.data(), xml.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    throw_bad_file("has damaged XML at byte " + std::to_string(result.offset) + ": " +
                   result.description());
  }
  const pugi::xml_node root = document.child("e57Root");
  if (!root) throw_bad_file("has no XML element e57Root");
  Description description;
  description.reference_system = trimmed(root.child("coordinateMetadata").text().get());
  for (const pugi::xml_node node : root.child("data3D").children()) {
    const pugi::xml_node points = node.child("points");
    if (!points) continue;
    ScanDescription scan = parse_scan(node, points);
    if (scan.records == 0) continue;
    description.scans.push_back(std::move(scan));
    if (is_zero_rotation(node.child("pose"))) ++description.zero_rotations;
  }
  return description;
}

}  // namespace skycap::geometry::e57

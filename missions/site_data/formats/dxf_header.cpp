#include "missions/site_data/formats/dxf_header.h"

#include <algorithm>
#include <array>
#include <string>

#include "geometry/io/text/plain_text.h"

namespace skycap::missions::site_data {
namespace {

using std::string_view;

struct Unit {
  int number;
  double metres;
  const char* name;
};

constexpr double us_foot = 1200.0 / 3937.0;
constexpr std::array<Unit, 19> units{{{1, 0.0254, "the inch"},
                                      {2, 0.3048, "the foot"},
                                      {3, 1609.344, "the mile"},
                                      {4, 0.001, "the millimetre"},
                                      {5, 0.01, "the centimetre"},
                                      {6, 1.0, "the metre"},
                                      {7, 1000.0, "the kilometre"},
                                      {8, 0.0254e-6, "the microinch"},
                                      {9, 0.0254e-3, "the mil"},
                                      {10, 0.9144, "the yard"},
                                      {13, 1e-6, "the micrometre"},
                                      {14, 0.1, "the decimetre"},
                                      {15, 10.0, "the decametre"},
                                      {16, 100.0, "the hectometre"},
                                      {17, 1e9, "the gigametre"},
                                      {21, us_foot, "the US survey foot"},
                                      {22, us_foot / 12.0, "the US survey inch"},
                                      {23, 3.0 * us_foot, "the US survey yard"},
                                      {24, 5280.0 * us_foot, "the US survey mile"}}};

/// Reader of the line pairs of a DXF file: a code and its value.
class Pairs {
 public:
  explicit Pairs(string_view text) : text_(geometry::without_mark(text)) {}

  bool next() {
    if (at_ >= text_.size()) return false;
    code = line();
    value = line();
    return true;
  }
  string_view code, value;

 private:
  string_view line() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    const string_view found = geometry::trimmed(text_.substr(at_, end - at_));
    at_ = end + (text_.substr(end).starts_with("\r\n") ? 2 : 1);
    return found;
  }
  string_view text_;
  std::size_t at_ = 0;
};

struct Header {
  std::optional<int> unit;  ///< $INSUNITS
  bool is_imperial = false;
  std::size_t thick = 0;  ///< Number of entities with a thickness.
};

Header parse_header(string_view text) {
  Header header;
  string_view variable, section;
  for (Pairs pair(text); pair.next();) {
    if (pair.code == "2" && (pair.value == "HEADER" || pair.value == "ENTITIES")) {
      section = pair.value;
    }
    if (pair.code == "0" && pair.value == "ENDSEC") section = {};
    if (pair.code == "9") variable = pair.value;
    const auto number = geometry::number_in(pair.value);
    if (!number) continue;
    const bool is_header = section == "HEADER" && pair.code == "70";
    if (is_header && variable == "$INSUNITS") header.unit = static_cast<int>(*number);
    if (is_header && variable == "$MEASUREMENT") header.is_imperial = *number == 0.0;
    if (section == "ENTITIES" && pair.code == "39" && *number != 0.0) ++header.thick;
  }
  return header;
}

}  // namespace

void apply_dxf_unit(const std::filesystem::path& file, string_view text, bool has_unit,
                    FileContents& contents) {
  const Header header = parse_header(text);
  if (header.thick > 0) {
    contents.notes.push_back(std::to_string(header.thick) +
                             " entities have a thickness, which is ignored; set height");
  }
  if (has_unit) return;
  if (header.unit.value_or(0) == 0) {
    contents.notes.push_back(std::string("missing unit ($INSUNITS); metres are assumed") +
                             (header.is_imperial
                                  ? ", although $MEASUREMENT is imperial; set unit to change this"
                                  : "; set unit to change this"));
    return;
  }
  const auto unit = std::ranges::find(units, *header.unit, &Unit::number);
  if (unit == units.end()) {
    fail_file(file, "has an unknown unit: $INSUNITS " + std::to_string(*header.unit) +
                        "; set unit to the length of one unit in metres");
  }
  contents.unit = unit->metres;
  contents.notes.push_back(std::string("linear unit: ") + unit->name + " ($INSUNITS)");
}

}  // namespace skycap::missions::site_data

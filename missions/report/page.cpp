#include "missions/report/page.h"

#include <string_view>
#include <utility>

#include "missions/report/page_parts.h"
#include "missions/report/point_figures.h"
#include "missions/report/script_text.h"
#include "missions/version.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const CloudCode& code) {
  Json attributes = Json::array();
  for (const CloudCode::Attribute& attribute : code.attributes) {
    attributes.push_back({{"name", attribute.name}, {"values", attribute.values}});
  }
  return {
      {"points", code.points},   {"of", code.of},
      {"bits", code.bits},       {"origin", {code.origin.x(), code.origin.y(), code.origin.z()}},
      {"step", code.step},       {"spacing", code.spacing},
      {"attributes", attributes}};
}

/// Returns a script element that contains data.
std::string data_block(std::string_view type, const std::string& id, std::string_view text) {
  std::string block = "<script type=\"";
  block.append(type).append("\" id=\"").append(id).append("\">").append(text);
  return block + "</script>\n";
}

/// Beginning of the element with the input of page/main.js.
constexpr std::string_view data_begin = R"(<script type="application/json" id="data">)";

/// Returns a compressed library. Uncompressed, libraries are a third of the report.
std::string library_block(const PageLibrary& library) {
  return data_block("application/octet-stream", "library-" + std::string(library.name),
                    base64(deflated(library.text, Repetition::any)));
}

std::string policy() {
  std::string text =
      "default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; script-src";
  for (const PageLibrary& library : page_libraries()) text += " " + policy_hash(library.text);
  text += " " + policy_hash(page_script());
  return text + "; style-src " + policy_hash(page_style());
}

/// Parts shared by all reports. Reports without a cloud omit the 3-D view.
struct ConstantParts {
  std::string policy_text = policy();
  std::string libraries, chart_library;

  ConstantParts() {
    for (const PageLibrary& library : page_libraries()) {
      const std::string block = library_block(library);
      libraries += block;
      if (library.name == "chart") chart_library = block;
    }
  }
};

}  // namespace

std::string page_text(const std::string& title, Json data, const std::vector<PageCloud>& clouds) {
  static const ConstantParts constant;
  data["version"] = version;
  data["scales"] = point_scales();
  data["clouds"] = Json::object();
  std::string blocks;
  for (const PageCloud& cloud : clouds) {
    data["clouds"][cloud.name] = to_json(cloud.code);
    blocks +=
        data_block("application/octet-stream", "cloud-" + cloud.name, base64(cloud.code.bytes));
  }
  std::string page;
  const std::string_view frame = page_frame();
  for (std::size_t at = 0; at < frame.size();) {
    const std::size_t mark = frame.find("{{", at);
    page += frame.substr(at, mark - at);
    if (mark == std::string_view::npos) break;
    const std::size_t end = frame.find("}}", mark);
    const std::string_view name = frame.substr(mark + 2, end - mark - 2);
    if (name == "title") page += html_text(title);
    if (name == "policy") page += constant.policy_text;
    if (name == "style") page.append("<style>").append(page_style()).append("</style>");
    if (name == "data") page += data_block("application/json", "data", script_json(data));
    if (name == "clouds") page += blocks;
    if (name == "libraries") {
      page += clouds.empty() ? constant.chart_library : constant.libraries;
    }
    if (name == "script") page.append("<script>").append(page_script()).append("</script>");
    at = end + 2;
  }
  return page;
}

std::string with_background(std::string page, const std::string& name, std::string_view jpeg,
                            const std::array<Eigen::Vector2d, 4>& corners) {
  Json points = Json::array();
  for (const Eigen::Vector2d& corner : corners) points.push_back({corner.x(), corner.y()});
  const Json data{
      {"name", name}, {"corners", points}, {"image", "data:image/jpeg;base64," + base64(jpeg)}};
  const std::size_t at = page.find(data_begin);
  if (at != std::string::npos) {
    page.insert(at, data_block("application/json", "background", script_json(data)));
  }
  return page;
}

}  // namespace skycap::missions::report

#include "missions/report/object_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/surfaces/mesh.h"
#include "missions/report/script_text.h"

namespace skycap::missions::report {
namespace {

using Eigen::Vector2d;
using Json = nlohmann::ordered_json;

constexpr const char* style = R"(body{margin:0;font:14px system-ui,sans-serif;color:#222}
header{padding:8px 12px;border-bottom:1px solid #ccc}
h1{font-size:16px;margin:0 0 6px}
#command{display:block;padding:6px 8px;background:#f2f2f2;user-select:all;overflow-wrap:anywhere}
svg{display:block;width:100vw;height:calc(100vh - 110px);background:#fafafa;touch-action:none}
path{fill:#8a6d4f;stroke:none;cursor:pointer}
path:hover{fill:#c46a1b}
path:focus{outline:none;stroke:#111;stroke-width:3px;vector-effect:non-scaling-stroke}
path.chosen{fill:#1b6fc4}
)";

constexpr const char* script =
    R"js(const map = JSON.parse(document.getElementById("map").textContent);
const svg = document.querySelector("svg"), shown = document.getElementById("command");
const about = document.getElementById("about");
let chosen = null;
// In skycap studio, the page is in a frame and the surrounding page uses the selection.
const tell = (message) => { if (parent !== window) parent.postMessage(message, "*"); };
for (const object of map.objects) {
  const path = document.createElementNS(svg.namespaceURI, "path");
  path.setAttribute("d", object.outline);
  const title = document.createElementNS(svg.namespaceURI, "title");
  title.textContent = object.id + " (" + object.height + " m high)";
  path.append(title);
  path.setAttribute("tabindex", "0");
  path.setAttribute("role", "button");
  path.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    path.dispatchEvent(new MouseEvent("click"));
  });
  path.addEventListener("click", () => {
    if (chosen) chosen.classList.remove("chosen");
    chosen = path;
    path.classList.add("chosen");
    shown.textContent = map.command + " --id " + object.quoted;
    about.textContent = object.id + ", " + object.height + " m high" +
        object.attributes.map((each) => ", " + each).join("");
    tell({object: object.id});
  });
  svg.append(path);
}
tell({objects: map.objects.map((object) => object.id)});
const [x, y, width, height] = map.view;
let view = {x, y, width, height};
const show = () => svg.setAttribute("viewBox", [view.x, view.y, view.width, view.height].join(" "));
show();
svg.addEventListener("wheel", (event) => {
  event.preventDefault();
  const scale = event.deltaY > 0 ? 1.25 : 0.8;
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  view = {x: at.x - (at.x - view.x) * scale, y: at.y - (at.y - view.y) * scale,
          width: view.width * scale, height: view.height * scale};
  show();
}, {passive: false});
svg.addEventListener("pointermove", (event) => {
  if (event.buttons !== 1) return;
  const metres = 1 / svg.getScreenCTM().a;
  view.x -= event.movementX * metres;
  view.y -= event.movementY * metres;
  show();
});
)js";

/// Returns text in single quotes for a POSIX shell.
std::string shell_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

/// Returns the triangles of a mesh, seen from above, as an SVG path in decimetres: x east, y south.
std::string compute_outline(const geometry::Mesh& mesh) {
  std::string path;
  for (const auto& triangle : mesh.triangles) {
    std::array<long, 6> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d& vertex = mesh.vertices[triangle[i]];
      corners[2 * i] = std::lround(10.0 * vertex.x());
      corners[2 * i + 1] = std::lround(-10.0 * vertex.y());
    }
    const long across = (corners[2] - corners[0]) * (corners[5] - corners[1]) -
                        (corners[4] - corners[0]) * (corners[3] - corners[1]);
    if (across == 0) continue;  // Vertical triangle.
    // All triangles have the same orientation, so that none is a hole in another.
    if (across < 0) {
      std::swap(corners[2], corners[4]);
      std::swap(corners[3], corners[5]);
    }
    path += fmt::format("M{} {}L{} {} {} {}Z", corners[0], corners[1], corners[2], corners[3],
                        corners[4], corners[5]);
  }
  return path;
}

Json to_json(const site_data::Object& object, const Eigen::AlignedBox3d& box) {
  constexpr std::size_t max_attributes = 12;
  Json attributes = Json::array();
  for (const auto& [name, value] : object.attributes) {
    if (attributes.size() < max_attributes) attributes.push_back(name + ": " + value);
  }
  return {{"id", object.id},
          {"quoted", shell_quoted(object.id)},
          {"height", std::round(10.0 * box.sizes().z()) / 10.0},
          {"attributes", attributes},
          {"outline", compute_outline(object.mesh)}};
}

}  // namespace

std::string object_map(const std::string& title, const std::vector<site_data::Object>& objects,
                       const std::string& command) {
  Eigen::AlignedBox3d all;
  Json list = Json::array();
  for (const site_data::Object& object : objects) {
    if (!site_data::has_area(object.mesh)) continue;
    const Eigen::AlignedBox3d box = geometry::bounding_box(object.mesh);
    all.extend(box);
    list.push_back(to_json(object, box));
  }
  constexpr double margin = 5.0;  // [m]
  Json view = Json::array();
  if (!all.isEmpty()) {
    view = {10.0 * (all.min().x() - margin), -10.0 * (all.max().y() + margin),
            10.0 * (all.sizes().x() + 2.0 * margin), 10.0 * (all.sizes().y() + 2.0 * margin)};
  }
  const std::size_t count = list.size();
  const Json data{{"command", command}, {"view", view}, {"objects", std::move(list)}};
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><meta http-equiv=\"Content-Security-Policy\" "
      "content=\"default-src 'none'; script-src {}; style-src {}\"><title>{}</title>"
      "<style>{}</style></head>\n<body><header><h1>{}: {} objects. Click the object to survey. "
      "Zoom with the mouse wheel; drag to move the map</h1><code id=\"command\">{}</code><span "
      "id=\"about\"></span>"
      "</header><svg></svg>\n<script type=\"application/json\" id=\"map\">{}</script>\n"
      "<script>{}</script></body></html>\n",
      policy_hash(script), policy_hash(style), html_text(title), style, html_text(title), count,
      html_text(command), script_json(data), script);
}

}  // namespace skycap::missions::report

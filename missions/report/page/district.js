// District report: map, table of targets, and the flight of all targets (district.json).

/// Colours of coverage, from low to full, for all kinds of colour vision.
const coverage_steps = [[0.5, "#d7301f"], [0.8, "#fc8d59"], [0.9, "#fdcc8a"], [0.95, "#9ecae1"], [0.98, "#4292c6"], [2, "#08519c"]];
const not_surveyed = "#ae017e";

/// Covered fraction of a target's surface. If the visible surface is known, it is the reference,
/// because shared walls between houses are not visible.
const covered_share = (survey) => survey.coverage_visible ?? survey.coverage;

function coverage_colour(target) {
  return target.survey ? coverage_steps.find(([to]) => covered_share(target.survey) < to)[1] : not_surveyed;
}

const reaching = (to, i) => (i === 0 ? "below " + percent(to) + " %" : i === coverage_steps.length - 1
  ? percent(coverage_steps[i - 1][0]) + " % and more" : percent(coverage_steps[i - 1][0]) + " to " + percent(to) + " %");

/// Returns an SVG element.
function drawn(tag, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children.flat().filter(Boolean));
  return made;
}

// North is up, so y is negated in SVG.
const map_place = ([x, y]) => x.toFixed(1) + " " + (-y).toFixed(1);
const ring_path = (rings) => rings.map((ring) => "M" + ring.map(map_place).join("L") + "Z").join("");
const way_path = (points) => "M" + points.map(map_place).join("L");

/// Returns the box of the map: all outlines of targets, pads and routes, with a margin.
function map_box(summary) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  const take = ([x, y]) => {
    box[0] = Math.min(box[0], x); box[1] = Math.min(box[1], -y);
    box[2] = Math.max(box[2], x); box[3] = Math.max(box[3], -y);
  };
  summary.targets.forEach((target) => target.outlines.forEach((ring) => ring.forEach(take)));
  summary.pads.forEach(take);
  sorties_of_district(summary).forEach(({ sortie }) => sortie.legs.forEach((leg) => leg.points.forEach(take)));
  const rim = 0.04 * Math.max(box[2] - box[0], box[3] - box[1], 10);
  return [box[0] - rim, box[1] - rim, box[2] - box[0] + 2 * rim, box[3] - box[1] + 2 * rim];
}

/// Returns [{pad, number, sortie, path}]. `path` is the path of the sortie in the summary.
function sorties_of_district(summary) {
  if (!summary.flight) return [];
  return summary.flight.pads.flatMap((pad, p) => pad.sorties.map((sortie, i) => (
    { pad, number: i + 1, sortie, path: "flight.pads." + p + ".sorties." + i + "." })));
}

const report_of = (target) => target.survey.folder + "/report.html";

function target_mark(target) {
  const mark = drawn("path", { d: ring_path(target.outlines), fill: coverage_colour(target), "fill-rule": "evenodd", class: "target" },
    drawn("title", {}, target.title + (target.survey ? ", " + shown(covered_share(target.survey), "share") + ", " + target.survey.views + " views" : ": " + target.why_none)));
  return target.survey ? drawn("a", { href: report_of(target) }, mark) : mark;
}

/// Returns a round length for the scale bar, about a fifth of the map's width.
function round_length(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].map((digit) => digit * power).find((length) => length <= most) || power;
}

function scale_mark([x, y, width, height], unit) {
  const length = round_length(0.2 * width), left = x + 8 * unit, low = y + height - 10 * unit;
  return drawn("g", { class: "scale" }, drawn("path", { d: "M" + left + " " + low + "h" + length, "stroke-width": 2 * unit }),
    drawn("text", { x: left, y: low - 5 * unit, "font-size": 12 * unit }, length + " m"));
}

function district_map(data) {
  const { summary } = data, box = map_box(summary), unit = box[2] / 1000;
  const sorties = sorties_of_district(summary);
  const ways = sorties.map(({ pad, number, sortie }, i) => drawn("path", {
    d: sortie.legs.map((leg) => way_path(leg.points)).join(""), class: "way", stroke: chart_colours[i % chart_colours.length] },
    drawn("title", {}, "sortie " + number + " from pad " + (pad.pad + 1) + ", " + shown(sortie.duration_s, "minutes"))));
  const stops = sorties.flatMap(({ sortie }) => sortie.legs.slice(1).map((leg) => leg.points[0]))
    .map(([x, y]) => drawn("circle", { cx: x.toFixed(1), cy: (-y).toFixed(1), r: (2.2 * unit).toFixed(2), class: "stop" }));
  const pads = summary.pads.map(([x, y], i) => drawn("g", { class: "pad" },
    drawn("circle", { cx: x, cy: -y, r: 8 * unit }), drawn("text", { x, y: -y + 4 * unit, "font-size": 11 * unit, "text-anchor": "middle" }, String(i + 1))));
  return drawn("svg", { viewBox: box.map((value) => value.toFixed(2)).join(" "), class: "map", role: "img", "aria-label": "Map of the district" },
    drawn("path", { d: ring_path(summary.neighbours), class: "neighbour", "fill-rule": "evenodd" }),
    summary.targets.map(target_mark), ways, stops, pads, scale_mark(box, unit));
}

function map_legend(summary) {
  const entry = (colour, text) => element("span", {}, colour_mark(colour), text);
  const used = new Set(summary.targets.map(coverage_colour));
  const knows_visible = summary.targets.some((target) => target.survey && target.survey.coverage_visible !== null);
  return element("p", { class: "legend-line" },
    coverage_steps.map(([to, colour], i) => (used.has(colour) ? entry(colour, reaching(to, i) + (knows_visible ? " of visible surface" : "") + " covered") : null)),
    used.has(not_surveyed) ? entry(not_surveyed, "not surveyed") : null,
    summary.neighbours.length ? entry("#c3cad1", "obstacle") : null);
}

function map_section(data) {
  return element("section", { id: "map" }, element("h2", {}, "Map"), map_legend(data.summary),
    district_map(data), element("p", {}, "North is up. Numbers are take-off points; lines are sorties, with a dot at each view. Click a target to open the report of its survey."));
}

function target_table(data) {
  const number = (content) => ({ number: content }), { summary } = data;
  const rows = summary.targets.map((target, i) => {
    const path = "targets." + i + ".", f = (key, form) => number(figure(data, path + key, form));
    const name = element("span", {}, colour_mark(coverage_colour(target)),
      target.survey ? element("a", { href: report_of(target) }, target.title) : target.title);
    const views = target.survey ? target.survey.views : 0;
    return [name, number(String(target.ids.length)), f("survey.views", "count"), f("survey.coverage", "share"), f("survey.coverage_visible", "share"), f("survey.alone_duration_s", "minutes"),
      number(target.survey ? target.views_flown + " of " + views : "–"), target.why_none || target.why_not_flown];
  });
  return table(["target", number("buildings"), number("views"), number("covered"), number("of visible surface"), number("separate flight"), number("views in the flight"), "remark"], rows);
}

function targets_of_district(data) {
  return element("section", { id: "targets" }, element("h2", {}, "Targets"), target_table(data));
}

function district_flight_section(data) {
  const { flight } = data.summary, number = (content) => ({ number: content });
  if (!flight) return element("section", { id: "flight" }, element("h2", {}, "Flight"), element("p", {}, "No flight."));
  const rows = sorties_of_district(data.summary).map(({ pad, number: sortie_number, sortie, path }) => {
    const f = (key, form) => number(figure(data, path + key, form));
    const files = pad.files.filter((file) => file.sortie === sortie_number - 1);
    return ["pad " + (pad.pad + 1) + ", " + sortie_number, number(String(sortie.last_station - sortie.first_station + 1)),
      f("length_m", "metres"), f("duration_s", "minutes"), f("energy_wh", "watt_hours"), f("energy_left_wh", "watt_hours"), f("min_clearance_m", "metres"),
      element("span", {}, files.flatMap((file, i) => [i ? " " : "", element("a", { href: file.name }, file.name.split(".").pop())]))];
  });
  const homes = flight.pads.map((pad, p) => ["pad " + (pad.pad + 1), number(String(pad.stations)),
    number(figure(data, "flight.pads." + p + ".return.height_m", "metres")), number(figure(data, "flight.pads." + p + ".return.clearance_m", "metres")),
    pad.parameters.join(", ")]);
  return element("section", { id: "flight" }, element("h2", {}, "Flight of all targets"),
    element("p", {}, "By " + flight.vehicle + ": ", figure(data, "flight.views_flown", "count"), " of ", figure(data, "flight.views", "count"), " views, ",
      figure(data, "flight.length_m", "metres"), " in ", figure(data, "flight.duration_s", "minutes"), ". Minimum clearance, verified for every leg: ", figure(data, "flight.clearance_m", "metres"), "."),
    table(["sortie", number("views"), number("length"), number("time"), number("energy"), number("left"), number("minimum clearance"), "files"], rows),
    element("h3", {}, "Return to launch"), table(["from", number("views"), number("return altitude"), number("minimum clearance"), "parameters"], homes),
    flight.notes.length ? element("ul", {}, [...new Set(flight.notes)].map((note) => element("li", {}, note))) : null);
}

const how_district = [
  ["Covered", "Fraction of samples, evenly distributed over the mapped buildings of a target, that have a measurement within the coverage distance in the simulation."],
  ["Separate flight", "Flight time of the target's own mission, from its own take-off point."],
  ["Views in the flight", "Views of this target that are part of the joint flight. Every leg keeps the clearance from all measured points, from unknown space inside the unknown boxes, and from the map, enlarged by its uncertainty."],
];

function district_sections(data) {
  return [map_section(data), targets_of_district(data), district_flight_section(data), files_section(data), how_section(how_district)];
}

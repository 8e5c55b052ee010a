// The page's tables.

/// rows: lists of cells; a cell is text, an element, or {number: text}.
function table(headings, rows, attributes_of = () => ({})) {
  const cell = (tag, content) => (content && content.number !== undefined
    ? element(tag, { class: "number" }, content.number)
    : element(tag, {}, content));
  return element("div", { class: "scroll" }, element("table", {},
    element("thead", {}, element("tr", {}, headings.map((heading) => cell("th", heading)))),
    element("tbody", {}, rows.map((row, i) => element("tr", attributes_of(i),
      row.map((content) => cell("td", content)))))));
}

/// A mark in a colour of style sheets.
function colour_mark(colour) {
  const mark = element("span", { class: "swatch" });
  mark.style.background = colour;
  return mark;
}

const reason_text = Object.fromEntries(states.map((state) => [state.key, state.name]));
const reason_colour = Object.fromEntries(states.map((state) => [state.key, state.colour]));
/// Of holes after the first few those of less than a share of all that is missing are summed, and
/// all after so many.
const fewest_holes = 12, least_hole = 0.01, most_holes = 40;

/// What is missing, piece by piece; the column of areas sums to the missing share.
function holes_section(data, on_pick) {
  const surface = data.summary.surface;
  if (!surface) return null;
  const holes = surface.holes, path = (i, name) => "surface.holes." + i + "." + name;
  const number = (content) => ({ number: content });
  const share = (area) => number(shown(surface.area_m2 > 0 ? area / surface.area_m2 : 0, "share"));
  const total = holes.reduce((sum, hole) => sum + hole.area_m2, 0) + surface.smaller.area_m2 + surface.rest_m2;
  const shown_holes = holes.slice(0, most_holes)
    .filter((hole, i) => i < fewest_holes || hole.area_m2 >= least_hole * total);
  const has_places = data.hole_places.length > 0;
  const place = (i) => data.hole_places[i].slice(0, 2).map((degrees) => shown(degrees, "place")).join(", ") +
    ", " + shown(data.hole_places[i][2], "metres");
  const rows = shown_holes.map((hole, i) => [
    element("span", {}, swatch(reason_colour[hole.reason]), reason_text[hole.reason]),
    number(figure(data, path(i, "area_m2"), "square_metres")), share(hole.area_m2),
    places_text(hole.centre), ...(has_places ? [place(i)] : []),
    number(hole.nearest_view + ", " + shown(hole.view_distance_m, "metres")), seen_from(data, hole)]);
  const rest = holes.slice(shown_holes.length);
  const rest_area = rest.reduce((sum, hole) => sum + hole.area_m2, 0) + surface.smaller.area_m2;
  const wide = (text, area, form_path) => [text, number(form_path ? figure(data, form_path, "square_metres")
    : shown(area, "square_metres")), share(area), "", ...(has_places ? [""] : []), "", ""];
  rows.push(wide((rest.length + surface.smaller.holes) + " smaller ones", rest_area));
  rows.push(wide("spread over covered surface", surface.rest_m2, "surface.rest_m2"));
  rows.push(wide("missing in all", total));
  const headings = ["why", number("area"), number("of surface"), "centre x, y, z [m]", ...(has_places ? ["latitude, longitude, height"] : []),
    number("nearest view"), "would be seen from"];
  const who = surface.known_by === "planner" ? "as the planner believes" : "as the simulator knows";
  return element("section", { id: "holes" }, element("h2", {}, "What is missing"),
    element("p", {}, "Of " , figure(data, "surface.area_m2", "square_metres"), " of surface, " + who +
      ". Click a row to go there."),
    table(headings, rows, (i) => {
      if (i < shown_holes.length) return { class: "pick", "data-hole": String(i), onclick: () => on_pick(i) };
      return i === rows.length - 1 ? { class: "sum", id: "missing-sum", "data-area": String(total) } : {};
    }));
}

/// What was to be surveyed, by the mission's prior data.
function targets_section(data) {
  const { targets } = data.summary;
  if (!targets || !targets.length) return null;
  const number = (content) => ({ number: content });
  const rows = targets.flatMap((target, i) => {
    const path = "targets." + i + ".";
    const cells = (part, at, name) => [name, number(figure(data, at + "area_m2", "square_metres")),
      number(figure(data, at + "coverage", "share")), number(shown(target.within_m, "metres"))];
    return [cells(target, path, target.name),
      ...target.kinds.map((kind, k) => cells(kind, path + "kinds." + k + ".", target.name + ", " + kind.name))];
  });
  const dry = data.summary.settings["scene.model"] === "prior"
    ? " They also stood in for the truth: this was a dry run." : "";
  return element("section", { id: "targets" }, element("h2", {}, "Targets"),
    element("p", {}, "The surface that prior data has, and its share with a measurement near it." + dry),
    table(["object", number("area"), number("covered"), number("within")], rows));
}

/// Where a sensor would have to be to look at a hole head-on, as far off as its nearest view.
function seen_from(data, hole) {
  if (!hole.normal.some((part) => part !== 0)) return "no one side";
  const distance = Math.min(hole.view_distance_m || 10, 30);
  const place = hole.centre.map((part, axis) => part + distance * hole.normal[axis]);
  const has_ground = data.scene && (data.scene.flown || data.summary.settings["scene.ground"]);
  if (has_ground && place[2] < data.scene.ground) return "below";
  return places_text(place);
}

/// Sorties that trajectories and KML files fly past their views.
function passage_parts(data) {
  return sorties_of(data).map((sortie, i) => {
    if (!sortie.passage) return null;
    const f = (path, form) => figure(data, "flight.route.sorties." + i + ".passage." + path, form);
    return element("p", {}, "The trajectory and KML files fly sortie " + (i + 1) + " past its views: ", f("length_m", "metres"),
      " in ", f("duration_s", "minutes"), ", proven free at ", f("clearance_m", "metres"), "; stops between: ",
      f("stops", "count"), ". The other files stop at each view.");
  }).filter(Boolean);
}

/// The mission whose views were chosen anew beside that through the survey's views.
function anew_parts(data) {
  const { anew } = data.summary.flight;
  if (!anew) return [];
  const number = (content) => ({ number: content });
  const f = (path, form) => number(figure(data, "flight.anew." + path, form));
  const row = (name, key) => [name, f(key + ".views", "count"), f(key + ".pieces", "count"), f(key + ".length_m", "metres"),
    f(key + ".duration_s", "minutes"), f(key + ".promised_coverage", "share")];
  const again = value_at(anew, "flown_again.coverage_visible");
  return [element("h3", {}, "Views chosen anew"),
    table(["", "views", "from stop to stop", "length", "time", "expected of what was measured"].map((name, i) => (i ? number(name) : name)),
      [row("the survey's views", "survey"), row(anew.is_flown ? "chosen anew, flown" : "nothing faster was found", "anew")]),
    typeof again === "number" ? element("p", {}, "Flown again in the simulator, the mission covers ",
      figure(data, "flight.anew.flown_again.coverage_visible", "share"), " of what is visible.") : null].filter(Boolean);
}

/// Several vehicles that fly the mission together.
function fleet_parts(data) {
  const { fleet } = data.summary.flight;
  if (!fleet) return [];
  const number = (content) => ({ number: content });
  const f = (path, form) => figure(data, "flight.fleet." + path, form);
  const vehicles = table(["vehicle", number("views"), number("sorties"), number("length"), number("time"), number("energy"),
    number("least clearance"), number("comes home at"), "files"], fleet.vehicles.map((vehicle, i) => {
    const name = element("span", {}, swatch(vehicle_colour(i)), (i + 1) + ", " + vehicle.vehicle);
    if (!vehicle.order.length) return [name, number("0"), ...Array(6).fill(number("–")), "stays on the ground"];
    const flown = (key, form) => number(f("vehicles." + i + "." + key, form));
    return [name, number(String(vehicle.order.length)), number(String(vehicle.sorties.length)),
      flown("length_m", "metres"), flown("duration_s", "minutes"), flown("energy_wh", "watt_hours"),
      flown("min_clearance_m", "metres"), flown("return_height_m", "metres"), vehicle.files.join(", ")];
  }));
  const times = table(["vehicle", "sortie", number("takes off"), number("lands"), "file"], fleet.timetable.map((row, i) => [
    String(row.vehicle), String(row.sortie), number(f("timetable." + i + ".start_s", "clock")),
    number(f("timetable." + i + ".landing_s", "clock")), row.file]));
  const missed = fleet.unreached.map((one) => element("li", {}, "view " + one.view + ": " + one.reason));
  return [element("h3", {}, "Several vehicles"),
    element("p", {}, "The last one lands ", f("makespan_s", "minutes"), " after the first take-off; together they are ",
      f("flown_s", "minutes"), " in the air. They are proven ", f("separation.proven_m", "metres"), " apart at all times (asked: ",
      f("separation.asked_m", "metres"), ") as long as each is within ", f("separation.tolerance_s", "clock"),
      " of its times; the last lands ", f("delay_s", "clock"), " later for it."),
    vehicles, element("p", {}, "By the clock of the first take-off:"), times, missed.length ? element("ul", {}, missed) : null].filter(Boolean);
}

/// The flight that measured, before the mission that is written.
function surveyed_part(data) {
  const frames = (data.summary.per_view || []).reduce((sum, view) => sum + (view.frames_on_way || 0), 0);
  return element("p", {}, "The survey itself flew ", figure(data, "flight.survey.length_m", "metres"), " in ",
    figure(data, "flight.survey.duration_s", "minutes"), ", from the pad to the last view" +
    (frames ? ", and took " + frames + " frames on the way. The mission takes pictures at its views only, and covers less." : "."));
}

function flight_section(data) {
  const { flight } = data.summary;
  if (!flight) return null;
  const section = element("section", { id: "flight" }, element("h2", {}, "Flight"));
  if (flight.failure) {
    section.append(element("p", { class: "notice" }, "There is no route: " + flight.failure));
    return section;
  }
  const number = (content) => ({ number: content });
  const f = (path, form) => figure(data, "flight." + path, form);
  section.append(element("p", {}, "With ", f("vehicle", "text"), ": ", f("route.length_m", "metres"), " in ",
    f("route.duration_s", "minutes"), ", ", f("route.energy_wh", "watt_hours"),
    ". Every leg is proven free, with ", f("clearance_m.total", "metres"), " to spare; the least is ",
    f("route.min_clearance_m", "metres"), "."), surveyed_part(data));
  section.append(table(["sortie", "stations", number("length"), number("time"), number("energy"),
    number("left above reserve"), number("least clearance")], sorties_of(data).map((sortie, i) => {
    const path = "route.sorties." + i + ".";
    return [String(i + 1), sortie.first_station + " to " + sortie.last_station,
      number(f(path + "length_m", "metres")), number(f(path + "duration_s", "minutes")),
      number(f(path + "energy_wh", "watt_hours")), number(f(path + "energy_left_wh", "watt_hours")),
      number(f(path + "min_clearance_m", "metres"))];
  })));
  section.append(...passage_parts(data), ...anew_parts(data), ...fleet_parts(data));
  const terms = [["vehicle's radius", "vehicle_radius"], ["position error", "position_error"],
    ["tracking error", "tracking_error"], ["map error", "map_error"], ["margin", "margin"], ["together", "total"]];
  section.append(element("h3", {}, "What the clearance is made of"),
    table(terms.map(([name]) => number(name)), [terms.map(([, key]) => number(f("clearance_m." + key, "metres")))]));
  if (flight.return) {
    const home = flight.return;
    section.append(element("h3", {}, "The way home"), element("p", {}, "From every point of the route the autopilot's own return is proven at ",
      f("return.height_m", "metres"), " above the pad; the least clearance is ", f("return.clearance_m", "metres"),
      ", from " + (home.nearest.obstacle || "nothing near") + ". It takes at most ", f("return.energy_wh", "watt_hours"), "."));
  }
  const missed = flight.route.unreached || [], listed = 8;
  if (missed.length) {
    const why = table(["view", "why"], missed.map((one) => [String(one.view), one.reason]));
    section.append(element("h3", {}, "Views that are not flown to"), missed.length <= listed ? why
      : element("details", {}, element("summary", {}, "All " + missed.length), why));
  }
  if ((flight.notes || []).length) {
    section.append(element("h3", {}, "Notes"), element("ul", {}, flight.notes.map((note) => element("li", {}, note))));
  }
  section.append(element("h3", {}, "Route files"), table(["file", "heights count", number("time as flown by it"), number("least clearance")],
    (flight.files || []).map((file, i) => [file.name, file.heights,
      number(f("files." + i + ".duration_s", "minutes")), number(f("files." + i + ".min_clearance_m", "metres"))])));
  return section;
}

function accuracy_section(data) {
  const { accuracy } = data;
  if (!accuracy || !Object.keys(accuracy).length) return null;
  const { incidence_deg, range_m, error_m } = accuracy;
  const is_learnt = value_at(data, "summary.belief.noise_m") > 0;
  const millimetres = error_m && { counts: error_m.counts, low: 0, high: 1000 * error_m.high };
  return element("section", { id: "accuracy" }, element("h2", {}, "Accuracy"),
    is_learnt ? element("p", {}, "The planner has learnt that a measurement head-on strays by ",
      figure(data, "belief.noise_m", "millimetres"), " (standard deviation).") : null,
    element("div", { class: "charts" },
      error_m ? histogram_chart("Predicted error of the surface", "Standard error where the points within the registration distance are averaged; " +
        (is_learnt ? "of the noise that the planner has learnt." : "of the noise that the mission states."), millimetres, "mm", 3) : null,
      incidence_deg ? histogram_chart("Angle of incidence", "Between the surface's normal and the way to the sensor: flat looks measure badly.", incidence_deg, "degrees", 0) : null,
      range_m ? histogram_chart("Range", "How far the sensor was from the points it took.", range_m, "m", 2) : null));
}

function files_section(data) {
  if (!(data.files || []).length) return null;
  return element("section", { id: "files" }, element("h2", {}, "Files"),
    table(["file", { number: "size" }, "SHA-256"], data.files.map((file) => [file.name,
      { number: shown(file.bytes, "bytes") }, element("span", { class: "code" }, file.sha256 || "not taken of an interrupted scan")])));
}

const setting_text = (value) => (typeof value === "string" ? value : JSON.stringify(value));

function settings_section(data) {
  const settings = data.summary.settings;
  if (!settings) return null;
  return element("section", { id: "settings" }, element("details", { class: "settings" },
    element("summary", {}, "All settings in force"),
    table(["key", "value"], Object.entries(settings).map(([key, value]) => [key, setting_text(value)]))));
}

/// How the figures are computed: in the page, for whoever has nothing else.
const how_surveyed = [
  ["Coverage, as the planner believes", "Area of the surface that was measured or is guessed to be there, each piece times the probability that it has a measurement within the registration distance, over the whole area."],
  ["Coverage, true", "Of points spread evenly over the simulated model's surface, the share with a measurement within evaluation.registration_distance. The planner never sees it. Of what is visible: of those points that a sensor could see from some admissible place."],
  ["What is missing", "Pieces of surface that are more likely uncovered than covered hang together if they are near each other and missing for the same reason. Their area is the missing part of each piece. The rest is what even covered surface is expected to lack. All together is the surface's area times one less the coverage."],
  ["Proven clearance", "For every leg a lower bound of the distance between the vehicle's centre and anything measured, forbidden, or not yet seen free, over the whole leg, not only at its ends."],
  ["Times and energy", "Of the vehicle's profile, with stops, turns and hovering, in the wind and at the temperature that the mission gives."],
  ["Predicted error", "At a sample of the points: the root of the summed squares of the noise across the surface of all points within the registration distance, over their number. The noise is what the planner has learnt head-on, else what the mission states (sensor.noise); along a ray it counts by the cosine of the incidence. What neighbours have in common, such as an error of the sensor's place, is not in it."],
  ["Incidence and range", "From each point's normal, the plane through its neighbours, and the place of the sensor that took it."],
  ["End of free space", "The faces of the voxels that were measured to be free, beyond which nothing was seen or something is; of many an even choice. The route is proven to keep its clearance from all of them."],
  ["Density", "Neighbours of a point within " + density_reach + " times the usual spacing, over that disc's area, scaled up if the page shows only some of the points."],
];

const how_compared = [
  ["Mean, ± and sd", "Over the trials: the mean, half the width of its 95 % interval by Student's t, and the standard deviation. Bands around curves are one standard deviation."],
  ["Coverage", "Of points spread evenly over the simulated model's surface, the share with a measurement within evaluation.registration_distance; of the visible: of those that a sensor could see from some admissible place; of the attainable: over what all admissible views together would cover. Along a curve a survey that is over keeps its coverage."],
  ["Distance", "Straight from view to view, from the first on."],
  ["Planning", "The planner's own work for all views of a survey, in seconds of a processor; sensing and files are not in it."],
  ["Paper", "Means of 100 surveys each in Border and Gammell, SEE++ (2020), where the mission is one of its models, or as the mission file says."],
];

function how_section(how) {
  return element("section", { id: "how" }, element("details", {}, element("summary", {}, "How each figure is computed"),
    element("dl", { class: "how" }, how.flatMap(([term, text]) => [element("dt", {}, term), element("dd", {}, text)]))));
}

// Tables of the page.

/// Returns a table. `rows` contains lists of cells. A cell is a string, an element, or {number:
/// string}.
function table(headings, rows, attributes_of = () => ({})) {
  const cell = (tag, content) => (content && content.number !== undefined
    ? element(tag, { class: "number" }, content.number)
    : element(tag, {}, content));
  return element("div", { class: "scroll" }, element("table", {},
    element("thead", {}, element("tr", {}, headings.map((heading) => cell("th", heading)))),
    element("tbody", {}, rows.map((row, i) => element("tr", attributes_of(i),
      row.map((content) => cell("td", content)))))));
}

/// Returns a colour sample with a CSS colour.
function colour_mark(colour) {
  const mark = element("span", { class: "swatch" });
  mark.style.background = colour;
  return mark;
}

const reason_text = Object.fromEntries(states.map((state) => [state.key, state.name]));
const reason_colour = Object.fromEntries(states.map((state) => [state.key, state.colour]));
/// After the first few, holes below a fraction of the missing area are summed up. The list ends
/// after the maximum number.
const fewest_holes = 12, least_hole = 0.01, most_holes = 40;

/// Returns the coverage and the largest gaps of each route file format, compared with the survey.
function written_parts(data) {
  const { written } = data.summary.flight;
  if (!written || !written.length) return [];
  const number = (content) => ({ number: content });
  const rows = [["Survey", number(figure(data, "views", "count")), number(figure(data, "coverage", "share")),
    number(figure(data, "coverage_visible", "share"))]];
  const parts = [];
  written.forEach((part, i) => {
    const path = "flight.written." + i + ".";
    const names = written.length === 1 ? "Route files" : part.files.join(", ");
    rows.push([names, number(part.views + " of " + part.planned_views), number(figure(data, path + "coverage", "share")),
      number(figure(data, path + "coverage_visible", "share"))]);
    for (const [k, target] of part.targets.entries()) {
      rows.push([names + ", " + target.name, "", number(figure(data, path + "targets." + k + ".coverage", "share")), ""]);
    }
    const holes = part.surface.holes.slice(0, fewest_holes);
    if (!holes.length) return;
    const gaps = table(["Reason", number("Area"), "Centre x, y, z [m]"], holes.map((hole, k) => [
      element("span", {}, swatch(reason_colour[hole.reason]), reason_text[hole.reason]),
      number(figure(data, path + "surface.holes." + k + ".area_m2", "square_metres")), places_text(hole.centre)]));
    parts.push(element("details", {}, element("summary", {}, "Uncovered by " + (written.length === 1 ? "the route files"
      : part.files.join(", "))), gaps));
  });
  return [element("h3", {}, "Coverage of the route files"),
    element("p", {}, "Each route file is read back and re-flown in simulation, starting from an empty cloud. The table lists the resulting coverage."),
    table(["", number("Views"), number("Coverage"), number("Coverage of visible surface")], rows), ...parts];
}

/// Lists the holes. The areas sum to the missing fraction.
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
  const place = (i) => data.hole_places[i].slice(0, 2).map((degrees, k) => shown(degrees, k ? "longitude" : "latitude")).join(", ") +
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
  const smaller = rest.length + surface.smaller.holes;
  if (smaller > 0) rows.push(wide(smaller + " smaller gaps", rest_area));
  if (surface.rest_m2 > 0) rows.push(wide("scattered gaps", surface.rest_m2, "surface.rest_m2"));
  rows.push(wide("total uncovered", total));
  const headings = ["Reason", number("Area"), number("Fraction of surface"), "Centre x, y, z [m]", ...(has_places ? ["Latitude, longitude, height"] : []),
    number("Nearest view"), "Suggested viewpoint"];
  const who = surface.known_by === "planner" ? "planner estimate" : "ground truth";
  return element("section", { id: "holes" }, element("h2", {}, "Uncovered surface"),
    element("p", {}, "Total surface " , figure(data, "surface.area_m2", "square_metres"), " (" + who +
      "). Click a row to show the gap."),
    table(headings, rows, (i) => {
      if (i < shown_holes.length) return { class: "pick", "data-hole": String(i), onclick: () => on_pick(i) };
      return i === rows.length - 1 ? { class: "sum", id: "missing-sum", "data-area": String(total) } : {};
    }));
}

/// Lists the targets from the mission's prior data.
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
    ? " The same data served as ground truth for the simulated sensor." : "";
  return element("section", { id: "targets" }, element("h2", {}, "Targets"),
    element("p", {}, "Surface area of each target in the prior data, and the fraction covered." + dry),
    table(["Object", number("Area"), number("Covered"), number("Coverage distance")], rows));
}

/// Returns the position from which a hole is visible perpendicularly, at the distance of its
/// nearest view.
function seen_from(data, hole) {
  if (!hole.normal.some((part) => part !== 0)) return "no dominant side";
  const distance = Math.min(hole.view_distance_m || 10, 30);
  const place = hole.centre.map((part, axis) => part + distance * hole.normal[axis]);
  const has_ground = data.scene && (data.scene.flown || data.summary.settings["scene.ground"]);
  if (has_ground && place[2] < data.scene.ground) return "below the ground";
  return places_text(place);
}

/// Returns the sorties that trajectories and KML files fly with fly-through capture.
function passage_parts(data) {
  return sorties_of(data).map((sortie, i) => {
    if (!sortie.passage) return null;
    const f = (path, form) => figure(data, "flight.route.sorties." + i + ".passage." + path, form);
    return element("p", {}, "Fly-through capture of sortie " + (i + 1) + " (trajectory and KML files only): ", f("length_m", "metres"),
      " in ", f("duration_s", "minutes"), ", clearance at least ", f("clearance_m", "metres"), "; stops: ",
      f("stops", "count"), ". In the other files, the vehicle stops at each view.");
  }).filter(Boolean);
}

/// Compares the replanned mission with the mission through the survey's views.
function replanned_parts(data) {
  const { replanned } = data.summary.flight;
  if (!replanned) return [];
  const number = (content) => ({ number: content });
  const f = (path, form) => number(figure(data, "flight.replanned." + path, form));
  const row = (name, key) => [name, f(key + ".views", "count"), f(key + ".pieces", "count"), f(key + ".length_m", "metres"),
    f(key + ".duration_s", "minutes"), f(key + ".predicted_coverage", "share"),
    typeof replanned[key].predicted_reflight === "number" ? f(key + ".predicted_reflight", "share") : number("")];
  const again = value_at(replanned, "reflight.coverage_visible");
  const passing = typeof replanned.fly_through_duration_s === "number";
  return [element("h3", {}, "Choice of the views"),
    replanned.reason ? element("p", {}, "The mission contains the " + (replanned.is_flown ? "replanned" : "survey") + " views: " + replanned.reason + ".") : null,
    table(["", "Views", "Segments", "Length", "Time", "Predicted coverage", "Points measured again"].map((name, i) => (i ? number(name) : name)),
      [row("Survey views", "survey"), row(replanned.is_flown ? "Replanned, in the mission" : "Replanned, not in the mission", "replanned")]),
    passing ? element("p", {}, "A fly-through of these views would take ", figure(data, "flight.replanned.fly_through_duration_s", "minutes"),
      ". The file of the autopilot cannot contain its curve (flight.style: fly-through).") : null,
    typeof again === "number" ? element("p", {}, "In a simulated re-flight, the mission covers ",
      figure(data, "flight.replanned.reflight.coverage_visible", "share"), " of the visible surface.") : null].filter(Boolean);
}

/// Returns the flight of several vehicles.
function fleet_parts(data) {
  const { fleet } = data.summary.flight;
  if (!fleet) return [];
  const number = (content) => ({ number: content });
  const f = (path, form) => figure(data, "flight.fleet." + path, form);
  const vehicles = table(["Vehicle", number("Views"), number("Sorties"), number("Length"), number("Time"), number("Energy"),
    number("Minimum clearance"), number("Return altitude"), "Files"], fleet.vehicles.map((vehicle, i) => {
    const name = element("span", {}, swatch(vehicle_colour(i)), (i + 1) + ", " + vehicle.vehicle);
    if (!vehicle.order.length) return [name, number("0"), ...Array(6).fill(number("–")), "not used"];
    const flown = (key, form) => number(f("vehicles." + i + "." + key, form));
    return [name, number(String(vehicle.order.length)), number(String(vehicle.sorties.length)),
      flown("length_m", "metres"), flown("duration_s", "minutes"), flown("energy_wh", "watt_hours"),
      flown("min_clearance_m", "metres"), flown("return_height_m", "metres"), vehicle.files.join(", ")];
  }));
  const times = table(["Vehicle", "Sortie", number("Take-off"), number("Landing"), "File"], fleet.timetable.map((row, i) => [
    String(row.vehicle), String(row.sortie), number(f("timetable." + i + ".start_s", "clock")),
    number(f("timetable." + i + ".landing_s", "clock")), row.file]));
  const missed = fleet.skipped_views.map((one) => element("li", {}, "view " + one.view + ": " + one.reason));
  return [element("h3", {}, "Fleet"),
    element("p", {}, "The last landing is ", f("makespan_s", "minutes"), " after the first take-off; the total flight time is ",
      f("flown_s", "minutes"), ". Verified minimum separation ", f("separation.proven_m", "metres"), " at all times (required ",
      f("separation.asked_m", "metres"), "), if each vehicle is at most ", f("separation.tolerance_s", "clock"),
      " early or late. The separation delays the last landing by ", f("delay_s", "clock"), "."),
    vehicles, element("p", {}, "Times from the first take-off:"), times, missed.length ? element("ul", {}, missed) : null].filter(Boolean);
}

/// Returns the survey flight, which precedes the exported mission.
function surveyed_part(data) {
  if (data.kind === "photos") return "";
  const frames = (data.summary.per_view || []).reduce((sum, view) => sum + (view.en_route_frames || 0), 0);
  return element("p", {}, "The survey flew ", figure(data, "flight.survey.length_m", "metres"), " in ",
    figure(data, "flight.survey.duration_s", "minutes"), ", from take-off to the last view" +
    (frames ? ", with " + frames + " en-route frames. The mission captures at its views only and covers less." : "."));
}

function flight_section(data) {
  const { flight } = data.summary;
  if (!flight) return null;
  const section = element("section", { id: "flight" }, element("h2", {}, "Flight"));
  if (flight.failure) {
    section.append(element("p", { class: "notice" }, "No route: " + flight.failure));
    return section;
  }
  const number = (content) => ({ number: content });
  const f = (path, form) => figure(data, "flight." + path, form);
  section.append(element("p", {}, "With ", f("vehicle", "text"), ": ", f("route.length_m", "metres"), " in ",
    f("route.duration_s", "minutes"), ", ", f("route.energy_wh", "watt_hours"),
    ". Minimum clearance ", f("route.min_clearance_m", "metres"), ", verified for every leg (required ",
    f("clearance_m.total", "metres"), ")." + (flight.waypoint_limit
      ? " " + flight.waypoint_limit.app + " needs one waypoint per photo and accepts at most " + flight.waypoint_limit.max_waypoints +
        " per file; each sortie has its own take-off, verified returns and landing." : "")), surveyed_part(data));
  section.append(table(["Sortie", "Views", number("Waypoints"), number("Length"), number("Time"), number("Energy"),
    number("Energy above reserve"), number("Minimum clearance")], sorties_of(data).map((sortie, i) => {
    const path = "route.sorties." + i + ".";
    return [String(i + 1), sortie.first_station + " to " + sortie.last_station, number(sortie.waypoints === undefined ? "" : f(path + "waypoints", "count")),
      number(f(path + "length_m", "metres")), number(f(path + "duration_s", "minutes")),
      number(f(path + "energy_wh", "watt_hours")), number(f(path + "energy_left_wh", "watt_hours")),
      number(f(path + "min_clearance_m", "metres"))];
  })));
  section.append(...written_parts(data), ...passage_parts(data), ...replanned_parts(data), ...fleet_parts(data));
  const terms = [["Vehicle radius", "vehicle_radius"], ["Position error", "position_error"],
    ["Tracking error", "tracking_error"], ["Map error", "map_error"], ["Margin", "margin"], ["Total", "total"]];
  section.append(element("h3", {}, "Clearance budget"),
    table(terms.map(([name]) => number(name)), [terms.map(([, key]) => number(f("clearance_m." + key, "metres")))]));
  if (flight.return) {
    const home = flight.return;
    section.append(element("h3", {}, "Return to launch"), element("p", {}, "Return altitude ",
      f("return.height_m", "metres"), " above take-off, verified from every point of the route, at this altitude only. Minimum clearance ",
      f("return.clearance_m", "metres"), " to " + (home.nearest.obstacle || "any obstacle") + ". Energy for return (maximum): ",
      f("return.energy_wh", "watt_hours"), "."));
  }
  const missed = flight.route.skipped_views || [], listed = 8;
  if (missed.length) {
    const why = table(["View", "Reason and remedy"], missed.map((one) => [String(one.view), one.reason]));
    section.append(element("h3", {}, "Views not in the mission"), missed.length <= listed ? why
      : element("details", {}, element("summary", {}, "All " + missed.length), why));
  }
  if ((flight.notes || []).length) {
    section.append(element("h3", {}, "Notes"), element("ul", {}, flight.notes.map((note) => element("li", {}, note))));
  }
  section.append(element("h3", {}, "Route files"), table(["File", "Altitude reference", number("Flight time"), number("Minimum clearance")],
    (flight.files || []).map((file, i) => [file.name, file.heights,
      number(f("files." + i + ".duration_s", "minutes")), number(f("files." + i + ".min_clearance_m", "metres"))])));
  return section;
}

function accuracy_section(data) {
  const { accuracy } = data;
  if (!accuracy || !Object.keys(accuracy).length) return null;
  const { incidence_deg, range_m, error_m } = accuracy;
  const is_learnt = value_at(data, "summary.estimate.noise_m") > 0;
  const millimetres = error_m && { counts: error_m.counts, low: 0, high: 1000 * error_m.high };
  return element("section", { id: "accuracy" }, element("h2", {}, "Accuracy"),
    is_learnt ? element("p", {}, "Measurement noise at perpendicular incidence, estimated by the planner: ",
      figure(data, "estimate.noise_m", "millimetres"), " (standard deviation).") : null,
    element("div", { class: "charts" },
      error_m ? histogram_chart("Predicted error of the surface", "Standard error if the points within the coverage distance are averaged, with the " +
        (is_learnt ? "noise estimated by the planner." : "noise of the mission (sensor.noise)."), millimetres, "mm", 3) : null,
      incidence_deg ? histogram_chart("Angle of incidence", "Angle between surface normal and ray. Large angles cause large errors.", incidence_deg, "degrees", 0) : null,
      range_m ? histogram_chart("Range", "Distance between sensor and points.", range_m, "m", 2) : null));
}

function files_section(data) {
  if (!(data.files || []).length) return null;
  return element("section", { id: "files" }, element("h2", {}, "Files"),
    table(["File", { number: "Size" }, "SHA-256"], data.files.map((file) => [file.name,
      { number: shown(file.bytes, "bytes") }, element("span", { class: "code" }, file.sha256 || "not computed for an interrupted scan")])));
}

const setting_text = (value) => (typeof value === "string" ? value : JSON.stringify(value));

function settings_section(data) {
  const settings = data.summary.settings;
  if (!settings) return null;
  return element("section", { id: "settings" }, element("details", { class: "settings" },
    element("summary", {}, "Settings"),
    table(["Key", "Value"], Object.entries(settings).map(([key, value]) => [key, setting_text(value)]))));
}

/// Definitions of the figures, for readers without the documentation.
const how_surveyed = [
  ["Coverage (planner estimate)", "Area of measured and predicted surface, weighted by the probability that it has a measurement within the coverage distance, divided by the total area."],
  ["Coverage (ground truth)", "Fraction of samples, evenly distributed over the surface of the simulated model, that have a measurement within the coverage distance. It is not used by the planner. Visible surface: samples that a sensor can see from an admissible view."],
  ["Uncovered surface", "Surface patches that are more likely uncovered than covered, grouped by neighbourhood and reason. The area of a gap is the uncovered part of its patches. Scattered gaps are the predicted uncovered part of covered surface. The total is the surface area times (1 - coverage)."],
  ["Verified clearance", "Lower bound of the distance from the vehicle centre to any measured point, no-fly volume or unknown space, over the whole leg."],
  ["Times and energy", "Estimates from the vehicle file, including stops, turns and hovering, for the wind and battery temperature of the mission."],
  ["Predicted error", "Standard error of the mean if all points within the coverage distance are averaged, for a sample of the points. It uses the noise estimated by the planner, otherwise sensor.noise; noise along a ray is multiplied by the cosine of the incidence. Correlated errors, such as a wrong sensor position, are not included."],
  ["Incidence and range", "Computed from the normal of each point (plane through its neighbours) and the sensor position of its scan."],
  ["Free-space boundary", "Faces between free voxels and unknown or occupied voxels; an evenly distributed subset if there are many. The route is verified to keep its clearance from all of them."],
  ["Density", "Number of neighbours within " + density_reach + " times the typical point spacing, divided by the area of a disc with this radius. Scaled up if the page shows a subset of the points."],
];

const how_compared = [
  ["Mean, ± and sd", "Mean over the trials, half width of its 95% confidence interval (Student's t), and standard deviation. Bands around curves are one standard deviation."],
  ["Coverage", "Fraction of samples, evenly distributed over the surface of the simulated model, that have a measurement within the coverage distance. Visible surface: samples that a sensor can see from an admissible view. Attainable coverage: coverage by all admissible views together. In the curves, a completed survey keeps its final coverage."],
  ["Distance", "Sum of the straight-line distances between consecutive views."],
  ["Planning", "Processor time of the planner for all views of a survey, without sensing and file access."],
  ["Paper", "Means of 100 surveys per model in Border and Gammell, SEE++ (2020), or values from the mission file."],
];

function how_section(how) {
  return element("section", { id: "how" }, element("details", {}, element("summary", {}, "Definitions"),
    element("dl", { class: "how" }, how.flatMap(([term, text]) => [element("dt", {}, term), element("dd", {}, text)]))));
}

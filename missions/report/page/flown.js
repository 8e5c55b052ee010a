// A flight that was compared with its plan: legs, captures, and the distance to the surface.

const planned_colour = [120, 160, 190], missed_colour = [238, 62, 66], track_colour = [236, 240, 243];

/// Returns the planned legs, those that were not flown, and the flown track. Only the first line of
/// each kind has a name.
function flown_lines(data) {
  const { legs, track } = data.summary;
  const lines = (list, colour, name) => list.map(({ points }, i) => ({ points, colour, name: i ? "" : name }));
  return [...lines(legs.filter((leg) => leg.flown), planned_colour, "planned leg"),
    ...lines(legs.filter((leg) => !leg.flown), missed_colour, "planned leg, not flown"),
    ...lines(track, track_colour, "flown track")];
}

function flown_section(data) {
  const { summary } = data, number = (content) => ({ number: content }), rows = [];
  const f = (path, form) => number(figure(data, path, form));
  const add = (name, path, form) => {
    if (typeof value_at(summary, path) === "number") rows.push([name, f(path, form)]);
  };
  add("flown time", "duration_s", "minutes");
  if (summary.has_plan) add("planned time", "planned_duration_s", "minutes");
  add("flown length", "length_m", "metres");
  if (summary.has_plan) add("planned captures", "captures.planned", "count");
  if (summary.has_plan) add("missed captures", "captures.missed", "count");
  add("captures without a plan", "captures.other", "count");
  add("required clearance", "clearance.required_m", "metres");
  add("minimum distance to the measured cloud", "clearance.min_cloud_distance_m", "metres");
  add("minimum distance to the model", "clearance.model.min_distance_m", "metres");
  for (const [key, name] of [["planned", "planned captures"], ["flown", "flown captures"], ["patched", "flown captures and patch mission"]]) {
    const path = "coverage." + key + ".";
    add("coverage by the " + name, path + "coverage", "share");
    add("coverage of the visible surface by the " + name, path + "coverage_visible", "share");
    add("expected completeness by the " + name, "photos." + key + ".expected_completeness", "share");
  }
  const notes = [...summary.warnings];
  if (summary.has_plan && summary.captures.planned && summary.captures.source === "assumed") {
    notes.push("The log contains no camera event. A capture is assumed at each stop that was reached");
  }
  return element("section", { id: "flown" }, element("h2", {}, "Flight"),
    notes.length ? element("ul", {}, notes.map((note) => element("li", {}, note + "."))) : null,
    element("div", { class: "few" }, table(["", number("")], rows)));
}

function flown_legs(data) {
  const { legs } = data.summary, number = (content) => ({ number: content });
  if (!legs.length) return null;
  const rows = legs.map((leg, i) => {
    const f = (name, form) => number(figure(data, "legs." + i + "." + name, form));
    return [leg.from + " to " + leg.to, leg.flown ? "flown" : element("b", {}, "not flown"), f("length_m", "metres"),
      f("planned_s", "clock"), f("duration_s", "clock"), f("max_error_m", "metres"), f("mean_error_m", "metres")];
  });
  return element("section", { id: "legs" }, element("h2", {}, "Legs"),
    table(["Leg", "", number("Length"), number("Planned time"), number("Flown time"), number("Maximum error"), number("Mean error")], rows));
}

function missed_captures(data) {
  const missed = data.summary.captures.list.filter((capture) => capture.missed);
  if (!missed.length) return null;
  const number = (content) => ({ number: content });
  return element("section", { id: "missed" }, element("h2", {}, "Missed captures"),
    table(["Item", "Planned position x, y, z [m]", "Reason", number("Deviation")], missed.map((capture) => [capture.item,
      places_text(capture.planned_position), capture.made ? "camera aimed elsewhere" : "not made",
      number(capture.made ? shown(capture.turned_deg, "degrees") : "–")])));
}

function flown_charts(data) {
  const { track, clearance } = data.summary, plain = { pointRadius: 0 };
  const series = (value) => track.flatMap((part) => [...part.times_s.map((time, i) => [time / 60, value(part, i)]), [NaN, NaN]]);
  const last = track[track.length - 1], end = last.times_s[last.times_s.length - 1] / 60;
  const distances = series((part, i) => (part.distances_m && part.distances_m[i] !== null ? part.distances_m[i] : NaN));
  return element("section", { id: "curves" }, element("h2", {}, "Curves"), element("div", { class: "charts" },
    track.some((part) => part.distances_m) ? chart("Distance to the surface", "Distance of the vehicle to the measured cloud, or to the model without a cloud. Without values at the take-off point.",
      "line", [line("distance", distances, 0, plain), level("required", 0, end, clearance.required_m, 4)], { x: "minutes", y: "m", y_more: { min: 0 } }) : null,
    chart("Height", "Height in the mission frame.", "line",
      [line("height", series((part, i) => part.points[i][2]), 0, plain)], { x: "minutes", y: "m", is_free: true })));
}

function patch_section(data) {
  const { patch } = data.summary, number = (content) => ({ number: content });
  if (!patch) return null;
  const f = (path, form) => figure(data, "patch." + path, form);
  const skipped = patch.skipped_views.map((one) => element("li", {}, "view " + one.view + ": " + one.reason));
  return element("section", { id: "patch" }, element("h2", {}, "Patch mission"),
    element("p", {}, f("waypoints", "count"), " of " + patch.views.length + " missed views, ", f("length_m", "metres"), " in ",
      f("duration_s", "minutes"), ", minimum clearance ", f("min_clearance_m", "metres"), ", verified for every leg."),
    skipped.length ? element("ul", {}, skipped) : null,
    table(["File", "Altitude reference", number("Flight time"), number("Minimum clearance")], patch.files.map((file, i) => [file.name, file.heights,
      number(f("files." + i + ".duration_s", "minutes")), number(f("files." + i + ".min_clearance_m", "metres"))])));
}

const how_flown = [
  ["Leg", "Planned path between two stops. A leg is flown if the vehicle followed it from stop to stop within the maximum deviation. The error is the distance of the track from the leg."],
  ["Missed capture", "Planned capture without a camera event at its position, or with a camera that looked elsewhere by more than half of its smaller field of view."],
  ["Coverage", "Fraction of the simulated surface that the sensor covers at the logged poses, with the motion blur of the flown speed."],
  ["Distance", "Distance of the vehicle's centre to the nearest point of the surface."],
];

function flown_sections(data, skycap) {
  return [flown_section(data), missed_captures(data), patch_section(data),
    holes_section(data, (number) => skycap.panel && skycap.panel.tell_hole(number)),
    flown_charts(data), flown_legs(data), files_section(data), settings_section(data), how_section(how_flown)];
}

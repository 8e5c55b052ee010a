// Parts of the report that only scans in flight have.

const flown_colour = [236, 240, 243], believed_colour = [88, 183, 224];

/// Returns the true and the estimated trajectory of the sensor, if they differ visibly.
function trajectory_lines(data) {
  if (data.kind === "flown") return flown_lines(data);
  if (!data.trajectory) return [];
  const { flown, believed } = data.trajectory, lines = [];
  const apart = Math.max(0, ...flown.points.map((point, i) =>
    (believed.points[i] ? vector(point).distanceTo(vector(believed.points[i])) : 0)));
  if (apart > 0.01) lines.push({ points: believed.points, colour: believed_colour, name: "trajectory, estimated" });
  lines.push({ points: flown.points, colour: flown_colour, name: "trajectory, ground truth" });
  return lines;
}

function scan_section(data) {
  const { summary } = data, f = (path, form) => ({ number: figure(data, path, form) });
  const number = (content) => ({ number: content }), rows = [];
  const add = (name, path, form) => {
    if (typeof value_at(summary, path) === "number") rows.push([name, f(path, form)]);
  };
  add("flight", "flight_s", "minutes");
  add("images taken", "images", "count");
  add("images planned", "images_planned", "count");
  add("shots", "shots", "count");
  add("points", "points", "count");
  if (summary.shots > 0) rows.push(["points per pulse", number((summary.points / summary.shots).toFixed(3))]);
  add("horizontal navigation error", "navigation.horizontal_sigma_m", "millimetres");
  add("vertical navigation error", "navigation.vertical_sigma_m", "millimetres");
  const shown_points = value_at(data, "clouds.measured.of");
  if (shown_points) rows.push(["points in the preview", number(shown(shown_points, "count"))]);
  return element("section", { id: "scan" }, element("h2", {}, "Scan"),
    element("div", { class: "few" }, table(["", number("")], rows)));
}

function scan_charts(data) {
  const { times, points } = data.trajectory.flown;
  if (times.length < 2) return null;
  const start = times[0], places = points.map(vector);
  const speeds = places.slice(1).map((place, i) => [(times[i] + times[i + 1]) / 2 - start,
    place.distanceTo(places[i]) / (times[i + 1] - times[i])]);
  const apart = data.trajectory.believed.points.map((point, i) => [times[i] - start,
    1000 * vector(point).distanceTo(places[Math.min(i, places.length - 1)])]);
  const x = "seconds", plain = { pointRadius: 0 };
  const pieces = data.pieces.map((piece) => [piece.time_s - start, piece.points]);
  return element("section", { id: "curves" }, element("h2", {}, "Curves"), element("div", { class: "charts" },
    chart("Height of the sensor", null, "line", [line("height", places.map((place, i) => [times[i] - start, place.z]), 0, plain)], { x, y: "m", is_free: true }),
    chart("Speed", null, "line", [line("speed", speeds, 0, plain)], { x, y: "m/s" }),
    pieces.length > 1 ? chart("Points over time", "Preview points per " + data.piece + ".", "line", [line("points", pieces, 0, plain)], { x, y: "points" }) : null,
    apart.some(([, off]) => off > 1) ? chart("Position error of the navigation solution", "Distance between the true and the estimated sensor position.",
      "line", [line("error", apart, 0, plain)], { x, y: "mm" }) : null));
}

const how_scanned = [
  ["Points", "Points of all pulses or pixels with a return. The page shows a preview: an evenly distributed subset of the points at their estimated positions."],
  ["Incidence", "Angle between the local surface normal at a point (plane through its neighbours) and the direction to the sensor at the middle of its flight segment."],
  ["Range", "Distance from a point to the sensor at the middle of its flight segment."],
  ["Speed", "Computed from consecutive poses of the trajectory. The page contains an evenly distributed subset of them."],
  ["Density", "Number of neighbours of a preview point within " + density_reach + " times the typical point spacing. It is divided by the area of a disc with this radius and by the fraction of displayed points. skycap evaluate --density counts all points."],
];

// Route profile: height, ground and clearance over the distance flown.

/// Returns steps over the pieces that `is_shown` accepts. A gap separates pieces that are not
/// neighbours.
function profile_line(profile, label, value, is_shown, number, more = {}) {
  const data = [];
  for (let i = 0; i < profile.end_m.length; ++i) {
    if (!is_shown(i)) {
      if (data.length && !Number.isNaN(data[data.length - 1].y)) data.push({ x: profile.begin_m[i], y: NaN });
      continue;
    }
    const note = profile.nearest[i] ? "; nearest: " + profile.nearest[i] : "";
    data.push({ x: profile.begin_m[i], y: value(i), note }, { x: profile.end_m[i], y: value(i), note });
  }
  return { ...line(label, [], number, { pointRadius: 0 }), data, ...more };
}

function height_profile(profile) {
  const heights = line("vehicle", [[0, 0], ...profile.end_m.map((end, i) => [end, profile.height_m[i]])], 0, { pointRadius: 0 });
  const ground = (i) => profile.ground_m[i];
  const lines = [heights,
    profile_line(profile, "ground (terrain data)", ground, (i) => profile.is_terrain[i], 8),
    profile_line(profile, "ground (assumed)", ground, (i) => !profile.is_terrain[i], 5, { borderDash: [4, 4] })]
    .filter((one) => one.data.length);
  return chart("Height along the route", "Heights above the take-off point. Assumed ground must be checked by the pilot.",
    "line", lines, { x: "metres flown", y: "m", is_free: true });
}

function clearance_profile(profile) {
  const end = profile.end_m[profile.end_m.length - 1];
  const is_unknown = (i) => profile.kind[i] === "unknown", is_open = (i) => profile.kind[i] === "not verified";
  const value = (i) => profile.clearance_m[i];
  const lines = [
    profile_line(profile, "nearest is an object or a limit of the airspace", value, (i) => !is_unknown(i) && !is_open(i), 0),
    profile_line(profile, "nearest is unknown space", value, is_unknown, 5, { borderDash: [3, 3] }),
    profile_line(profile, "not verified (climb and landing)", () => 0, is_open, 4, { borderWidth: 5 }),
    level("required", 0, end, profile.required_m, 4)].filter((one) => one.data.length);
  return chart("Verified clearance along the route", "Minimum distance of each piece of the route to objects, no-fly volumes, " +
    "the geofence and unknown space, limited to 10 m above the required clearance.",
    "line", lines, { x: "metres flown", y: "m", y_more: { min: 0 },
      tooltip: { label: (item) => item.dataset.label + ": " + shown(item.raw.y, "metres") + (item.raw.note || "") } });
}

/// Charts of the route: from profile.csv, or from the legs of the summary.
function route_charts(data) {
  const { profile } = data;
  if (!profile) return [clearance_chart(data)];
  return [height_profile(profile), clearance_profile(profile)];
}

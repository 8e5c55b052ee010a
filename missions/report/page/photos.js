// A photo mission: expected reconstruction, missing surface, patterns, and settings of the camera.

const photo_classes = [
  { name: "good", colour: [88, 176, 122] },
  { name: "weak", colour: [255, 176, 32] },
  { name: "missing", colour: [238, 62, 66] },
];

const missing_words = {
  occluded: "occluded from most free positions",
  stand_off: "too close to obstacles or outside the airspace",
  incidence: "visible only at more than the maximum incidence",
  gimbal: "outside the gimbal's range",
  height: "visible only from below the minimum height",
  not_taken: "attainable, but requires too many photos for its area",
};

function photo_warnings(data) {
  const { warnings } = data.summary;
  if (!warnings || !warnings.length) return null;
  return element("section", { id: "warnings" }, element("h2", {}, "Warnings"),
    element("ul", {}, warnings.map((warning) => element("li", {}, warning))));
}

function missing_section(data) {
  const number = (content) => ({ number: content });
  const reasons = Object.entries(data.summary.photo.not_satisfied).filter(([, reason]) => reason.area_m2 > 0);
  const rows = reasons.map(([key]) => {
    const path = "photo.not_satisfied." + key + ".";
    return [missing_words[key] || key, number(figure(data, path + "area_m2", "square_metres")),
      number(figure(data, path + "of_exposed", "share"))];
  });
  return element("section", { id: "missing" }, element("h2", {}, "Surface with too few stereo partners"),
    element("p", {}, "Exposed surface: ", figure(data, "photo.area_m2.exposed", "square_metres"), ", of which ",
      figure(data, "photo.area_m2.attainable", "square_metres"), " can be reconstructed from all candidate photos together."),
    rows.length ? table(["Reason", number("Area"), number("Fraction of exposed surface")], rows)
      : element("p", {}, "None."),
    element("p", {}, "Windows, glass, water, thin wires, vegetation and plain walls are not modelled."));
}

function pattern_section(data) {
  const number = (content) => ({ number: content }), { photo } = data.summary;
  const row = (name, figures, tour) => [name, number(figure(data, figures + "photos", "count")),
    number(figure(data, tour + "length_m", "metres")), number(figure(data, tour + "duration_s", "minutes")),
    number(figure(data, figures + "expected_completeness", "share")),
    number(figure(data, figures + "satisfied.of_exposed", "share"))];
  const rows = [row("plan", "photo.figures.", "photo.tour.")];
  photo.patterns.forEach((pattern, i) => {
    const path = "photo.patterns." + i + ".";
    rows.push(row(pattern.pattern, path + "figures.", path + "tour."),
      row(pattern.pattern + ", pruned", path + "pruned.", path + "pruned_tour."));
  });
  const bound = photo.bound && photo.bound.photos
    ? element("p", {}, "Lower bound for the same samples: ", figure(data, "photo.bound.photos", "count"), " photos.") : null;
  return element("section", { id: "patterns" }, element("h2", {}, "Plan and flight patterns"), bound,
    table(["", number("Photos"), number("Tour"), number("Time"), number("Expected completeness"), number("Satisfied")], rows));
}

function camera_section(data) {
  const number = (content) => ({ number: content }), { photo } = data.summary;
  if (!photo.capture) return null;
  const f = (path, form) => number(figure(data, "photo." + path, form));
  return element("section", { id: "camera" }, element("h2", {}, "Camera and storage"),
    table(["Setting", number("Value")], [
      ["Ground sampling distance", f("gsd_m", "millimetres")], ["View distance", f("view_distance_m", "metres")],
      ["Maximum exposure time", f("capture.exposure_s", "seconds")],
      ["Minimum time between photos", f("capture.min_interval_s", "seconds")],
      ["Speed at which motion blur is half a pixel", number(shown(photo.capture.blur_speed_m_s, "metres") + "/s")],
      ["Storage for JPEG photos (estimate)", f("capture.storage_bytes", "bytes")]]),
    element("p", {}, photo.capture.trigger));
}

function photo_charts(data) {
  const { photo } = data.summary, { histograms } = data;
  const curve = photo.curve.map((point) => [point.photos, percent(point.expected_completeness)]);
  const minutes = (photo.time_curve || []).filter((point) => point.tour_s > 0)
    .map((point) => [point.tour_s / 60, percent(point.expected_completeness)]);
  const y = { y: "% of exposed surface", y_more: { min: 0 } };
  const millimetres = { ...histograms.gsd_mm, low: 1000 * histograms.gsd_mm.low, high: 1000 * histograms.gsd_mm.high };
  return element("section", { id: "curves" }, element("h2", {}, "Curves"), element("div", { class: "charts" },
    chart("Expected completeness vs. photos", "Expected completeness of the first photos of the plan, most useful first.", "line",
      [line("expected completeness", curve)], { x: "photos", ...y }),
    minutes.length > 1 ? chart("Expected completeness vs. minutes", "Tour through the first photos with a stop at each, without the legs to and from the take-off point.",
      "line", [line("expected completeness", minutes)], { x: "minutes", ...y }) : null,
    histogram_chart("Ground sampling distance", "Minimum among the photos of a point, on a surface that faces the camera.", millimetres, "mm", 0),
    histogram_chart("Photos of a point", null, histograms.observations, "photos", 1),
    histogram_chart("Parallax", "Maximum parallax between two stereo partners of a point.", histograms.parallax_deg, "degrees", 2),
    histogram_chart("Incidence", "Minimum angle of incidence among the photos of a point.", histograms.incidence_deg, "degrees", 3),
    route_charts(data), energy_chart(data)));
}

const how_photographed = [
  ["Expected completeness", "Expected fraction of the exposed surface at which a photogrammetry program finds a depth within two ground sampling distances of the true depth. It is computed from the number of stereo partners with a model fitted to simulated reconstructions."],
  ["Exposed surface", "Surface from which at least 10% of the directions are free. The rest, such as the inside of walls, is not counted."],
  ["Attainable surface", "Exposed surface with enough stereo partners if all candidate photos are taken."],
  ["Stereo partners", "Photos of the same point whose parallax is within the permitted range and whose distances differ by at most a factor of two. The number is the maximum for any photo of the point."],
  ["Good, weak, missing", "Good: at least three stereo partners or a reconstructability of at least 1. Weak: two partners or at least 0.2. Missing: all other exposed surface."],
  ["Ground sampling distance", "Distance between neighbouring pixels on a surface that faces the camera."],
];

function photo_sections(data) {
  return [photo_warnings(data), missing_section(data), photo_charts(data), pattern_section(data), camera_section(data),
    flight_section(data), files_section(data), settings_section(data), how_section(how_photographed)];
}

// Curves and histograms, drawn with Chart.js.

const chart_colours = ["#0b6e99", "#c77700", "#1f8a4c", "#8a4fbf", "#c8252c", "#5b6875", "#2aa198",
  "#b5418b", "#6b7d1f", "#3d5a99"];

function chart(title, note, type, datasets, options) {
  const canvas = element("canvas", { role: "img", "aria-label": title });
  const box = element("div", { class: "chart" }, element("h3", {}, title),
    element("div", { class: "plot" }, canvas), note ? element("p", {}, note) : null);
  const axis = (text, more) => ({ title: { display: !!text, text }, grid: { color: "#e9edf0" },
    ticks: { maxTicksLimit: 8 }, ...more });
  charts_to_draw.push(() => new Chart(canvas, {
    type, data: { datasets, labels: options.labels },
    options: {
      animation: false, responsive: true, maintainAspectRatio: false, normalized: true,
      interaction: { mode: "nearest", axis: "x", intersect: false },
      plugins: { legend: { display: datasets.length > 1, labels: { boxWidth: 20, boxHeight: type === "line" ? 1 : 8, usePointStyle: !!options.labels && datasets.some((set) => set.pointStyle),
        filter: (item) => !item.text.startsWith("_") } },
        tooltip: { filter: (item) => !item.dataset.label.startsWith("_"), callbacks: options.tooltip || {} } },
      scales: {
        x: axis(options.x, { type: options.labels ? "category" : "linear", ...(options.x_more || {}) }),
        y: axis(options.y, { beginAtZero: !options.is_free, ...(options.y_more || {}) }),
      },
    },
  }));
  return box;
}

/// Chart.js measures its canvas, so charts are drawn after they have been added to the page.
const charts_to_draw = [];

function draw_charts() {
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  Chart.defaults.color = "#5b6875";
  return charts_to_draw.splice(0).map((draw) => draw());
}

function line(label, points, number = 0, more = {}) {
  const colour = chart_colours[number % chart_colours.length];
  return { label, data: points.map(([x, y]) => ({ x, y })), borderColor: colour, backgroundColor: colour,
    borderWidth: 2, pointRadius: points.length > 60 ? 0 : 2, tension: 0, ...more };
}

/// Returns a horizontal reference line.
function level(label, from, to, y, number) {
  return line(label, [[from, y], [to, y]], number, { borderDash: [6, 4], pointRadius: 0, borderWidth: 1.5 });
}

const percent = (share) => 100 * share;

function coverage_chart(data, title, x_of, x_title) {
  const { summary } = data, views = summary.per_view;
  const points = views.map((view, i) => [x_of(view, i), percent(view.coverage)]);
  const lines = [line("covered (ground truth)", points)];
  if (typeof summary.attainable_coverage === "number") {
    lines.push(level("attainable", points[0][0], points[points.length - 1][0], percent(summary.attainable_coverage), 5));
  }
  return chart(title, null, "line", lines, { x: x_title, y: "% of the surface", y_more: { min: 0 } });
}

/// Minimum verified clearance of each leg along the route, as steps.
function clearance_chart(data) {
  const legs = legs_of(data).filter((leg) => leg.clearance !== null);
  if (!legs.length) return null;
  const asked = data.summary.flight.clearance_m.total;
  let way = 0;
  const points = [];
  for (const leg of legs) {
    points.push([way, leg.clearance]);
    for (let i = 1; i < leg.points.length; ++i) {
      way += vector(leg.points[i]).distanceTo(vector(leg.points[i - 1]));
    }
    points.push([way, leg.clearance]);
  }
  return chart("Verified clearance along the route", "Minimum distance of each leg to measured points, no-fly volumes " +
    "and unknown space, limited to 10 m above the required clearance.",
    "line", [line("verified", points, 0, { pointRadius: 0 }), level("required", 0, way, asked, 4)],
    { x: "metres flown", y: "m", y_more: { min: 0 } });
}

/// Remaining battery energy after each leg. The lower axis limit is the reserve.
function energy_chart(data) {
  const sorties = sorties_of(data);
  if (!sorties.length || !sorties.every((sortie) => sortie.legs)) return null;
  const lines = sorties.map((sortie, number) => {
    let time = 0, left = sortie.energy_left_wh + sortie.energy_wh;
    const points = [[0, left]];
    const legs_energy = sortie.legs.reduce((sum, leg) => sum + leg.energy_wh, 0);
    const legs_time = sortie.legs.reduce((sum, leg) => sum + leg.duration_s, 0);
    // Climb, landing and stops belong to the sortie, not to its legs. They are divided equally
    // among the legs.
    const more_energy = (sortie.energy_wh - legs_energy) / sortie.legs.length;
    const more_time = (sortie.duration_s - legs_time) / sortie.legs.length;
    for (const leg of sortie.legs) {
      time += leg.duration_s + more_time;
      left -= leg.energy_wh + more_energy;
      points.push([time / 60, left]);
    }
    return line("sortie " + (number + 1), points, number, { pointRadius: 0 });
  });
  const longest = Math.max(...sorties.map((sortie) => sortie.duration_s / 60));
  const home = value_at(data, "summary.flight.return.energy_wh");
  if (home > 0) lines.push(level("energy for return (maximum)", 0, longest, home, 4));
  return chart("Energy left above the reserve", null, "line", lines, { x: "minutes", y: "Wh", y_more: { min: 0 } });
}

// Observed against estimated coverage probability. Ideally, a fraction p of the surface with the
// estimate p is covered.
function reliability_chart(data) {
  const bands = value_at(data, "summary.estimate.reliability.bands");
  if (!bands) return null;
  const seen = bands.filter((band) => band.share > 0);
  return chart("Calibration of the coverage estimate",
    "Covered fraction of the surface against the estimated probability of coverage. On the diagonal, the estimate is exact.",
    "line", [line("covered", seen.map((band) => [percent(band.estimated), percent(band.covered)])),
      line("ideal", [[0, 0], [100, 100]], 4)], { x: "% estimated", y: "% covered", y_more: { min: 0 } });
}

function survey_charts(data) {
  const { summary } = data, views = summary.per_view || [];
  if (!views.length && data.profile) {
    return element("section", { id: "curves" }, element("h2", {}, "Route profile"),
      element("div", { class: "charts" }, route_charts(data)));
  }
  if (!views.length) return null;
  const is_known = typeof views[0].coverage === "number";  // unknown for real sites
  const charts = [
    is_known ? coverage_chart(data, "Coverage vs. views", (view, i) => i + 1, "views") : null,
    is_known ? coverage_chart(data, "Coverage vs. path length", (view) => view.distance_m, "path length in metres (straight lines)") : null,
    chart("Points", null, "line", [line("stored points", views.map((view, i) => [i + 1, view.points])),
      line("new points", views.map((view, i) => [i + 1, view.points_new]), 1)], { x: "views", y: "points" }),
    chart("Planning time", "Planning time per view on this machine.", "line",
      [line("planning", views.map((view, i) => [i + 1, view.planning_time_s]))], { x: "views", y: "s" }),
    ...route_charts(data), energy_chart(data), reliability_chart(data)];
  return element("section", { id: "curves" }, element("h2", {}, "Curves"),
    element("div", { class: "charts" }, charts));
}

function histogram_chart(title, note, { counts, low, high }, x, colour = 0) {
  const width = (high - low) / counts.length, all = counts.reduce((sum, count) => sum + count, 0) || 1;
  const digits = width >= 1 ? 0 : width >= 0.1 ? 1 : 2;
  return chart(title, note, "bar", [{ label: "fraction of the points", categoryPercentage: 1, barPercentage: 0.94,
    data: counts.map((count) => percent(count / all)), backgroundColor: chart_colours[colour] }],
    { labels: counts.map((_, i) => (low + (i + 0.5) * width).toFixed(digits)), x, y: "% of the points" });
}

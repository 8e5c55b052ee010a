// Comparison of surveys: planners on missions (results.json), and the trials of one mission
// (trials.json).

/// Colours for all kinds of colour vision (Okabe and Ito), and five additional ones.
const planner_colours = ["#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9",
  "#7A7A7A", "#8B4513", "#6A3D9A", "#000000", "#F0A0A0"];

/// Compared quantities.
const compared = [
  { key: "views", name: "views", form: "mean" },
  { key: "coverage", name: "coverage", form: "share" },
  { key: "coverage_visible", name: "of visible surface", form: "share" },
  { key: "distance_m", name: "distance", form: "metres" },
  { key: "flown_s", name: "flight time", form: "minutes" },
  { key: "planning_time_s", name: "planning (processor time)", form: "seconds" },
];

/// Returns [{cell, path, colour}] for planners with trials on a mission. `path` is the path in the
/// summary.
function cells_of(data) {
  const { summary } = data;
  const all = summary.results ? summary.results.map((cell, i) => ({ cell, path: "results." + i + "." }))
    : [{ cell: summary, path: "" }];
  const planners = [...new Set(all.map(({ cell }) => cell.planner))];
  return all.filter(({ cell }) => cell.trials > 0).map((one) => ({ ...one,
    colour: planner_colours[planners.indexOf(one.cell.planner) % planner_colours.length] }));
}

const title_of = (cell) => cell.title || cell.planner;

function planner_name({ cell, colour }) {
  return element("span", {}, colour_mark(colour), title_of(cell));
}

/// Returns the mean with its 95% interval, the standard deviation and the paper's value.
function compared_figure(data, { cell, path }, { key, form }) {
  const found = cell[key];
  if (!found) return { number: "–" };
  const part = (name) => figure(data, path + key + "." + name, form);
  const lines = [element("div", {}, part("mean"))];
  if (typeof found.half_width_95 === "number") {
    lines[0].append(" ± ", part("half_width_95"));
    lines.push(element("div", { class: "aside" }, "sd ", part("standard_deviation")));
  }
  if (typeof found.paper === "number") lines.push(element("div", { class: "aside" }, "paper ", part("paper")));
  return { number: element("div", {}, lines) };
}

/// The rule of honesty: each planner beside fixed views without planning.
function uniform_section(data) {
  const rows = data.summary.uniform_comparison;
  if (!rows || !rows.length) return [];
  const mean = (path, known, form) => {
    if (!known) return { number: "–" };
    const parts = [figure(data, path + ".mean", form)];
    if (typeof known.half_width_95 === "number") parts.push(" ± ", figure(data, path + ".half_width_95", form));
    return { number: element("span", {}, parts) };
  };
  const number = (content) => ({ number: content });
  return [element("section", { id: "uniform" }, element("h2", {}, "Comparison with surveys without planning"),
    element("p", {}, "Uniform takes a fixed set of views on a sphere, with a short tour. It is granted the centroid and the mean "
      + "radius of the true surface and the positions that the true scene admits; the planners receive none of these. "
      + "A planner is called better or worse only if the 95% interval of the difference, paired by seed, excludes zero."),
    table(["planner", "mission", number("views"), number("coverage"), number("path"), number("coverage − uniform, same views"),
      number("path − uniform, same views"), "verdict", number("views with which uniform reaches its coverage"), number("path of that tour")],
    rows.map((row, i) => {
      const path = "uniform_comparison." + i + ".";
      return [row.title, row.mission, mean(path + "views", row.views, "mean"), mean(path + "coverage", row.coverage, "share"),
        mean(path + "distance_m", row.distance_m, "metres"), mean(path + "coverage_difference", row.coverage_difference, "share"),
        mean(path + "distance_difference_m", row.distance_difference_m, "metres"), row.verdict,
        number(row.reaching_views === null ? "more than " + row.max_tested_views : String(row.reaching_views)),
        mean(path + "reaching_distance_m", row.reaching_distance_m, "metres")];
    })))];
}

function comparison_table(data, cells) {
  const known = compared.filter(({ key }) => cells.some(({ cell }) => cell[key]));
  const heading = [cells.length > 1 ? "planner" : "", { number: "trials" }, ...known.map(({ name }) => ({ number: name })),
    { number: "of attainable coverage" }];
  return table(heading, cells.map((one) => {
    const { cell, path } = one, ceiling = cell.attainable_coverage;
    return [planner_name(one), { number: figure(data, path + "trials", "count") },
      ...known.map((what) => compared_figure(data, one, what)),
      { number: ceiling > 0 ? shown(cell.coverage.mean / ceiling, "share") : "–" }];
  }));
}

/// Returns the curve of mean coverage with a band of one standard deviation over the trials.
function curve_lines(one, axis, unit) {
  const curve = value_at(one.cell, "curves." + axis);
  if (!curve || !curve.x.length) return [];
  const points = (shift) => curve.x.map((x, i) => [x / unit,
    percent(Math.min(1, curve.coverage[i] + shift * curve.standard_deviation[i]))]);
  const hidden = { borderWidth: 0, pointRadius: 0, borderColor: "transparent" };
  const band = one.colour + "26";
  const mean = { pointRadius: 0, borderColor: one.colour, backgroundColor: one.colour };
  return [line("_low", points(-1), 0, hidden),
    line("_high", points(1), 0, { ...hidden, fill: "-1", backgroundColor: band }),
    line(title_of(one.cell), points(0), 0, mean)];
}

/// For each curve: axis in the data, title, axis label, scale, and data units per displayed unit.
const curve_axes = [["views", "Coverage vs. views", "views", "linear"],
  ["distance_m", "Coverage vs. path length", "metres", "linear"],
  ["flown_s", "Coverage vs. flight time", "minutes from take-off", "linear", 60],
  ["planning_time_s", "Coverage vs. planning time", "seconds of processor time", "logarithmic"]];

function coverage_curves(cells) {
  return curve_axes.map(([axis, title, x, type, unit = 1]) => {
    const lines = cells.flatMap((one) => curve_lines(one, axis, unit));
    return lines.length ? chart(title, null, "line", lines,
      { x, y: "% of the surface", x_more: { type }, y_more: { min: 0, max: 100 } }) : null;
  });
}

/// Shows each survey as a point.
function trials_chart(cells) {
  const sets = cells.filter(({ cell }) => cell.each_trial).map((one) => ({ label: title_of(one.cell),
    data: one.cell.each_trial.map((trial) => ({ x: trial.distance_m, y: percent(trial.coverage) })),
    backgroundColor: one.colour, borderColor: one.colour, pointRadius: 3.5 }));
  return sets.length ? chart("Each survey", "One point per trial.", "scatter", sets,
    { x: "path length in metres (straight lines)", y: "% of the surface", is_free: true }) : null;
}

/// Shows the means with their 95% intervals for all planners.
function interval_chart(cells, { key, name, form }) {
  const known = cells.filter(({ cell }) => cell[key]);
  if (!known.length) return null;
  const scale = { share: 100, minutes: 1 / 60 }[form] || 1;
  const bounded = (value) => (form === "share" ? Math.min(100, value) : value);
  const ends = ({ cell }) => [-1, 1].map((side) => bounded(scale * (cell[key].mean + side * (cell[key].half_width_95 || 0))));
  const colours = known.map(({ colour }) => colour);
  const sets = [
    { type: "bar", label: "95% interval of the mean", data: known.map(ends), backgroundColor: colours.map((colour) => colour + "55"), barPercentage: 0.5 },
    { type: "line", label: "mean", data: known.map(({ cell }) => scale * cell[key].mean), showLine: false, pointStyle: "circle", pointRadius: 5, pointBackgroundColor: colours, borderColor: "#17212b" },
    { type: "line", label: "paper", data: known.map(({ cell }) => (typeof cell[key].paper === "number" ? scale * cell[key].paper : null)), showLine: false, pointRadius: 6, pointStyle: "crossRot", borderColor: "#17212b" }];
  const has_paper = known.some(({ cell }) => typeof cell[key].paper === "number");
  const few = known.some(({ cell }) => cell.trials < 5);
  return chart(name[0].toUpperCase() + name.slice(1), few ? "Fewer than 5 trials: the intervals are wide and uncertain." : null, "bar", has_paper ? sets : sets.slice(0, 2),
    { labels: known.map(({ cell }) => title_of(cell)), y: { share: "%", metres: "m", minutes: "min", seconds: "s" }[form] || name, is_free: true,
      y_more: form === "seconds" ? { type: "logarithmic" } : {} });
}

/// Number of views and path length until a target has been observed: Figure 6 of the paper.
function target_charts(cells) {
  const known = cells.filter(({ cell }) => value_at(cell, "targets.observed") > 0);
  if (!known.length) return [];
  const views = known.map((one) => ({ label: title_of(one.cell), backgroundColor: one.colour,
    data: one.cell.targets.share_by_views.map(percent) }));
  const count = Math.max(...views.map((set) => set.data.length));
  const labels = Array.from({ length: count }, (_, i) => i + 1 + (i === count - 1 ? " or more" : ""));
  const ways = known.map((one) => {
    const { share_by_distance, distance_bin_m } = one.cell.targets;
    return line(title_of(one.cell), [[0, 0], ...share_by_distance.map((share, i) => [distance_bin_m * (i + 1), percent(share)])],
      0, { borderColor: one.colour, backgroundColor: one.colour });
  });
  return [chart("Views until a target is observed", "A target is the frontier at which a view is aimed.", "bar",
    views, { labels, x: "views", y: "% of the targets" }),
  chart("Path length until a target is observed", null, "line", ways, { x: "within metres", y: "% of the targets", y_more: { min: 0, max: 100 } })];
}

/// Effort to reach the final coverage of another planner.
function reach_table(data, cells) {
  const marks = { paper: "the paper's SEE++", "see++": "SEE++ here", see: "SEE here" };
  const rows = cells.flatMap((one) => Object.entries(one.cell.until_coverage_of || {})
    .filter(([mark]) => mark !== one.cell.planner)
    .map(([mark, to]) => {
      const path = one.path + "until_coverage_of." + mark + ".";
      const mean = (key, form) => ({ number: to[key] ? figure(data, path + key + ".mean", form) : "–" });
      return [(marks[mark] || mark) + ", " + shown(to.coverage, "share"), planner_name(one),
        { number: to.trials + " of " + one.cell.trials }, mean("views", "mean"), mean("distance_m", "metres"), mean("planning_time_s", "seconds")];
    }));
  if (!rows.length) return [];
  const number = (content) => ({ number: content });
  return [element("h3", {}, "Effort to reach a given coverage"), table(["coverage of", "planner", number("trials that reach it"),
    number("views"), number("distance"), number("planning")], rows)];
}

function trial_table(data, { cell, path }) {
  if (!cell.each_trial) return null;
  const number = (content) => ({ number: content });
  return element("section", { id: "trials" }, element("details", {}, element("summary", {}, "Each trial"),
    table([number("seed"), "ended", number("views"), number("coverage"), number("distance"), number("planning")],
      cell.each_trial.map((trial, i) => {
        const f = (key, form) => number(figure(data, path + "each_trial." + i + "." + key, form));
        return [number(String(trial.seed)), data.stop_words[trial.stop_reason] || trial.stop_reason, f("views", "count"), f("coverage", "share"),
          f("distance_m", "metres"), f("planning_time_s", "seconds")];
      }))));
}

/// Returns a section for each mission.
function comparison_sections(data) {
  const cells = cells_of(data);
  if (!cells.length) return [element("section", {}, element("p", {}, "No completed survey yet."))];
  const missions = [...new Set(cells.map(({ cell }) => cell.mission))];
  const sections = missions.map((mission) => {
    const own = cells.filter(({ cell }) => cell.mission === mission);
    const intervals = own.length > 1 ? compared.map((what) => interval_chart(own, what)) : [];
    return element("section", { class: "mission" }, element("h2", {}, data.kind === "trials" ? "Means over the trials" : mission),
      comparison_table(data, own), element("div", { class: "charts" }, coverage_curves(own), trials_chart(own), intervals, target_charts(own)),
      reach_table(data, own));
  });
  return data.kind === "trials" ? [...sections, trial_table(data, cells[0])] : [...uniform_section(data), ...sections];
}

// Variants of a mission side by side. Each row is a results folder and the command that writes it.

const variants = [
  { name: "As in the mission", ending: "", options: {} },
  { name: "Views of the survey", ending: "_survey_views", options: { "--set": ["flight.views=survey"] } },
  { name: "Order of the survey", ending: "_survey_order", options: { "--set": ["flight.order=survey"] } },
  { name: "Replanned views", ending: "_replanned", options: { "--set": ["flight.views=replanned"] } },
  { name: "Fly-through capture", ending: "_fly_through", options: { "--set": ["flight.style=fly-through"] } },
  { name: "Replanned, fly-through", ending: "_replanned_fly_through",
    options: { "--set": ["flight.views=replanned", "flight.style=fly-through"] } },
  ...["oblique", "dome", "facade", "rings"].map((name) => (
    { name: "Pattern " + name, ending: "_" + name, options: { "--planner": [name] } })),
];

/// Returns the figures of a row from summary.json.
function variant_figures(summary) {
  const { flight = {} } = summary, sorties = (flight.route || {}).sorties || [];
  const minutes = sorties.reduce((sum, sortie) => sum + (sortie.passage || sortie).duration_s, 0) / 60;
  const written = (flight.written || [])[0], share = (value) => (typeof value === "number" ? (100 * value).toFixed(2) + "%" : "–");
  const visible = written ? written.coverage_visible : summary.coverage_visible;
  const complete = summary.photo && summary.photo.figures.expected_completeness;
  return { planned: written ? written.planned_views : (summary.per_view || []).length, stations: sorties.reduce((sum, one) => sum + one.last_station - one.first_station + 1, 0),
    minutes: sorties.length ? minutes.toFixed(1) : "–", sorties: sorties.length,
    coverage: share(typeof visible === "number" ? visible : typeof complete === "number" ? complete : written ? written.coverage : summary.coverage) };
}

function make_variants(mission) {
  const rows = element("tbody"), output = make_output("Output of the variant");
  const table = { output };
  const cells = (text, attributes = {}) => element("td", attributes, text);
  table.box = element("details", { id: "variants" }, element("summary", {}, "Compare variants"),
    element("p", { class: "note" }, "Coverage: of the visible surface, in the simulated re-flight of the exported mission; of photos, the expected completeness. Minutes: from take-off to landing."),
    element("div", { class: "wide" }, element("table", {}, element("thead", {}, element("tr", {},
      ["Variant", "Views", "Minutes", "Sorties", "Coverage", "Command", ""].map((text) => element("th", { scope: "col" }, text)))), rows)),
    element("div", { class: "actions" }, button("Plan all variants", () => table.plan_all(), { id: "plan-all" })), output.box);
  table.box.addEventListener("toggle", () => { if (table.box.open) table.refresh().catch((failure) => say(failure.message)); });

  const options_of = (variant) => ({ mission: mission.path, "--out": mission.results_folder() + variant.ending, ...variant.options });
  const command_of = (variant) => ["skycap plan", mission.path, "--out=" + mission.results_folder() + variant.ending,
    ...Object.entries(variant.options).flatMap(([name, values]) => values.map((value) => name + "=" + value))].join(" ");
  Object.assign(table, {
    problems: new Map(),
    async refresh() {
      if (!mission.path || !table.box.open) return;
      const folders = new Set(files_of("package").map((file) => file.path));
      const made = [];
      for (const variant of variants) {
        const folder = mission.results_folder() + variant.ending;
        let figures = null;
        if (folders.has(folder)) {
          const answer = await fetch(file_address(folder + "/summary.json"));
          if (answer.ok) figures = variant_figures(await answer.json());
        }
        made.push(table.row(variant, folder, figures));
      }
      rows.replaceChildren(...made);
    },
    row(variant, folder, figures) {
      const problem = table.problems.get(folder);
      const values = figures ? [figures.stations + " of " + figures.planned, figures.minutes, String(figures.sorties), figures.coverage]
        : problem ? null : ["–", "–", "–", "–"];
      return element("tr", { "data-variant": variant.ending || "_mission" }, element("th", { scope: "row" }, variant.name),
        values ? values.map((text) => cells(text, { class: "number" })) : cells(problem, { colspan: "4", class: "bad" }),
        cells(element("code", {}, command_of(variant))),
        cells(element("div", { class: "actions" }, button("Plan", () => table.plan(variant), { "aria-label": "Plan " + variant.name }),
          figures ? button("Open", async () => {
            await studio.steps.results.open(folder);
            go_to("results");
          }, { "aria-label": "Open " + variant.name }) : null)));
    },
    async plan(variant) {
      await mission.save_if_changed();
      const folder = mission.results_folder() + variant.ending;
      const job = await run_command("plan", options_of(variant), output.show);
      const failure = job.lines.find((line) => line.includes("error")) || "ended with exit code " + job.exit_code;
      if (job.exit_code === 0) table.problems.delete(folder);
      else table.problems.set(folder, failure);
      await refresh_files();
      await table.refresh();
    },
    async plan_all() {
      for (const variant of variants) await table.plan(variant);
    },
  });
  return table;
}

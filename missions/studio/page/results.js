// Step 5: reports, files and exports.

const formats = [["kmz", "DJI (kmz)"], ["waypoints", "ArduPilot (waypoints)"], ["plan", "QGroundControl, PX4 (plan)"],
  ["kml", "Google Earth (kml)"], ["geojson", "GeoJSON"], ["litchi", "Litchi"], ["csv", "Waypoint table (csv)"],
  ["ned-csv", "Setpoints (ned-csv)"], ["tum", "Trajectory (tum)"]];

/// Formats that the ground station of an autopilot reads.
const own_formats = { dji: ["kmz"], px4: ["plan"], ardupilot: ["waypoints", "plan"] };

studio.steps.results = {
  build(section) {
    this.folder = select([]);
    this.folder.addEventListener("change", () => this.open(this.folder.value).catch((failure) => say(failure.message)));
    this.stage = make_stage("Report", { moved: (...change) => this.editor.moved(...change),
      selected: (id) => { if (this.editor.views[id]) this.editor.select(Number(id)); } });
    this.editor = make_view_editor(this.stage, () => this.folder.value);
    this.pages = element("div", { class: "actions" });
    this.rows = element("tbody");
    this.format = select(formats, { id: "format" });
    this.output = make_output("Output of skycap export");
    this.background = background_select();
    this.background.node.addEventListener("change", () => this.show_background().catch((failure) => say(failure.message)));
    section.append(element("h2", {}, "Results"), element("div", { class: "fields" }, field("Results", this.folder),
      field("Background", this.background.node, "Orthophoto or map of the site for the 3-D view (GeoTIFF).")),
      this.pages, element("div", { class: "drawing", "data-open": "false" }, this.stage.node, this.editor.box),
      element("h3", {}, "Export for another vehicle or program"),
      element("div", { class: "fields" }, field("Format", this.format)),
      element("div", { class: "actions" }, button("Export", () => this.export_route(), { id: "export" })), this.output.box,
      element("h3", {}, "Files"), element("table", {}, element("thead", {}, element("tr", {},
        ["File", "Size", ""].map((text) => element("th", { scope: "col" }, text)))), this.rows));
  },
  refresh() {
    fill(this.folder, files_of("package").map((file) => file.path), "choose results");
    this.background.refresh();
  },
  /// Shows the report with the chosen background. It is a page beside the results.
  async show_background() {
    if (!this.folder.value) throw new Error("No results are open. Choose results first.");
    const page = this.report_page();
    if (this.background.node.value) {
      const job = await run_command("view", { what: this.folder.value, "--out": page, ...this.background.options() }, this.output.show);
      if (job.exit_code !== 0) return;
    }
    this.stage.show(page);
  },
  report_page() { return this.folder.value + (this.background.node.value ? "_background.html" : "/report.html"); },
  async open(path) {
    if (!path) return;
    this.folder.value = path;
    this.background.node.value = "";  // each background belongs to its results
    this.close_editor();
    const { files } = await request("package?path=" + encodeURIComponent(path));
    const pages = files.map((file) => file.path).filter((name) => name.endsWith(".html"));
    const names = { "report.html": "Report", "field_sheet.html": "Field sheet", "scan.html": "Scan report" };
    this.pages.replaceChildren(...pages.map((name) => button(names[name] || name, () => {
      this.close_editor();
      this.stage.show(path + "/" + name);
    })),
      ...pages.map((name) => element("a", { class: "button", href: file_address(path + "/" + name), target: "_blank", rel: "noopener" },
        (names[name] || name) + " in a new tab")),
      ...(pages.includes("report.html") && files.some((file) => file.path === "summary.json") ? [button("Edit the views", () => this.edit(), { id: "edit-views" })] : []));
    await this.offer_formats(path, files);
    const main = ["report.html", "scan.html", ...pages].find((name) => pages.includes(name));
    if (main) this.stage.show(path + "/" + main);
    this.rows.replaceChildren(...files.map((file) => element("tr", {}, element("td", {}, file.path),
      element("td", { class: "number" }, bytes_text(file.bytes)),
      element("td", {}, element("a", { href: file_address(path + "/" + file.path, "?download=1"), download: file.path.split("/").pop(),
        "data-file": file.path }, "Download ", file.path)))));
  },
  /// Lists the formats for the vehicle of the results first.
  async offer_formats(path, files) {
    if (!files.some((file) => file.path === "summary.json")) return;
    const answer = await fetch(file_address(path + "/summary.json"));
    const { settings } = answer.ok ? await answer.json() : {}, name = (settings || {})["flight.vehicle"];
    if (!name) return;
    await load_presets();
    const { autopilot } = studio.presets.vehicles.find((one) => one.name === name) || {};
    const own = own_formats[String(autopilot).toLowerCase()] || [];
    const sorted = [...formats].sort(([a], [b]) => own.includes(b) - own.includes(a));
    this.format.replaceChildren(...sorted.map(([format, text]) => element("option", { value: format },
      own.includes(format) ? text + ", for " + name : text)));
  },
  async edit() {
    this.stage.show(this.report_page());
    await this.editor.open();
    this.stage.fit();
    this.stage.node.parentElement.dataset.open = "true";
  },
  close_editor() {
    this.editor.close();
    this.stage.node.parentElement.dataset.open = "false";
  },
  async export_route() {
    if (!this.folder.value) throw new Error("No results are open. Choose results, or plan a mission first.");
    await run_command("export", { package: this.folder.value, "--format": [this.format.value] }, this.output.show);
    await this.open(this.folder.value);
  },
};

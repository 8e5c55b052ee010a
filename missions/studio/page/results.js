// Step 5: reports, files and exports.

const formats = [["kmz", "DJI (kmz)"], ["waypoints", "ArduPilot (waypoints)"], ["plan", "QGroundControl, PX4 (plan)"],
  ["kml", "Google Earth (kml)"], ["geojson", "GeoJSON"], ["litchi", "Litchi"], ["csv", "Waypoint table (csv)"],
  ["ned-csv", "Setpoints (ned-csv)"], ["tum", "Trajectory (tum)"]];

studio.steps.results = {
  build(section) {
    this.folder = select([]);
    this.folder.addEventListener("change", () => this.open(this.folder.value).catch((failure) => say(failure.message)));
    this.report = frame("Report");
    this.report.hidden = true;
    this.pages = element("div", { class: "actions" });
    this.rows = element("tbody");
    this.format = select(formats, { id: "format" });
    this.output = make_output("Output of skycap export");
    section.append(element("h2", {}, "Results"), element("div", { class: "fields" }, field("Results", this.folder)),
      this.pages, this.report, element("h3", {}, "Export for another vehicle or program"),
      element("div", { class: "fields" }, field("Format", this.format)),
      element("div", { class: "actions" }, button("Export", () => this.export_route(), { id: "export" })), this.output.box,
      element("h3", {}, "Files"), element("table", {}, element("thead", {}, element("tr", {},
        ["File", "Size", ""].map((text) => element("th", { scope: "col" }, text)))), this.rows));
  },
  refresh() { fill(this.folder, files_of("package").map((file) => file.path), "choose results"); },
  async open(path) {
    if (!path) return;
    this.folder.value = path;
    const { files } = await request("package?path=" + encodeURIComponent(path));
    const pages = files.map((file) => file.path).filter((name) => name.endsWith(".html"));
    const names = { "report.html": "Report", "field_sheet.html": "Field sheet", "scan.html": "Scan report" };
    this.pages.replaceChildren(...pages.map((name) => button(names[name] || name, () => show_in(this.report, path + "/" + name))),
      ...pages.map((name) => element("a", { class: "button", href: file_address(path + "/" + name), target: "_blank", rel: "noopener" },
        (names[name] || name) + " in a new tab")));
    const main = ["report.html", "scan.html", ...pages].find((name) => pages.includes(name));
    if (main) show_in(this.report, path + "/" + main);
    this.rows.replaceChildren(...files.map((file) => element("tr", {}, element("td", {}, file.path),
      element("td", { class: "number" }, bytes_text(file.bytes)),
      element("td", {}, element("a", { href: file_address(path + "/" + file.path, "?download=1"), download: file.path.split("/").pop(),
        "data-file": file.path }, "Download ", file.path)))));
  },
  async export_route() {
    if (!this.folder.value) throw new Error("No results are open. Choose results, or plan a mission first.");
    await run_command("export", { package: this.folder.value, "--format": [this.format.value] }, this.output.show);
    await this.open(this.folder.value);
  },
};

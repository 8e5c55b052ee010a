// Step 6: a live survey (skycap serve, skycap fly) with its vehicle and next leg. It can be held.

const place_text = (place) => place.map((value) => value.toFixed(2)).join(", ") + " m";

/// Returns [name, text] of the figures of a status (missions/online/live/live_status.h).
function live_figures({ vehicle, battery, required_clearance_m: required, survey }) {
  const { view, path, clearance_m: clearance, estimated_coverage: coverage } = survey || {};
  const length = path ? path.slice(1).reduce((sum, point, i) => sum + Math.hypot(...point.map((value, axis) => value - path[i][axis])), 0) : 0;
  const figures = [["Vehicle", vehicle ? place_text(vehicle.position) : "unknown"]];
  if (typeof battery === "number") figures.push(["Battery", (100 * battery).toFixed(0) + "%"]);
  if (!survey) return figures;
  figures.push(["Scans", survey.scans + ", " + survey.points.toLocaleString("en") + " points"]);
  if (typeof coverage === "number") figures.push(["Estimated coverage", (100 * coverage).toFixed(1) + "%"]);
  figures.push(["Next view", view ? place_text(view.position) + ", heading " + view.heading_deg.toFixed(0) + "°, pitch " +
    view.gimbal_pitch_deg.toFixed(0) + "°" : survey.state.replaceAll("_", " ")]);
  if (!view) return figures;
  figures.push(["Next leg", path ? length.toFixed(1) + " m in " + (path.length - 1) + (path.length === 2 ? " leg" : " legs") : "not planned"]);
  figures.push(["Verification", path ? "collision-free in measured space; clearance " + clearance.toFixed(2) + " m" +
    (required ? ", required " + required.toFixed(2) + " m" : "") : "no verified path"]);
  return figures;
}

studio.steps.live = {
  path: "",
  build(section) {
    this.survey = select([]);
    this.survey.addEventListener("change", () => this.open(this.survey.value).catch((failure) => say(failure.message)));
    this.stage = make_stage("3-D view of the live survey", {});
    this.state = element("p", { role: "status", id: "live-state" });
    this.rows = element("tbody");
    this.table = element("table", { hidden: true }, this.rows);
    this.hold = button("Hold", () => this.request_hold(true), { class: "main", id: "hold" });
    this.resume = button("Resume", () => this.request_hold(false), { id: "resume" });
    this.figures = element("div", { hidden: true }, element("div", { class: "actions" }, this.hold, this.resume), this.state,
      this.table, element("p", { class: "note" }, "Hold: no further leg is released. With skycap fly, the vehicle stops on its leg; with skycap serve, " +
        "the client waits for its next view. Returns of failsafes are not held. The pilot can take control at any time."));
    section.append(element("h2", {}, "Live"), element("div", { class: "fields" }, field("Live survey", this.survey,
      "Surveys of skycap serve and skycap fly in this folder. They are started on the command line.")),
    element("div", { class: "drawing" }, this.stage.node, this.figures));
    // A button is enabled again after its action, so its state follows afterwards.
    for (const node of [this.hold, this.resume]) new MutationObserver(() => this.update_buttons()).observe(node, { attributeFilter: ["disabled"] });
    setInterval(() => { if (!section.hidden && !document.hidden) this.ask().catch((failure) => say(failure.message)); }, 1000);
  },
  refresh() {
    fill(this.survey, files_of("live").map((file) => file.path), "choose a live survey");
    if (files_of("live").some((file) => file.path === this.path)) this.survey.value = this.path;
  },
  async open(path) {
    this.path = path;
    this.survey.value = path;
    this.figures.hidden = !path;
    this.stage.node.hidden = true;
    this.is_shown = false;
    if (path) await this.ask();
  },
  async ask() {
    if (!this.path || this.is_asking) return;
    this.is_asking = true;
    try {
      this.show(await request("live?path=" + encodeURIComponent(this.path)));
      if (!this.is_shown) await this.show_report();
    } finally {
      this.is_asking = false;
    }
  },
  /// The report exists after the first scan, and reloads itself.
  async show_report() {
    const page = this.path + "/report.html";
    const { files } = await request("package?path=" + encodeURIComponent(this.path));
    if (!files.some((file) => file.path === "report.html")) return;
    this.is_shown = true;
    this.stage.show(page, true);
  },
  async request_hold(held) {
    this.show(await request("live", { path: this.path, held }));
  },
  show(answer) {
    const { running, hold, status } = answer, is_held = running && status.held;
    this.answer = answer;
    this.state.textContent = !running ? "Not running." + (hold ? " A hold is set: resume before the next flight." : "")
      : (is_held ? (hold ? "Held: " : "Resuming: ") : hold ? "Holding: " : "Running: ") + status.action;
    this.state.className = is_held ? "bad" : running ? "good" : "";
    this.state.dataset.state = !running ? "ended" : is_held ? "held" : "running";
    const figures = running ? live_figures(status) : [];
    this.rows.replaceChildren(...figures.map(([name, text]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, text))));
    this.table.hidden = !running;
    this.update_buttons();
    this.draw(running ? status : {});
  },
  update_buttons() {
    const { running, hold } = this.answer || {};
    for (const [node, is_off] of [[this.hold, !running || hold], [this.resume, !hold]]) if (node.disabled !== is_off) node.disabled = is_off;
  },
  draw({ vehicle, survey }) {
    const objects = [], { view, path } = survey || {};
    if (path) objects.push({ id: "leg", role: "next", shape: "line", points: path, is_fixed: true });
    if (view) objects.push({ id: "next", role: "next", shape: "view", points: [view.position], direction: view.direction, is_fixed: true });
    if (vehicle) objects.push({ id: "vehicle", role: "vehicle", shape: "point", points: [vehicle.position], name: "vehicle", is_fixed: true });
    this.stage.set(objects, ["next"]);
  },
};

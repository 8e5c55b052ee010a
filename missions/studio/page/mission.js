// Step 3: the mission file, as a form and as text.

/// Keys that people set first. The others follow by section.
const first_keys = ["name", "flight.vehicle", "flight.takeoff", "flight.clearance", "sensor.photo_camera", "sensor.preset",
  "sensor.lidar", "photo.gsd", "limits.max_views", "limits.max_minutes", "site.max_height", "flight.reserve"];

/// Returns [path, schema] of all keys of a schema that hold one value.
function keys_of(schema, prefix = "") {
  return Object.entries(schema.properties || {}).flatMap(([name, one]) =>
    one.properties ? keys_of(one, prefix + name + ".") : [[prefix + name, one]]);
}

function limits_text(schema) {
  const parts = [];
  if (schema.exclusiveMinimum !== undefined) parts.push("above " + schema.exclusiveMinimum);
  if (schema.minimum !== undefined) parts.push("from " + schema.minimum);
  if (schema.maximum !== undefined && schema.maximum < 1e9) parts.push("to " + schema.maximum);
  return parts.length ? " (" + parts.join(" ") + ")" : "";
}

studio.steps.mission = {
  path: "", text: "", version: "", values: {}, inputs: new Map(), turn: Promise.resolve(),
  build(section) {
    this.file = select([]);
    this.file.addEventListener("change", () => this.open(this.file.value).catch((failure) => say(failure.message)));
    this.area = element("textarea", { spellcheck: "false", "aria-label": "Mission file", wrap: "off" });
    this.area.addEventListener("change", () => {
      const text = this.area.value;
      this.in_turn(() => {
        this.history.add(this.text);
        return this.set_text(text);
      }).catch((failure) => say(failure.message));
    });
    this.form = element("div");
    this.problem = element("p", { class: "bad", role: "alert", hidden: true });
    this.conflict = element("div", { hidden: true, role: "alert" });
    this.is_saved = element("span", { role: "status" });
    this.output = make_output("Output of the command");
    this.history = make_history(() => this.text, (text) => this.in_turn(() => this.set_text(text)));
    this.checked = element("p", { role: "status", id: "checked" });
    this.estimate = element("ul", { id: "estimate" });
    this.draw = make_draw(this);
    this.variants = make_variants(this);
    this.background = background_select();
    section.append(element("h2", {}, "Mission"), element("div", { class: "fields" }, field("Mission file", this.file),
      field("Background", this.background.node, "Orthophoto or map of the site for the 3-D view (GeoTIFF).")),
      element("div", { class: "actions" }, button("Check", () => this.check(), { id: "check" }),
        button("Save", () => this.save(), { id: "save" }), button("Show in 3-D", () => this.view()),
        button("Plan", () => this.plan(), { class: "main", id: "plan" }),
        button("Resume", () => this.plan(true)), button("Simulate the scan", () => this.scan()),
        this.history.undo, this.history.redo, this.is_saved),
      this.problem, this.conflict, this.checked, this.estimate, this.output.box, this.draw.box, this.variants.box,
      element("div", { class: "columns" }, this.form, this.area));
    // The file may be changed by other programs at any time.
    setInterval(() => { if (!document.hidden) this.compare_with_disk().catch(() => {}); }, 2000);
    addEventListener("beforeunload", (event) => { if (this.is_changed()) event.preventDefault(); });
  },
  refresh() {
    fill(this.file, files_of("mission").map((file) => file.path), "choose a mission");
    if (this.path) this.file.value = this.path;
    this.background.refresh();
    this.variants.refresh().catch((failure) => say(failure.message));
  },
  is_changed() { return this.path !== "" && this.text !== this.saved; },
  async open(path) {
    if (!path) return;
    if (!this.schema) {
      this.schema = await request("schema");
      this.build_form();
    }
    this.show(await request("mission?path=" + encodeURIComponent(path)));
    this.file.value = path;
    this.follow_running_plan();
  },
  /// Shows a plan of this mission that was started before the page was opened.
  follow_running_plan() {
    for (const job of jobs.values()) {
      const [, mission, folder] = /^skycap plan (\S+) --out=(\S+)/.exec(job.title) || [];
      if (!job.running || mission !== this.path || job.listeners.length) continue;
      const follow = this.follow_survey(folder);
      job.listeners.push(this.output.show, follow);
      this.output.show(job);
      follow(job);
    }
  },
  show(mission) {
    if (mission.path !== this.path) this.draw.box.hidden = true;
    Object.assign(this, { path: mission.path, text: mission.text, saved: mission.text, version: mission.version });
    this.conflict.hidden = true;
    this.history.clear();
    this.draw.show_survey([], new Float32Array());
    this.show_text(mission);
  },
  show_text(mission) {
    this.values = mission.values || this.values;
    this.problem.textContent = mission.error || "";
    this.problem.hidden = !mission.error;
    this.area.value = this.text;
    for (const [key, input] of this.inputs) if (input !== document.activeElement) input.value = this.values[key] || "";
    this.is_saved.textContent = this.is_changed() ? "changed, not saved" : "saved";
    this.draw.refresh();
    if (this.text !== this.checked_text) this.check_soon();
  },
  /// Reads a text that was edited: the values of the form follow it.
  async set_text(text) {
    this.text = text;
    try {
      this.show_text(await request("edit", { text, key: "" }));
    } catch (failure) {
      this.show_text({ error: failure.message });
    }
  },
  /// Runs an action that reads and changes the mission after all earlier ones have ended.
  in_turn(action) {
    const result = this.turn.then(action);
    this.turn = result.catch(() => {});
    return result;
  },
  set(key, value) { return this.in_turn(() => this.set_all([[key, value]])); },
  /// Sets several keys in one step of the history.
  async set_all(pairs) {
    this.require_mission();
    let answer = { text: this.text, values: this.values };
    for (const [key, value] of pairs) answer = await request("edit", { text: answer.text, key, value });
    if (answer.text === this.text) return;
    this.history.add(this.text);
    this.text = answer.text;
    this.show_text(answer);
  },
  /// Checks a changed text with the program after a pause in typing, one check at a time.
  check_soon() {
    clearTimeout(this.timer);
    if (!this.is_changed()) {
      this.checked.textContent = "";
      this.estimate.replaceChildren();
      return;
    }
    this.timer = setTimeout(() => this.check_now().catch((failure) => { this.checked.textContent = failure.message; }), 700);
  },
  async check_now() {
    if (this.is_checking) return this.check_soon();
    this.is_checking = true;
    const text = this.text;
    try {
      const job = await run_quietly("check", { mission: this.path }, text);
      if (text !== this.text) return;
      this.checked_text = text;
      const problem = job.lines.find((line) => line.includes("error")) || job.lines.at(-1) || "";
      this.checked.textContent = job.exit_code === 0 ? "Check passed." : problem;
      this.checked.className = job.exit_code === 0 ? "good" : "bad";
      // Views or photos, minutes, batteries, memory, and warnings with their remedies.
      const facts = job.lines.filter((line) => /^ {2}\S/.test(line) || /warning: /i.test(line));
      this.estimate.replaceChildren(...(job.exit_code === 0 ? facts : []).map((line) =>
        element("li", { class: /warning: /i.test(line) ? "bad" : null }, line.trim().replace(/ {2,}/, ": "))));
    } finally {
      this.is_checking = false;
      if (text !== this.text) this.check_soon();
    }
  },
  make_input(key, schema) {
    const words = schema.type === "boolean" ? ["true", "false"] : schema.enum;
    const input = words ? select([["", "default"], ...words]) : text_input({ "data-key": key });
    input.dataset.key = key;
    input.addEventListener("change", async () => {
      try {
        await this.set(key, input.value.trim());
        input.removeAttribute("aria-invalid");
        say("");
      } catch (failure) {
        input.setAttribute("aria-invalid", "true");
        say(failure.message);
      }
    });
    return input;
  },
  build_form() {
    const all = keys_of(this.schema), schemas = new Map(all);
    const add = (box, key) => {
      const schema = schemas.get(key), input = this.make_input(key, schema);
      this.inputs.set(key, input);
      box.append(...field(key, input, (schema.description || "") + limits_text(schema)));
    };
    const first = element("div", { class: "fields" });
    first_keys.filter((key) => schemas.has(key)).forEach((key) => add(first, key));
    this.form.append(element("h3", {}, "Main keys"), first, element("h3", {}, "Other keys"));
    const sections = [...new Set(all.map(([key]) => key.split(".")[0]))];
    for (const name of sections) {
      const keys = all.map(([key]) => key).filter((key) => key.split(".")[0] === name && !first_keys.includes(key));
      if (keys.length === 0) continue;
      const box = element("div", { class: "fields" }), details = element("details", {}, element("summary", {}, name), box);
      keys.forEach((key) => add(box, key));
      this.form.append(details);
    }
  },
  require_mission() {
    if (!this.path) throw new Error("No mission is open. Choose a mission file, or create one in the step Site.");
  },
  async check() {
    this.require_mission();
    return run_command("check", { mission: this.path }, this.output.show, this.text);
  },
  async save() {
    this.require_mission();
    const answer = await request("save", { path: this.path, text: this.text, version: this.version });
    if (answer.conflict) return this.show_conflict(answer);
    Object.assign(this, { version: answer.version, saved: this.text });
    this.conflict.hidden = true;
    this.show_text({ values: this.values });
    return true;
  },
  /// The file on disk has changed since it was read. Nothing has been written.
  show_conflict(disk) {
    this.conflict.replaceChildren(element("p", { class: "bad" }, this.path + " has been changed on disk by another program."),
      element("pre", { tabindex: "0", "aria-label": "File on disk" }, disk.text || "(the file does not exist any more)"),
      element("div", { class: "actions" }, button("Load the file on disk", () => this.show(disk)),
        button("Keep this text and replace the file", () => { this.version = disk.version; return this.save(); })));
    this.conflict.dataset.version = disk.version;
    this.conflict.hidden = false;
    return false;
  },
  async compare_with_disk() {
    if (!this.path) return;
    const { path, version } = this;
    const disk = await request("mission?path=" + encodeURIComponent(path) + "&version=" + version);
    if (disk.version === version || path !== this.path || version !== this.version) return;
    if (disk.version === this.conflict.dataset.version && !this.conflict.hidden) return;
    if (this.is_changed()) {
      this.show_conflict(disk);
    } else {
      this.show(disk);
      this.is_saved.textContent = "reloaded, because the file has changed on disk";
    }
  },
  async save_if_changed() {
    this.require_mission();
    if (!this.is_changed()) return;
    if (!await this.save()) throw new Error("The mission was not saved. Resolve the conflict first.");
  },
  async view() {
    await this.save_if_changed();
    const page = this.path.replace(/\.ya?ml$/, ".html");
    const job = await run_command("view", { what: this.path, "--out": page, ...this.background.options() });
    if (job.exit_code !== 0) {
      this.output.show(job);
      return;
    }
    this.draw.box.hidden = false;
    this.draw.stage.show(page);
  },
  results_folder() { return "results/" + stem_of(this.path); },
  async plan(resumes) {
    await this.save_if_changed();
    const folder = this.results_folder();
    const growth = this.follow_survey(folder);
    const job = await run_command("plan", { mission: this.path, "--out": folder, "--resume": !!resumes }, (view) => {
      this.output.show(view);
      growth(view);
    });
    await refresh_files();
    if (job.exit_code !== 2 && files_of("package").some((file) => file.path === folder)) {
      await studio.steps.results.open(folder);
      if (job.exit_code === 0) go_to("results");
    }
  },
  /// Shows the views and points of a running survey in the 3-D view, every second. Returns the function for its job's changes.
  follow_survey(folder) {
    const views = [], { path } = this;
    let points = new Float32Array(), stride = 0;
    let is_asking = false, is_viewed = !this.draw.box.hidden, timer = null;
    const ask = async () => {
      if (is_asking || this.path !== path) return;
      is_asking = true;
      try {
        const answer = await request("progress?path=" + encodeURIComponent(folder) + "&from=" + views.length +
          "&points=" + points.length / 3 + "&stride=" + stride);
        if (answer.views.length === 0) return;  // not begun, or ended
        if (!is_viewed) {
          is_viewed = true;
          await this.view();
        }
        views.push(...answer.views);
        const { preview } = answer, kept = points.subarray(0, 3 * preview.from);
        stride = preview.stride;
        points = new Float32Array(kept.length + preview.points.length);
        points.set(kept);
        points.set(preview.points.map((millimetres) => millimetres / 1000), kept.length);
        this.draw.show_survey(views, points);
      } catch (failure) {
        say(failure.message);
      } finally {
        is_asking = false;
      }
    };
    return (job) => {
      if (job.running && timer === null) timer = setInterval(ask, 1000);
      if (!job.running) clearInterval(timer);
    };
  },
  async scan() {
    await this.save_if_changed();
    const folder = this.results_folder() + "_scan";
    const job = await run_command("scan", { mission: this.path, "--out": folder }, this.output.show);
    await refresh_files();
    if (job.exit_code === 0) {
      await studio.steps.results.open(folder);
      go_to("results");
    }
  },
};

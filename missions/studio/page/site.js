// Step 2: from a map or model to a first mission.

/// Main figures of presets, as skycap presets prints them.
const figures = {
  vehicles: (one) => [one.autopilot, one.mass_kg.toFixed(2) + " kg", one.radius_m.toFixed(2) + " m",
    one.max_speed_m_s + " m/s", one.max_wind_m_s + " m/s", one.endurance_min.toFixed(0) + " min"],
  photo_cameras: (one) => [one.width_px + " × " + one.height_px + " px", one.focal_length_mm.toFixed(2) + " mm",
    one.gsd_at_10_m_mm.toFixed(2) + " mm", one.min_interval_s + " s", one.shutter],
  sensors: (one) => [one.kind, one.min_range_m + " to " + one.max_range_m + " m", one.width_px
    ? one.width_px + " × " + one.height_px + " px" : one.channels + " channels", one.pulses_per_s
    ? Math.round(one.pulses_per_s).toLocaleString("en") + " pulses/s" : ""],
};
const figure_heads = {
  vehicles: ["Autopilot", "Mass", "Radius", "Max speed", "Max wind", "Endurance"],
  photo_cameras: ["Image", "Focal length", "GSD at 10 m", "Interval", "Shutter"],
  sensors: ["Kind", "Range", "Resolution", "Rate"],
};

/// Table of presets with a radio button each. `value` is the selected name.
function preset_table(caption, groups, first) {
  const name = "preset" + ++field_count;
  const choose = (value, text) => {
    const input = element("input", { type: "radio", name, value });
    return element("label", {}, input, " " + text);
  };
  const box = element("div", { class: "scroll", role: "radiogroup", "aria-label": caption, tabindex: "-1" });
  box.append(element("p", {}, choose("", first)));
  for (const [group, title] of groups) {
    box.append(element("table", {}, element("thead", {}, element("tr", {}, element("th", { scope: "col" }, title),
      figure_heads[group].map((text) => element("th", { scope: "col" }, text)))),
    element("tbody", {}, studio.presets[group].map((one) => element("tr", {}, element("td", {}, choose(one.name, one.name)),
      figures[group](one).map((text) => element("td", {}, text)))))));
  }
  box.querySelector("input").checked = true;
  return { box, get value() { return box.querySelector("input:checked").value; } };
}

async function load_presets() {
  if (studio.presets) return;
  const job = await run_command("presets", { "--json": true });
  studio.presets = JSON.parse(job.lines.join("\n"));
}

function text_input(attributes = {}) {
  return element("input", { type: "text", autocomplete: "off", spellcheck: "false", ...attributes });
}

studio.steps.site = {
  build(section) {
    this.map = select([]);
    this.map.addEventListener("change", () => this.open(this.map.value).catch((failure) => say(failure.message)));
    this.target = text_input({ list: "objects" });
    this.objects = element("datalist", { id: "objects" });
    this.more = [];  // further targets
    this.more_box = element("div", { class: "actions" });
    this.inputs = { "--crs": text_input(), "--vertical": select([["", "as in the file"], "ellipsoid", "geoid"]),
      "--base": text_input(), "--height": text_input({ inputmode: "decimal" }), "--terrain": select([]),
      "--obstacle": select([]) };
    this.gsd = text_input({ inputmode: "decimal", value: "0.01" });
    this.takeoff = text_input({ placeholder: "[x, y, z]" });
    this.out = text_input();
    this.output = make_output("Output of skycap site");
    this.picture = frame("Map and 3-D view of the site");
    this.picture.hidden = true;
    this.choices = element("div");
    this.next = element("div", { class: "actions", hidden: true });
    const location = element("details", { id: "georeference" }, element("summary", {}, "Coordinate system and heights"),
      element("div", { class: "fields" },
        field("Coordinate system", this.inputs["--crs"], "Of files that specify none, such as EPSG:25832. Overrides that of the map."),
        field("Vertical datum", this.inputs["--vertical"]),
        field("Base height", this.inputs["--base"], "Of outlines, in metres, or ground: the height of the take-off point."),
        field("Height", this.inputs["--height"], "Of outlines that contain no height, in metres."),
        field("Terrain", this.inputs["--terrain"]), field("Obstacles", this.inputs["--obstacle"])));
    addEventListener("message", (event) => this.hear(event));
    section.append(element("h2", {}, "Site"), element("div", { class: "columns" },
      element("div", {}, element("div", { class: "fields" }, field("Map or model", this.map),
        field("Target", this.target, "Click it in the map, or enter its name. Empty: the whole model.")),
      this.objects, this.more_box, location, this.choices,
      element("div", { class: "fields" },
        field("Ground sampling distance [m]", this.gsd, "For photo cameras."),
        field("Take-off point [m]", this.takeoff, "In the mission frame. Empty: proposed by Skycap."),
        field("Mission file", this.out)),
      element("div", { class: "actions" }, button("Create the mission", () => this.create(), { class: "main", id: "create" })),
      this.output.box, this.next),
      element("div", {}, this.picture)));
  },
  refresh() {
    fill(this.map, files_of("map", "model").map((file) => file.path), "choose a file");
    for (const name of ["--terrain", "--obstacle"]) {
      fill(this.inputs[name], files_of("map", "model", "cloud").map((file) => file.path), "none");
    }
  },
  /// Receives names from the map of objects. It is a file, so its messages are not trusted.
  hear(event) {
    if (event.source !== this.picture.contentWindow || typeof event.data !== "object" || !event.data) return;
    const { object, objects } = event.data;
    if (typeof object === "string") {
      this.target.value = object;
      if (!this.more.length) this.out.value = free_name(stem_of(object), ".yaml");
    }
    if (Array.isArray(objects)) {
      this.objects.replaceChildren(...objects.slice(0, 5000).map((name) => element("option", { value: String(name) })));
      this.picture.dataset.objects = objects.length;
    }
  },
  /// Shows the further targets, and a button that adds the one in the field to them.
  set_more(names) {
    this.more = names;
    this.more_box.replaceChildren(button("Choose another target, too", () => {
      const name = this.target.value.trim();
      if (!name) throw new Error("Click the first target, or enter its name.");
      this.target.value = "";
      this.set_more([...names.filter((one) => one !== name), name]);
    }, { id: "more-targets" }), ...names.map((name) => button("Remove " + name, () =>
      this.set_more(names.filter((one) => one !== name)))));
  },
  is_model() {
    return studio.listing.some((file) => file.path === this.map.value && file.kind === "model");
  },
  options() {
    const options = { map: this.map.value };
    for (const [name, input] of Object.entries(this.inputs)) if (input.value.trim()) options[name] = input.value.trim();
    return options;
  },
  async open(path) {
    await load_presets();
    this.map.value = path;
    this.target.value = "";
    this.set_more([]);
    this.out.value = free_name(stem_of(path), ".yaml");
    this.picture.hidden = true;
    this.next.hidden = true;
    if (!this.vehicle) {
      this.sensor = preset_table("Sensor", [["photo_cameras", "Photo camera"], ["sensors", "Depth camera or LiDAR"]],
        "chosen by Skycap");
      this.vehicle = preset_table("Vehicle", [["vehicles", "Vehicle"]], "chosen by Skycap");
      this.choices.append(element("h3", {}, "Sensor"), this.sensor.box, element("h3", {}, "Vehicle"), this.vehicle.box);
    }
    if (!path || this.is_model()) return;
    const out = free_name(stem_of(path) + "_map", ".yaml");
    const job = await run_command("site", { ...this.options(), "--out": out }, this.output.show);
    await refresh_files();
    this.map.value = path;
    if (job.exit_code === 1) show_in(this.picture, out.replace(/yaml$/, "objects.html"));
    if (job.exit_code === 0) await this.show_mission(out);  // one object: the mission is written
    this.ask_for_reference(job);
  },
  /// Opens the fields of the coordinate system and the heights if they are missing or assumed.
  ask_for_reference({ exit_code: code, lines }) {
    if (code === 2 || lines.some((line) => /missing (vertical datum|coordinate reference system)/.test(line))) {
      by_id("georeference").open = true;
    }
  },
  async create() {
    await load_presets();
    const camera = studio.presets.photo_cameras.some((one) => one.name === this.sensor.value);
    const shared = { "--out": this.out.value }, targets = [...new Set([...this.more, this.target.value.trim()])].filter(Boolean);
    if (this.sensor.value) shared["--sensor"] = this.sensor.value;
    if (this.vehicle.value) shared["--vehicle"] = this.vehicle.value;
    if (camera) shared["--gsd"] = this.gsd.value;
    const job = this.is_model()
      ? await run_command("init", { ...shared, target: this.map.value }, this.output.show)
      : await run_command("site", { ...this.options(), ...shared, ...(targets.length ? { "--id": targets } : {}) },
        this.output.show);
    this.ask_for_reference(job);
    if (job.exit_code !== 0) return;
    await refresh_files();
    await this.show_mission(this.out.value);
  },
  /// Sets the take-off point of a new mission and shows it in 3-D.
  async show_mission(path) {
    await studio.steps.mission.open(path);
    if (this.takeoff.value.trim()) {
      await studio.steps.mission.set("flight.takeoff", this.takeoff.value.trim());
      await studio.steps.mission.save();
    }
    const page = path.replace(/\.ya?ml$/, ".html");
    const is_photo = !!studio.steps.mission.values["sensor.photo_camera"];
    if (this.is_model() && !is_photo) {
      const job = await run_command("view", { what: path, "--out": page }, this.output.show);
      if (job.exit_code !== 0) return;
    }
    if (!this.is_model()) show_in(this.picture, page);
    else if (!is_photo) show_in(this.picture, page);
    this.next.replaceChildren(button("Edit the mission", () => go_to("mission")),
      button("Draw on the site", () => { go_to("mission"); return studio.steps.mission.view(); }, { id: "draw-now" }),
      button("Plan", () => { go_to("mission"); return studio.steps.mission.plan(); }, { class: "main", id: "plan-now" }));
    this.next.hidden = false;
  },
  async view_cloud(path) {
    const page = path.replace(/\.[^.]*$/, ".html");
    const job = await run_command("view", { what: path, "--out": page }, this.output.show);
    if (job.exit_code === 0) show_in(this.picture, page);
  },
};

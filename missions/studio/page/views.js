// Edits the views of a planned flight: they are moved, added and removed, and the program verifies the
// new route in the space of the results folder (skycap export --route).

/// Returns the views to which the legs of the flight refer: those of the survey, or the replanned ones.
function planned_views(summary) {
  const { replanned } = summary.flight || {};
  return replanned && replanned.is_flown ? replanned.stations : summary.per_view || [];
}

/// Returns [{view, position, direction, via, from}] in flight order. `via` are the points of the leg to the
/// view, and `from` is the view at which this leg begins.
function flown_views(summary) {
  if (summary.kind === "inspection") {
    throw new Error("Inspection flights are continuous and cannot be edited view by view. Change the mission and plan again.");
  }
  if (((summary.flight || {}).fleet || {}).vehicles) {
    throw new Error("Flights of several vehicles cannot be edited view by view. Set flight.vehicle instead of flight.vehicles and plan again.");
  }
  const planned = planned_views(summary);
  const sorties = ((summary.flight || {}).route || {}).sorties || [];
  if (!planned.length || !sorties.length || !sorties[0].legs) {
    throw new Error("These results contain no views of a flight that can be edited.");
  }
  const views = [];
  for (const leg of sorties.flatMap((sortie) => sortie.legs)) {
    if (leg.to === null || leg.to === undefined) continue;
    const { position, direction } = planned[leg.to];
    views.push({ view: leg.to, position, direction, via: leg.points.slice(1, -1), from: leg.from ?? null });
  }
  return views;
}

/// Returns the inner points of the leg to a view: those of the plan if both of its ends are unchanged.
function leg_points(views, i, original) {
  const view = views[i], before = i > 0 ? views[i - 1].view : null;
  const is_same = (one) => one && one.view !== null && one.position === (original[one.view] || {}).position;
  return is_same(view) && view.from === before && (i === 0 || is_same(views[i - 1])) ? view.via : [];
}

/// Returns the route as a waypoint table in the mission's frame, and what each line is.
function route_text(views, original, names) {
  const rows = ["x,y,z,heading_deg,gimbal_pitch_deg,photos"], lines = new Map();
  const add = (place, direction, photos) => {
    rows.push([...place, heading_of(direction), pitch_of(direction)].map((value) => value.toFixed(6)).join(",") + "," + photos);
  };
  views.forEach((view, i) => {
    for (const place of leg_points(views, i, original)) {
      add(place, view.direction, 0);
      lines.set("line " + rows.length, "corner before " + names[i]);
    }
    add(view.position, view.direction, 1);
    lines.set("line " + rows.length, names[i]);
  });
  return { text: rows.join("\n") + "\n", lines };
}

const heading_of = ([x, y]) => (Math.atan2(x, y) * 180 / Math.PI + 360) % 360;
const pitch_of = ([, , z]) => Math.asin(Math.max(-1, Math.min(1, z))) * 180 / Math.PI;

function direction_of(heading, pitch) {
  const yaw = heading * Math.PI / 180, tilt = pitch * Math.PI / 180;
  return [Math.cos(tilt) * Math.sin(yaw), Math.cos(tilt) * Math.cos(yaw), Math.sin(tilt)];
}

/// `stage` shows the report of the results folder that `folder()` returns.
function make_view_editor(stage, folder) {
  const editor = { views: [], original: [], selected: 0, folder: "" };
  const history = make_history(() => editor.views, (views) => editor.set(views, true));
  const list = element("select", { size: "6", id: "views", "aria-label": "Views in flight order" });
  list.addEventListener("change", () => editor.select(list.selectedIndex));
  const names = ["x", "y", "z", "heading", "pitch"];
  const inputs = names.map((name) => number_input("View " + name, null, (value) => editor.enter(name, value), { "data-name": name }));
  const repairs = element("input", { type: "checkbox", id: "repair" });
  const verdict = element("p", { role: "status", id: "verdict" });
  const output = make_output("Output of the verification");
  const files = element("p", { class: "actions" });
  editor.box = element("div", { hidden: true, id: "view-editor" },
    element("h3", {}, "Views"),
    element("p", { class: "note" }, "Drag a view in the 3-D view, with Shift vertically, or enter numbers: metres in the mission frame and degrees."),
    element("div", { class: "actions" }, button("Verify", () => editor.verify(), { class: "main", id: "verify" }),
      element("label", {}, repairs, " Lead legs round obstacles")),
    verdict, files, list,
    element("div", { class: "fields" }, names.flatMap((name, i) => field({ x: "x [m]", y: "y [m]", z: "z [m]", heading: "Heading [°]",
      pitch: "Gimbal pitch [°]" }[name], inputs[i]))),
    element("div", { class: "actions" }, button("Add a view after it", () => editor.add(), { id: "add-view" }),
      button("Remove the view", () => editor.remove(), { id: "remove-view" }), history.undo, history.redo),
    output.box);

  const changed = (change) => editor.set(editor.views.with(editor.selected, { ...editor.views[editor.selected], ...change }));
  Object.assign(editor, {
    async open() {
      editor.folder = folder();
      const answer = await fetch(file_address(editor.folder + "/summary.json"));
      if (!answer.ok) throw new Error(editor.folder + " contains no summary.json");
      const summary = await answer.json();
      editor.original = planned_views(summary);
      editor.set(flown_views(summary), true);
      history.clear();
      verdict.textContent = "";
      files.replaceChildren();
      output.box.hidden = true;
      editor.box.hidden = false;
    },
    close() {
      editor.box.hidden = true;
      stage.set([], []);
    },
    /// Sets the views and shows them. `is_step` is true for a step of the history itself.
    set(views, is_step) {
      if (!is_step) history.add(editor.views);
      editor.views = views;
      verdict.textContent = history.past.length ? "Changed; not verified." : "";
      verdict.className = "";
      list.replaceChildren(...views.map(({ view }, i) => element("option", {}, (i + 1) + ": " + (view === null ? "new view" : "view " + view))));
      editor.select(Math.min(editor.selected, views.length - 1));
    },
    select(index) {
      editor.selected = index;
      list.selectedIndex = index;
      const { position, direction } = editor.views[index];
      const values = [...position, heading_of(direction), pitch_of(direction)];
      inputs.forEach((input, i) => { input.value = Math.round(100 * values[i]) / 100; });
      editor.draw();
    },
    draw() {
      const path = editor.views.flatMap((view, i) => [...leg_points(editor.views, i, editor.original), view.position]);
      stage.set([{ id: "path", role: "line", shape: "line", points: path, is_fixed: true },
        ...editor.views.map((view, i) => ({ id: String(i), role: "view", shape: "view", points: [view.position],
          direction: view.direction, is_selected: i === editor.selected, name: i === editor.selected ? list.value : "" }))],
      ["views", "route", "clearance", "fleet"]);
    },
    enter(name, value) {
      if (value === null) throw new Error("View " + name + " requires a number");
      const { position, direction } = editor.views[editor.selected], axis = names.indexOf(name);
      if (axis < 3) return changed({ position: position.with(axis, value) });
      const heading = name === "heading" ? value : heading_of(direction), pitch = name === "pitch" ? value : pitch_of(direction);
      return changed({ direction: direction_of(heading, Math.max(-90, Math.min(90, pitch))) });
    },
    moved(id, [position], is_over) {
      const index = Number(id);
      if (editor.box.hidden || !editor.views[index]) return;
      editor.selected = index;
      if (is_over) changed({ position });
      else names.slice(0, 3).forEach((_, axis) => { inputs[axis].value = position[axis]; });
    },
    /// Adds a view halfway to the next one, with the same direction.
    add() {
      const view = editor.views[editor.selected], next = editor.views[editor.selected + 1] || view;
      const position = view.position.map((value, axis) => Math.round(50 * (value + next.position[axis])) / 100);
      const added = { view: null, position, direction: view.direction, via: [], from: null };
      editor.selected += 1;
      editor.set(editor.views.toSpliced(editor.selected, 0, added));
    },
    remove() {
      if (editor.views.length < 2) throw new Error("A flight requires at least one view.");
      editor.set(editor.views.toSpliced(editor.selected, 1));
    },
    async verify() {
      const started = performance.now(), view_names = [...list.options].map((one) => one.textContent);
      const { text, lines } = route_text(editor.views, editor.original, view_names);
      const name = stem_of(editor.folder) + ".edited.csv", out = editor.folder + "_edited";
      if (!await send_file(new File([text], name), editor.is_sent === name)) return;
      editor.is_sent = name;
      const job = await run_command("export", { package: editor.folder, "--route": name, "--out": out,
        "--repair": repairs.checked }, output.show);
      const said = (line) => line.replace(name + ": ", "").replace(/line \d+/g, (one) => lines.get(one) || one);
      const figures = job.lines.filter((line) => /^ {2}(flight|clearance|return|repaired|skipped) /.test(line)).map((line) => said(line.trim()));
      const seconds = ((performance.now() - started) / 1000).toFixed(1);
      const problem = job.lines.find((line) => line.includes(": leg ")) || job.lines.find((line) => line.startsWith(name + ":")) ||
        job.lines.find((line) => line.includes("error")) || "not verified";
      verdict.textContent = job.exit_code === 0 ? "Verified in " + seconds + " s. " + figures.join(". ")
        : "Not verified: " + said(problem) + " (" + seconds + " s)";
      verdict.className = job.exit_code === 0 ? "good" : "bad";
      verdict.dataset.seconds = seconds;
      verdict.dataset.exit = job.exit_code;
      files.replaceChildren();
      if (job.exit_code !== 0) return;
      const { files: written } = await request("package?path=" + encodeURIComponent(out));
      files.replaceChildren(...written.map((file) => element("a", { class: "button",
        href: file_address(out + "/" + file.path, "?download=1"), download: file.path }, "Download ", file.path)));
    },
  });
  return editor;
}

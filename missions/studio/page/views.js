// Edits the views of a planned flight, also of a fleet, and the corners of an inspection flight: they are
// moved, added and removed, and the program verifies the new flight (skycap export --route).

/// Returns the views to which the legs of the flight refer: those of the survey, or the replanned ones.
function planned_views(summary) {
  const { replanned } = summary.flight || {};
  return replanned && replanned.is_flown ? replanned.stations : summary.per_view || [];
}

const header = "x,y,z,heading_deg,gimbal_pitch_deg,";

/// Kinds of flights: words, additional fields, and the columns of the route.
const flight_kinds = {
  survey: { noun: "view", title: "Views", more: [], columns: header + "photos", end: () => "1", has_repair: true,
    note: "" },
  fleet: { noun: "view", title: "Views of all vehicles", more: ["vehicle"], columns: header + "photos,vehicle",
    end: ({ vehicle }) => "1," + vehicle, has_repair: false,
    note: " Legs are led round obstacles, take-offs are delayed until all distances between vehicles are verified." },
  inspection: { noun: "corner", title: "Corners of the flight", more: ["delay"], columns: header + "delay_s",
    end: ({ delay }) => delay.toFixed(6), has_repair: false,
    note: " The flight rounds the corners. The delay slows the leg to the next corner." },
};

function flight_kind(summary) {
  if (summary.kind === "inspection") return "inspection";
  return ((summary.flight || {}).fleet || {}).vehicles ? "fleet" : "survey";
}

/// Returns [{view, position, direction, via, from}] in flight order, with the vehicle or the delay. `via` are the points of
/// the leg to the view, and `from` is the view at which this leg begins.
function flown_views(summary) {
  const kind = flight_kind(summary);
  if (kind === "inspection") {
    return summary.inspection.vertices.map(({ position, yaw_deg: yaw, pitch_deg: pitch, delay_s: delay }, view) =>
      ({ view, position, direction: direction_of(90 - yaw, pitch), via: [], from: null, delay }));
  }
  const { route, fleet } = summary.flight || {}, planned = planned_views(summary);
  const flights = kind === "fleet" ? fleet.vehicles : [route || {}];
  const legs = flights.flatMap(({ sorties }, i) => (sorties || []).flatMap((sortie) => sortie.legs || [])
    .map((leg) => ({ ...leg, vehicle: i + 1 }))).filter(({ to }) => planned[to]);
  if (!legs.length) throw new Error("These results contain no views of a flight that can be edited.");
  return legs.map(({ to, from, points, vehicle }) => ({ view: to, position: planned[to].position, direction: planned[to].direction,
    via: kind === "fleet" ? [] : points.slice(1, -1), from: from ?? null, vehicle }));
}

/// Returns the inner points of the leg to a view: those of the plan if both of its ends are unchanged.
function leg_points(views, i, original) {
  const view = views[i], before = i > 0 ? views[i - 1].view : null;
  const is_same = (one) => one && one.view !== null && one.position === (original[one.view] || {}).position;
  return is_same(view) && view.from === before && (i === 0 || is_same(views[i - 1])) ? view.via : [];
}

/// Returns the route as a table in the mission's frame, and what each line is.
function route_text(views, original, names, kind) {
  const rows = [flight_kinds[kind].columns], lines = new Map();
  const add = (place, direction, end) => {
    rows.push([...place, heading_of(direction), pitch_of(direction)].map((value) => value.toFixed(6)).join(",") + "," + end);
  };
  views.forEach((view, i) => {
    for (const place of leg_points(views, i, original)) {
      add(place, view.direction, "0");
      lines.set("line " + rows.length, "point before " + names[i]);
    }
    add(view.position, view.direction, flight_kinds[kind].end(view));
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
  const editor = { views: [], original: [], selected: 0, folder: "", kind: "survey" };
  const history = make_history(() => editor.views, (views) => editor.set(views, true));
  const list = element("select", { size: "6", id: "views", "aria-label": "Views in flight order" });
  list.addEventListener("change", () => editor.select(list.selectedIndex));
  const names = ["x", "y", "z", "heading", "pitch", "vehicle", "delay"];
  const labels = { x: "x [m]", y: "y [m]", z: "z [m]", heading: "Heading [°]", pitch: "Gimbal pitch [°]", vehicle: "Vehicle",
    delay: "Delay [s]" };
  const inputs = names.map((name) => number_input("View: " + labels[name], null, (value) => editor.enter(name, value), { "data-name": name }));
  const rows = names.map((name, i) => element("div", { class: "fields" }, field(labels[name], inputs[i])));
  const repairs = element("input", { type: "checkbox", id: "repair" });
  const repair_label = element("label", {}, repairs, " Lead legs round obstacles");
  const verdict = element("div", { role: "status", id: "verdict" });
  const show_verdict = (text, is_good, figures = []) => verdict.replaceChildren(
    element("p", { class: is_good === null ? null : is_good ? "good" : "bad" }, text),
    ...(figures.length ? [element("ul", {}, figures.map((one) => element("li", {}, one)))] : []));
  const output = make_output("Output of the verification");
  const files = element("p", { class: "actions" });
  const title = element("h3", {}), note = element("p", { class: "note" });
  const add = button("", () => editor.add(), { id: "add-view" }), remove = button("", () => editor.remove(), { id: "remove-view" });
  editor.box = element("div", { hidden: true, id: "view-editor" }, title, note,
    element("div", { class: "actions" }, button("Verify", () => editor.verify(), { class: "main", id: "verify" }), repair_label),
    verdict, files, list, rows, element("div", { class: "actions" }, add, remove, history.undo, history.redo), output.box);
  const start = (kind) => {
    const { noun, more, has_repair } = flight_kinds[kind];
    editor.kind = kind;
    title.textContent = flight_kinds[kind].title;
    note.textContent = "Drag a " + noun + " in the 3-D view, with Shift vertically, or enter numbers: metres in the mission frame and degrees." +
      flight_kinds[kind].note;
    add.textContent = "Add a " + noun + " after it";
    remove.textContent = "Remove the " + noun;
    repair_label.hidden = !has_repair;
    rows.slice(5).forEach((row, i) => { row.hidden = !more.includes(names[5 + i]); });
  };

  const changed = (change) => editor.set(editor.views.with(editor.selected, { ...editor.views[editor.selected], ...change }));
  Object.assign(editor, {
    async open() {
      editor.folder = folder();
      const answer = await fetch(file_address(editor.folder + "/summary.json"));
      if (!answer.ok) throw new Error(editor.folder + " contains no summary.json");
      const summary = await answer.json();
      start(flight_kind(summary));
      editor.original = planned_views(summary);
      editor.vehicles = editor.kind === "fleet" ? summary.flight.fleet.vehicles.length : 1;
      editor.set(flown_views(summary), true);
      history.clear();
      verdict.replaceChildren();
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
      if (history.past.length) show_verdict("Changed; not verified.", null);
      else verdict.replaceChildren();
      delete verdict.dataset.exit;
      const { noun } = flight_kinds[editor.kind];
      list.replaceChildren(...views.map(({ view, vehicle }, i) => element("option", {}, (i + 1) + ": " +
        (view === null ? "new " + noun : noun + " " + view) + (editor.kind === "fleet" ? ", vehicle " + vehicle : ""))));
      editor.select(Math.min(editor.selected, views.length - 1));
    },
    select(index) {
      editor.selected = index;
      list.selectedIndex = index;
      const { position, direction, vehicle, delay } = editor.views[index];
      const values = [...position, heading_of(direction), pitch_of(direction), vehicle || 0, delay || 0];
      inputs.forEach((input, i) => { input.value = Math.round(100 * values[i]) / 100; });
      editor.draw();
    },
    draw() {
      const paths = new Map();
      editor.views.forEach((view, i) => paths.set(view.vehicle, [...(paths.get(view.vehicle) || []),
        ...leg_points(editor.views, i, editor.original), view.position]));
      stage.set([...[...paths].map(([vehicle, points]) => ({ id: "path" + vehicle, role: "line", shape: "line", points, is_fixed: true })),
        ...editor.views.map((view, i) => ({ id: String(i), role: "view", shape: "view", points: [view.position],
          direction: view.direction, is_selected: i === editor.selected, name: i === editor.selected ? list.value : "" }))],
      ["views", "route", "clearance", "fleet"]);
    },
    enter(name, value) {
      if (value === null) throw new Error("View " + name + " requires a number");
      const { position, direction } = editor.views[editor.selected], axis = names.indexOf(name);
      if (name === "vehicle") return editor.assign(value);
      if (name === "delay") {
        if (value < 0) throw new Error("The delay must not be negative.");
        return changed({ delay: value });
      }
      if (axis < 3) return changed({ position: position.with(axis, value) });
      const heading = name === "heading" ? value : heading_of(direction), pitch = name === "pitch" ? value : pitch_of(direction);
      return changed({ direction: direction_of(heading, Math.max(-90, Math.min(90, pitch))) });
    },
    /// Gives the view to another vehicle, after its other views.
    assign(vehicle) {
      if (!Number.isInteger(vehicle) || vehicle < 1 || vehicle > editor.vehicles) {
        throw new Error("The vehicle must be a number from 1 to " + editor.vehicles + ".");
      }
      const view = { ...editor.views[editor.selected], vehicle }, rest = editor.views.toSpliced(editor.selected, 1);
      const at = rest.findLastIndex((one) => one.vehicle <= vehicle) + 1;
      editor.selected = at;
      editor.set(rest.toSpliced(at, 0, view));
    },
    moved(id, [position], is_over) {
      const index = Number(id);
      if (editor.box.hidden || !editor.views[index]) return;
      editor.selected = index;
      if (is_over) changed({ position });
      else names.slice(0, 3).forEach((_, axis) => { inputs[axis].value = position[axis]; });
    },
    /// Adds a view halfway to the next one of the same vehicle, with the same direction.
    add() {
      const view = editor.views[editor.selected], after = editor.views[editor.selected + 1];
      const next = after && after.vehicle === view.vehicle ? after : view;
      const position = view.position.map((value, axis) => Math.round(50 * (value + next.position[axis])) / 100);
      editor.selected += 1;
      editor.set(editor.views.toSpliced(editor.selected, 0, { ...view, view: null, position, via: [], from: null, delay: 0 }));
    },
    remove() {
      const least = editor.kind === "inspection" ? 2 : 1;
      if (editor.views.length <= least) throw new Error("A flight requires at least " + (least === 1 ? "one view." : "two corners."));
      editor.set(editor.views.toSpliced(editor.selected, 1));
    },
    async verify() {
      const started = performance.now(), view_names = [...list.options].map((one) => one.textContent);
      const { text, lines } = route_text(editor.views, editor.original, view_names, editor.kind);
      const name = stem_of(editor.folder) + ".edited.csv", out = editor.folder + "_edited";
      if (!await send_file(new File([text], name), editor.is_sent === name)) return;
      editor.is_sent = name;
      const job = await run_command("export", { package: editor.folder, "--route": name, "--out": out,
        "--repair": repairs.checked && !repair_label.hidden }, output.show);
      const said = (line) => line.replace(name + ": ", "").replace(/line \d+/g, (one) => lines.get(one) || one);
      const is_figure = (line) => /^ {2}(flight|clearance|return|repaired|skipped|slowed|coverage|vehicle|fleet|separation) /.test(line) ||
        line.includes(": continuous flight of ") || /^Warning: .*(route files|attainable points)/.test(line);
      const figures = job.lines.filter(is_figure).map((line) => said(line.trim().replace(/\.$/, "")));
      const seconds = ((performance.now() - started) / 1000).toFixed(1);
      const problem = job.lines.find((line) => line.includes(": leg ")) || job.lines.find((line) => line.startsWith(name + ":")) ||
        job.lines.find((line) => line.includes("error")) || "not verified";
      if (job.exit_code === 0) show_verdict("Verified in " + seconds + " s.", true, figures);
      else show_verdict("Not verified: " + said(problem) + " (" + seconds + " s)", false);
      verdict.dataset.seconds = seconds;
      verdict.dataset.exit = job.exit_code;
      files.replaceChildren();
      if (job.exit_code !== 0) return;
      const { files: written } = await request("package?path=" + encodeURIComponent(out));
      if (written.some((file) => file.path === "report.html")) {
        files.append(button("Open the new results", async () => {
          await refresh_files();
          await studio.steps.results.open(out);
        }, { id: "open-edited" }));
      }
      files.append(...written.filter((file) => file.path !== "report.html").map((file) => element("a", { class: "button",
        href: file_address(out + "/" + file.path, "?download=1"), download: file.path }, "Download ", file.path)));
    },
  });
  return editor;
}

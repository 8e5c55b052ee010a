// Assembles the page.

function read_data() {
  const background = document.getElementById("background");
  return { ...JSON.parse(document.getElementById("data").textContent),
    background: background ? JSON.parse(background.textContent) : null };
}

/// Loads a deflated library. The content security policy contains the hash of its text.
async function load_library(name) {
  const text = new TextDecoder().decode(await inflated("library-" + name));
  const script = document.createElement("script");
  script.textContent = text;
  document.head.append(script);
}

const kinds = { survey: "Survey report", cloud: "Point cloud", mission: "Mission, before the survey",
  scan: "Scan report", comparison: "Benchmark", trials: "Trials of a mission", photos: "Photo mission", inspection: "Inspection flight",
  flown: "Flight compared with its plan", district: "District report" };

function facts_of(data) {
  const settings = value_at(data, "summary.settings") || {}, facts = [];
  const add = (text) => { if (text) facts.push(element("span", {}, text)); };
  add(settings["scene.model"]);
  if (settings["site.latitude_deg"] !== undefined && settings["site.longitude_deg"] !== undefined) {
    add(shown(settings["site.latitude_deg"], "latitude") + ", " + shown(settings["site.longitude_deg"], "longitude"));
  }
  add(settings["flight.vehicle"] && settings["flight.vehicle"] !== "none" ? "vehicle " + settings["flight.vehicle"] : "no vehicle");
  const image = settings["sensor.width"] ? ", " + settings["sensor.width"] + " × " + settings["sensor.height"] + " pixels" : "";
  add("sensor " + (settings["sensor.photo_camera"] || settings["sensor.lidar"] || (settings["sensor.preset"] || "of the mission") + image));
  if (!settings["sensor.photo_camera"]) add("planner " + (settings["planner.name"] || "–"));
  return data.facts ? data.facts.map((text) => element("span", {}, text)) : facts;
}

function head(data) {
  const parts = [element("div", { class: "kind" }, kinds[data.kind] || ""), element("h1", {}, data.title),
    element("div", { class: "facts" }, facts_of(data))];
  const verdict = data.verdict;
  if (verdict) {
    parts.push(element("div", { class: "verdict " + verdict.light },
      verdict.answer + ": " + verdict.because));
    parts.push(element("div", { class: "lights" }, verdict.lights.map((light) => element("div", { class: "light " + light.light },
      element("b", { "data-figure": light.figure, "data-form": light.form }, shown(light.value, light.form)),
      element("span", { class: "name" }, light.name),
      light.rule ? element("span", { class: "rule" }, light.rule.replaceAll(" %", "\u00a0%")) : null))));
  }
  document.getElementById("head").replaceChildren(...parts);
}

async function clouds_of(data) {
  const clouds = {};
  for (const [name, header] of Object.entries(data.clouds)) clouds[name] = await decode_cloud(name, header);
  return clouds;
}

/// Returns the 3-D view, or the reason why it is not available. The rest of the page does not
/// depend on it.
function view_section(data, clouds, skycap) {
  const stage = element("div", { class: "stage" });
  const section = element("section", { class: "view", id: "view" }, stage);
  document.getElementById("main").append(section);
  try {
    skycap.panel = new Panel(stage, data, clouds);
    section.append(...skycap.panel.bars);
    skycap.panel.viewer.resize();
    if (parent !== window) skycap.panel.editor = new Editor(skycap.panel);
  } catch (failure) {
    stage.append(element("p", { class: "notice" }, "3-D view not available: " + failure.message));
  }
  section.append(element("div", { class: "pictures" }));
}

/// Pictures for printing: the current view, and the view from above.
function take_pictures(skycap) {
  const { viewer } = skycap.panel, box = document.querySelector(".pictures");
  const before = [viewer.camera.position.clone(), viewer.controls.target.clone()];
  const picture = () => {
    viewer.draw();
    return element("img", { src: viewer.canvas.toDataURL("image/png"), alt: "the survey" });
  };
  const now = picture();
  viewer.look("top", false);
  const top = picture();
  viewer.move_to(...before, false);
  box.replaceChildren(now, top);
}

/// Returns the sections below the view.
function sections_of(data, skycap) {
  if (data.kind === "comparison" || data.kind === "trials") {
    return [...comparison_sections(data), files_section(data), how_section(how_compared)];
  }
  if (data.kind === "district") return district_sections(data);
  if (data.kind === "photos") return photo_sections(data);
  if (data.kind === "flown") return flown_sections(data, skycap);
  if (data.kind === "scan") {
    return [scan_section(data), scan_charts(data), accuracy_section(data), files_section(data),
      settings_section(data), how_section(how_scanned)];
  }
  return [targets_section(data), holes_section(data, (number) => skycap.panel && skycap.panel.tell_hole(number)),
    survey_charts(data), flight_section(data), accuracy_section(data), files_section(data),
    settings_section(data), data.kind === "survey" ? how_section(how_surveyed) : null];
}

async function show() {
  const started = performance.now();
  const data = { summary: {}, hole_places: [], ...read_data() };
  const skycap = { data, panel: null, clouds: {} };
  order_states(data.scales);
  head(data);
  if (Object.keys(data.clouds).length) {
    await load_library("three");
    await load_library("orbit");
    skycap.clouds = await clouds_of(data);
    view_section(data, skycap.clouds, skycap);
  }
  await load_library("chart");
  document.getElementById("main").append(...sections_of(data, skycap).filter(Boolean));
  draw_charts();
  const foot = "Made by Skycap " + data.version + " from the results in the same folder. This page loads no external content.";
  document.getElementById("foot").append(element("p", {}, foot));
  follow(skycap, started);
  addEventListener("beforeprint", () => {
    document.querySelectorAll("details").forEach((one) => { one.open = true; });
    if (skycap.panel) take_pictures(skycap);
  });
  return skycap;
}

/// Sets `window.skycap` for scripts that control the page: a Promise that resolves to the displayed
/// objects.
function main() {
  window.skycap = show().catch((failure) => {
    document.getElementById("main").append(element("p", { class: "notice" }, "Cannot show the page: " + failure.message));
    throw failure;
  });
}

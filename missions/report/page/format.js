// Formats values and creates elements. Names always become text, never markup.

const thin_space = "\u2009";

function grouped(text) {
  const [whole, fraction] = text.split(".");
  const digits = whole.replace(/\B(?=(\d{3})+$)/g, thin_space);
  return fraction === undefined ? digits : digits + "." + fraction;
}

/// Formatting functions by name.
const forms = {
  text: (value) => String(value),
  count: (value) => grouped(Math.round(value).toString()),
  mean: (value) => grouped(value.toFixed(1)),
  share: (value) => (100 * value).toFixed(2) + " %",
  metres: (value) => grouped(value.toFixed(2)) + " m",
  square_metres: (value) => grouped(value.toFixed(value < 1 ? 4 : 2)) + " m²",
  cubic_metres: (value) => grouped(value.toFixed(0)) + " m³",
  millimetres: (value) => (1000 * value).toFixed(1) + " mm",
  minutes: (value) => (value / 60).toFixed(1) + " min",
  seconds: (value) => (value < 1 ? (1000 * value).toFixed(1) + " ms" : value.toFixed(2) + " s"),
  clock: (value) => value.toFixed(1) + " s",
  watt_hours: (value) => value.toFixed(1) + " Wh",
  degrees: (value) => value.toFixed(1) + "°",
  latitude: (value) => Math.abs(value).toFixed(7) + (value < 0 ? "° S" : "° N"),
  longitude: (value) => Math.abs(value).toFixed(7) + (value < 0 ? "° W" : "° E"),
  bytes: (value) =>
    value < 1e6 ? (value / 1e3).toFixed(1) + " kB" : grouped((value / 1e6).toFixed(1)) + " MB",
};

function shown(value, form) {
  if (value === null || value === undefined) return "–";
  if (typeof value === "number" && !Number.isFinite(value)) return "–";
  return forms[form](value);
}

/// Returns an element with attributes. Its children are elements or strings.
function element(tag, attributes, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name === "class") made.className = value;
    else if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value);
  }
  for (const child of children.flat()) {
    if (child === null || child === undefined) continue;
    made.append(child);
  }
  return made;
}

/// Returns the value at a path such as "flight.route.sorties.0.energy_wh".
function value_at(data, path) {
  return path.split(".").reduce(
    (value, key) => (value === null || value === undefined ? undefined : value[key]), data);
}

/// Returns a value of the summary as an element with its path.
function figure(data, path, form) {
  return element("span", { "data-figure": path, "data-form": form },
    shown(value_at(data.summary, path), form));
}

// What colours mean.

const states = [
  { name: "covered", key: "covered", colour: [88, 176, 122] },
  { name: "undersampled", key: "undersampled", colour: [255, 176, 32] },
  { name: "unobserved", key: "unobserved", colour: [238, 62, 66] },
  { name: "unreachable", key: "unreachable", colour: [158, 96, 232] },
];

/// In the order of the numbers that points have for them.
function order_states(scales) {
  states.sort((one, other) => scales.states.indexOf(one.key) - scales.states.indexOf(other.key));
}

/// The middle of the step that a point's incidence is in [degrees]; nothing if it is not known.
function incidence_of(cloud, index, scales) {
  const step = cloud.incidence ? cloud.incidence[index] : scales.no_incidence;
  return step === scales.no_incidence ? null : (step + 0.5) * scales.incidence_step_deg;
}

/// The value of a point in a map of a photo mission: 0 means none, 1 to 255 cover the range.
const map_value = (map, step) => (step === 0 ? null : map.low + (step - 1) / 254 * (map.high - map.low));

/// Points of a dark and a light end, as equal steps look equal (after matplotlib's viridis).
const ramp_stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

/// From near (warm) to far (cool), for what should not be near.
const nearness_stops = [[232, 62, 48], [252, 160, 48], [245, 226, 110], [120, 205, 170], [70, 160, 220]];

function along(stops, part) {
  const at = Math.min(Math.max(part, 0), 1) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2), share = at - low;
  return [0, 1, 2].map((i) => stops[low][i] + share * (stops[low + 1][i] - stops[low][i]));
}

/// Neighbouring numbers get colours far apart: by the golden angle.
function view_colour(view) {
  const hue = (view * 0.6180339887) % 1, light = 0.5 + 0.12 * (view % 3);
  const channel = (shift) => {
    const k = (shift + hue * 12) % 12;
    return 255 * (light - 0.55 * Math.min(light, 1 - light) * Math.max(-1, Math.min(k - 3, 9 - k, 1)));
  };
  return [channel(0), channel(8), channel(4)];
}

/// Far from each other, and from the green of covered points.
const vehicle_colours = [[255, 150, 50], [70, 165, 255], [235, 95, 205], [250, 225, 90], [160, 110, 255], [240, 240, 240]];
const vehicle_colour = (vehicle) => vehicle_colours[vehicle] || view_colour(vehicle);

const css_colour = (rgb) => "rgb(" + rgb.map((channel) => Math.round(channel)).join(",") + ")";
const css_ramp = (stops) => "linear-gradient(90deg," + stops.map(css_colour).join(",") + ")";

/// Points by the cubic cells that they lie in: those of cell c are points[begin[c]] up to, without
/// it, points[begin[c + 1]]; at(x, y, z) is the cell of three indices, or -1.
function cells_of_points(positions, count, side) {
  const size = 2 ** Math.ceil(Math.log2(2 * count + 2)), table = new Int32Array(size).fill(-1);
  const places = new Int32Array(3 * count), cell_of = new Int32Array(count);
  let cells = 0;
  const slot = (x, y, z) => {
    let at = (Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791)) & (size - 1);
    for (let cell = table[at]; cell >= 0; cell = table[at = (at + 1) & (size - 1)]) {
      if (places[3 * cell] === x && places[3 * cell + 1] === y && places[3 * cell + 2] === z) break;
    }
    return at;
  };
  for (let i = 0; i < count; ++i) {
    const x = Math.floor(positions[3 * i] / side), y = Math.floor(positions[3 * i + 1] / side);
    const z = Math.floor(positions[3 * i + 2] / side), at = slot(x, y, z);
    if (table[at] < 0) {
      places[3 * cells] = x;
      places[3 * cells + 1] = y;
      places[3 * cells + 2] = z;
      table[at] = cells++;
    }
    cell_of[i] = table[at];
  }
  const begin = new Int32Array(cells + 1), points = new Int32Array(count);
  for (let i = 0; i < count; ++i) ++begin[cell_of[i] + 1];
  for (let cell = 0; cell < cells; ++cell) begin[cell + 1] += begin[cell];
  const next = begin.slice();
  for (let i = 0; i < count; ++i) points[next[cell_of[i]]++] = i;
  return { count: cells, places, begin, points, at: (x, y, z) => table[slot(x, y, z)] };
}

/// Puts the coordinates of the points in and around a cell into a list; gives their number.
function gather_around(cells, cell, positions, list) {
  const x = cells.places[3 * cell], y = cells.places[3 * cell + 1], z = cells.places[3 * cell + 2];
  let size = 0;
  for (let n = 0; n < 27; ++n) {
    const other = cells.at(x + n % 3 - 1, y + Math.floor(n / 3) % 3 - 1, z + Math.floor(n / 9) - 1);
    if (other < 0) continue;
    for (let k = cells.begin[other]; k < cells.begin[other + 1]; ++k) {
      const at = 3 * cells.points[k];
      list[size] = positions[at];
      list[size + 1] = positions[at + 1];
      list[size + 2] = positions[at + 2];
      size += 3;
    }
  }
  return size / 3;
}

/// Densities are of the neighbours within so many spacings.
const density_reach = 2.5;

/// Neighbours of each point within `radius`, itself included, over the disc's area and the share that
/// the page has of all points, `all` of them: points per square metre of surface.
function densities(cloud, radius, all) {
  const { count, positions } = cloud, result = new Float32Array(count), reach = radius * radius;
  if (!(radius > 0)) return result;  // of a single place
  const cells = cells_of_points(positions, count, radius);
  const scale = all / count / (Math.PI * radius * radius);
  const list = new Float32Array(3 * count);
  for (let cell = 0; cell < cells.count; ++cell) {
    const end = 3 * gather_around(cells, cell, positions, list);
    for (let i = cells.begin[cell]; i < cells.begin[cell + 1]; ++i) {
      const own = 3 * cells.points[i];
      const x = positions[own], y = positions[own + 1], z = positions[own + 2];
      let near = 0;
      for (let at = 0; at < end; at += 3) {
        const dx = list[at] - x, dy = list[at + 1] - y, dz = list[at + 2] - z;
        if (dx * dx + dy * dy + dz * dz <= reach) ++near;
      }
      result[cells.points[i]] = near * scale;
    }
  }
  return result;
}

/// The value under which that share of some values lies.
function quantile(values, share) {
  const sorted = Float32Array.from(values).sort();
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : 0;
}

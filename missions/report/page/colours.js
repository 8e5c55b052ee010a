// What colours mean.

const states = [
  { name: "covered", key: "covered", colour: [88, 176, 122] },
  { name: "seen too thinly", key: "seen_too_thinly", colour: [255, 176, 32] },
  { name: "never seen", key: "never_seen", colour: [238, 62, 66] },
  { name: "out of reach", key: "unreachable", colour: [158, 96, 232] },
];

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

const css_colour = (rgb) => "rgb(" + rgb.map((channel) => Math.round(channel)).join(",") + ")";
const css_ramp = (stops) => "linear-gradient(90deg," + stops.map(css_colour).join(",") + ")";

/// Neighbours of each point within `radius`, itself included, over the disc's area and the share of
/// the cloud's points that the page has: points per square metre of surface.
function densities(cloud, radius) {
  const { count, positions } = cloud;
  const cells = new Map();
  const key = (x, y, z) => ((x & 0xffff) * 65536 + (y & 0xffff)) * 65536 + (z & 0xffff);
  const cell = new Int32Array(3 * count);
  for (let i = 0; i < 3 * count; ++i) cell[i] = Math.floor(positions[i] / radius);
  const next = new Int32Array(count).fill(-1);
  for (let i = 0; i < count; ++i) {
    const own = key(cell[3 * i], cell[3 * i + 1], cell[3 * i + 2]);
    next[i] = cells.has(own) ? cells.get(own) : -1;
    cells.set(own, i);
  }
  const result = new Float32Array(count);
  const scale = cloud.of / count / (Math.PI * radius * radius);
  for (let i = 0; i < count; ++i) {
    const x = positions[3 * i], y = positions[3 * i + 1], z = positions[3 * i + 2];
    let near = 0;
    for (let n = 0; n < 27; ++n) {
      const other_cell = key(cell[3 * i] + n % 3 - 1, cell[3 * i + 1] + Math.floor(n / 3) % 3 - 1,
        cell[3 * i + 2] + Math.floor(n / 9) - 1);
      let other = cells.has(other_cell) ? cells.get(other_cell) : -1;
      for (; other >= 0; other = next[other]) {
        const dx = positions[3 * other] - x, dy = positions[3 * other + 1] - y;
        const dz = positions[3 * other + 2] - z;
        if (dx * dx + dy * dy + dz * dz <= radius * radius) ++near;
      }
    }
    result[i] = near * scale;
  }
  return result;
}

/// The value under which that share of some values lies.
function quantile(values, share) {
  const sorted = Float32Array.from(values).sort();
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : 0;
}

// Decodes clouds written by missions/report/cloud_code.h.

/// Returns the inflated bytes of a block in the page, which contains deflated data in base64.
async function inflated(id) {
  const block = document.getElementById(id);
  const text = atob(block.textContent), packed = new Uint8Array(text.length);
  for (let i = 0; i < packed.length; ++i) packed[i] = text.charCodeAt(i);
  block.remove();  // frees the memory of its text
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// Splits 12 interleaved bits into four bits each of x, y and z.
const taken_apart = (() => {
  const table = new Uint16Array(4096);
  for (let key = 0; key < 4096; ++key) {
    for (let bit = 0; bit < 12; ++bit) {
      if (key >> bit & 1) table[key] |= 1 << (Math.floor(bit / 3) + 4 * (bit % 3));
    }
  }
  return table;
})();

function decode_positions(header, bytes) {
  const count = header.points, planes = Math.ceil(3 * header.bits / 8);
  const positions = new Float32Array(3 * count);
  const [x0, y0, z0] = header.origin;
  let key = 0;  // up to 48 bits, which a double represents exactly
  for (let i = 0; i < count; ++i) {
    let change = 0;
    for (let plane = planes - 1; plane >= 0; --plane) {
      change = 256 * change + bytes[plane * count + i];
    }
    key += change;
    let x = 0, y = 0, z = 0, rest = key;
    for (let shift = 0; rest > 0; shift += 4) {
      const group = taken_apart[rest % 4096];
      rest = Math.floor(rest / 4096);
      x |= (group & 15) << shift;
      y |= (group >> 4 & 15) << shift;
      z |= (group >> 8) << shift;
    }
    positions[3 * i] = x0 + (x + 0.5) * header.step;
    positions[3 * i + 1] = y0 + (y + 0.5) * header.step;
    positions[3 * i + 2] = z0 + (z + 0.5) * header.step;
  }
  return { positions, end: planes * count };
}

/// Adds the attributes whose byte planes start at `begin`.
function decode_attributes(cloud, attributes, bytes, begin) {
  const count = cloud.count;
  for (const { name, values: different } of attributes) {
    const low = bytes.subarray(begin, begin + count);
    begin += count;
    cloud[name] = low;
    if (different <= 256) continue;
    const high = bytes.subarray(begin, begin + count);
    begin += count;
    cloud[name] = Uint16Array.from(low, (value, i) => value | high[i] << 8);
  }
}

/// Returns {count, positions, spacing, state, view, incidence} with the attributes that the page
/// contains.
async function decode_cloud(name, header) {
  const bytes = await inflated("cloud-" + name);
  const { positions, end } = decode_positions(header, bytes);
  const cloud = { count: header.points, of: header.of, spacing: header.spacing, positions };
  decode_attributes(cloud, header.attributes, bytes, end);
  return cloud;
}

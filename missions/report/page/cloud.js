// Clouds as missions/report/cloud_code.h writes them.

/// Bytes of the text that base93() in missions/report/script_text.h writes.
function bytes_of_base93(text) {
  const base = 93, spare = base * base - (1 << 13), less = "<".charCodeAt(0);
  const digit = (i) => {
    const code = text.charCodeAt(i);
    return code - 33 - (code > less ? 1 : 0);
  };
  const bytes = new Uint8Array(Math.ceil(text.length * 7 / 8));
  let size = 0, bits = 0, count = 0;
  for (let i = 0; i < text.length; i += 2) {
    const is_pair = i + 1 < text.length;
    const number = digit(i) + (is_pair ? base * digit(i + 1) : 0);
    bits |= number << count;
    // A single digit at the end completes the byte that is begun.
    count += !is_pair ? 8 - count : (number & 0x1fff) < spare ? 14 : 13;
    for (; count >= 8; count -= 8, bits >>>= 8) bytes[size++] = bits & 255;
  }
  return bytes.subarray(0, size);
}

async function inflated(id) {
  const block = document.getElementById(id);
  const packed = bytes_of_base93(block.textContent);
  block.remove();  // its text is no longer needed
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// Of 12 interleaved bits the four of x, of y and of z, side by side.
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
  let key = 0;  // up to 48 bits, which a double holds exactly
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

/// The values at places of a list in which what is met moves to the front.
function values_at_places(place, count, different) {
  const list = Uint16Array.from({ length: different }, (_, i) => i);
  const values = different > 256 ? new Uint16Array(count) : new Uint8Array(count);
  for (let i = 0; i < count; ++i) {
    const at = place(i), value = list[at];
    for (let k = at; k > 0; --k) list[k] = list[k - 1];
    list[0] = value;
    values[i] = value;
  }
  return values;
}

/// Of values in the order of `first` those of the points.
function in_order_of_points(first, ordered) {
  const begin = new Uint32Array(1 << 16), values = new ordered.constructor(ordered.length);
  for (const value of first) ++begin[value];
  let sum = 0;
  for (let value = 0; value < begin.length; ++value) {
    const count = begin[value];
    begin[value] = sum;
    sum += count;
  }
  for (let i = 0; i < first.length; ++i) values[i] = ordered[begin[first[i]]++];
  return values;
}

/// Adds the attributes whose planes begin there.
function decode_attributes(cloud, attributes, bytes, begin) {
  const count = cloud.count;
  let first = null;
  for (const { name, values: different, follows_first } of attributes) {
    const low = begin, high = begin + count, is_wide = different > 256;
    const values = values_at_places(
      (i) => bytes[low + i] | (is_wide ? bytes[high + i] << 8 : 0), count, different);
    begin += (is_wide ? 2 : 1) * count;
    cloud[name] = follows_first ? in_order_of_points(first, values) : values;
    first = first || cloud[name];
  }
}

/// {count, positions, spacing, state, view, incidence}: attributes that the page has.
async function decode_cloud(name, header) {
  const bytes = await inflated("cloud-" + name);
  const { positions, end } = decode_positions(header, bytes);
  const cloud = { count: header.points, of: header.of, spacing: header.spacing, positions };
  decode_attributes(cloud, header.attributes, bytes, end);
  return cloud;
}

// Clouds as missions/report/cloud_code.h writes them.

const digits_of_85 =
  "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?_~>()[]{}@%$#";

/// Five characters are four bytes; the last one to three bytes are one character more.
function bytes_of_base85(text) {
  const value = new Uint8Array(128);
  for (let i = 0; i < 85; ++i) value[digits_of_85.charCodeAt(i)] = i;
  const size = Math.floor(text.length / 5) * 4 + Math.max(0, text.length % 5 - 1);
  const bytes = new Uint8Array(size);
  for (let i = 0, at = 0; at < size; i += 5) {
    let group = 0;
    // Digits that are left out count as the highest: the bytes before them come out right.
    for (let k = 0; k < 5; ++k) group = 85 * group + (i + k < text.length ? value[text.charCodeAt(i + k)] : 84);
    for (let shift = 24; shift >= 0 && at < size; shift -= 8) bytes[at++] = Math.floor(group / 2 ** shift) % 256;
  }
  return bytes;
}

async function inflated(id) {
  const block = document.getElementById(id);
  const packed = bytes_of_base85(block.textContent);
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

function decode_attribute(bytes, begin, count, size) {
  if (size === 1) return bytes.slice(begin, begin + count);
  const values = new Uint16Array(count);
  for (let i = 0; i < count; ++i) values[i] = bytes[begin + i] | bytes[begin + count + i] << 8;
  return values;
}

/// {count, positions, spacing, state, view, incidence}: attributes that the page has.
async function decode_cloud(name, header) {
  const bytes = await inflated("cloud-" + name);
  let { positions, end } = decode_positions(header, bytes);
  const cloud = { count: header.points, of: header.of, spacing: header.spacing, positions };
  for (const attribute of header.attributes) {
    cloud[attribute.name] = decode_attribute(bytes, end, header.points, attribute.bytes);
    end += attribute.bytes * header.points;
  }
  return cloud;
}

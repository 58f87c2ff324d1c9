// State frames of the server; crowdbot.web.StateFrame describes the bytes.
const TYPES = [Float32Array, Int16Array, Uint16Array, Uint8Array, Int32Array, Uint32Array, Float64Array];
const HEADER = 32;
const SECTION = 16;

function text(view, offset) {
  let word = "";
  for (let i = 0; i < 8; i++) {
    const code = view.getUint8(offset + i);
    if (code) word += String.fromCharCode(code);
  }
  return word;
}

/** Returns {channel, sequence, time, arrays, columns}: typed arrays and numbers of columns by name. */
export function decodeFrame(buffer) {
  const view = new DataView(buffer);
  if (view.getUint32(0) !== 0x43424631) throw new Error("not a state frame");
  const count = view.getUint32(20, true);
  const frame = {
    channel: text(view, 8),
    sequence: view.getUint32(16, true),
    time: view.getFloat64(24, true),
    arrays: {},
    columns: {},
  };
  let offset = HEADER + SECTION * count;
  for (let i = 0; i < count; i++) {
    const at = HEADER + SECTION * i;
    const type = TYPES[view.getUint16(at + 8, true)];
    const size = view.getUint32(at + 12, true);
    offset += (8 - (offset % 8)) % 8;
    const name = text(view, at);
    frame.arrays[name] = new type(buffer, offset, size);
    frame.columns[name] = view.getUint16(at + 10, true);
    offset += size * type.BYTES_PER_ELEMENT;
  }
  return frame;
}

/** A mesh that was asked for belongs to a scene that is no longer shown; the description of the next one follows. */
export class SceneGone extends Error {}

/** Returns the frame with a mesh; `resource` makes the address of a path and query. Throws SceneGone, or what failed. */
export async function fetchMesh(resource, path, query) {
  const response = await fetch(resource(path, query));
  if (response.status === 204) throw new SceneGone(path);
  if (!response.ok) throw new Error(`${path}: ${(await response.text()).trim()}`);
  return decodeFrame(await response.arrayBuffer());
}

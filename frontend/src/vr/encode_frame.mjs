// State frames to the server; crowdbot.web.StateFrame describes the bytes.
const CODES = [Float32Array, Int16Array, Uint16Array, Uint8Array, Int32Array, Uint32Array, Float64Array];
const HEADER = 32;
const SECTION = 16;

/** Returns the bytes of a frame; arrays are [name, typed array, columns]. */
export function encodeFrame(channel, sequence, time, arrays) {
  const offsets = [];
  let size = HEADER + SECTION * arrays.length;
  for (const [, values] of arrays) {
    size += (8 - (size % 8)) % 8;
    offsets.push(size);
    size += values.byteLength;
  }
  const buffer = new ArrayBuffer(size);
  const view = new DataView(buffer);
  view.setUint32(0, 0x43424631);
  word(view, 8, channel);
  view.setUint32(16, sequence, true);
  view.setUint32(20, arrays.length, true);
  view.setFloat64(24, time, true);
  arrays.forEach(([name, values, columns = 1], k) => {
    const at = HEADER + SECTION * k;
    word(view, at, name);
    view.setUint16(at + 8, CODES.indexOf(values.constructor), true);
    view.setUint16(at + 10, columns, true);
    view.setUint32(at + 12, values.length, true);
    new Uint8Array(buffer, offsets[k], values.byteLength).set(new Uint8Array(values.buffer, values.byteOffset, values.byteLength));
  });
  return buffer;
}

function word(view, at, text) {
  for (let i = 0; i < text.length; i++) view.setUint8(at + i, text.charCodeAt(i));
}

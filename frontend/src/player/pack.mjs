// Pack: the files and frames of an episode in one block of bytes; crowdbot.web.scene.player describes it.
import { decodeFrame } from "../net/state_frame.mjs";

/** Reads a gzipped, base64-coded pack; returns {files: Map(name -> ArrayBuffer), frames: [frame, ...]}. */
export async function readPack(text) {
  const coded = Uint8Array.from(atob(text.trim()), (one) => one.charCodeAt(0));
  const stream = new Blob([coded]).stream().pipeThrough(new DecompressionStream("gzip"));
  const data = await new Response(stream).arrayBuffer();
  const size = new DataView(data).getUint32(0, true);
  const parts = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size)));
  const files = new Map();
  const frames = [];
  let offset = 4 + size;
  for (const [name, length] of parts) {
    const bytes = data.slice(offset, offset + length);
    offset += length;
    if (name === "frame") frames.push(decodeFrame(bytes));
    else files.set(name, bytes);
  }
  return { files, frames };
}

/** JSON value of a file. */
export function readJson(bytes) {
  return JSON.parse(new TextDecoder().decode(bytes));
}

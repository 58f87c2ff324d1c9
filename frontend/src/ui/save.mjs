// save: gives a file to the browser, which stores it as a download.
import { h } from "./dom.mjs";

/** Saves a blob as a file of the browser. */
export function save(blob, name) {
  const link = h("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

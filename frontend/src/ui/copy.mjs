// Text that leaves the page by the clipboard.
import { openDialog } from "./dialog.mjs";
import { h } from "./dom.mjs";

/** Shows text in a dialog and copies it. */
export async function copyText(text, title = "Copy") {
  const area = h("textarea", { readonly: true, rows: Math.min(16, text.split("\n").length + 2), cols: 78, "aria-label": "Text" });
  area.value = text;
  let note = "copied to the clipboard";
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    note = "copy the text with Ctrl+C";
  }
  openDialog(title, [area, h("p", { class: "hint" }, note)]);
  area.select();
}

// Nodes of a screen. The server has cleaned its HTML; here only elements that format text are taken over.
const KEPT = new Set(
  "H1 H2 H3 H4 H5 H6 P BR HR UL OL LI B STRONG I EM U SUB SUP SMALL BLOCKQUOTE PRE CODE DIV SPAN TABLE CAPTION THEAD TBODY TR TD TH DL DT DD".split(" "),
);

/** Returns the nodes of a text in HTML, without attributes except pictures that are part of it. */
export function pageNodes(html) {
  return copy(new DOMParser().parseFromString(html, "text/html").body);
}

function copy(parent) {
  return [...parent.childNodes].flatMap((node) => {
    if (node.nodeType === Node.TEXT_NODE) return [document.createTextNode(node.data)];
    if (node.nodeName === "IMG" && /^data:image\//.test(node.getAttribute("src") ?? "")) {
      const picture = document.createElement("img");
      picture.src = node.getAttribute("src");
      picture.alt = node.getAttribute("alt") ?? "";
      return [picture];
    }
    if (!KEPT.has(node.nodeName)) return node.nodeType === Node.ELEMENT_NODE ? copy(node) : [];
    const element = document.createElement(headings(node.nodeName));
    element.append(...copy(node));
    return [element];
  });
}

/** The page has one first heading, the name of the program; those of a screen begin below it. */
const headings = (name) => (name === "H1" ? "H2" : name);

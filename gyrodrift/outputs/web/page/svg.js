// Elements of SVG.

const SVG = "http://www.w3.org/2000/svg";

export function drawn(parent, kind, attributes, text = "") {
  const made = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  parent.append(made);
  return made;
}

// Change an attribute only if it differs: the browser would lay out and paint the whole picture.
export function set(element, name, value) {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

// Elements in one call. Text is always text: what comes out of files never becomes markup.

type Attributes = Record<string, string | number | boolean | ((event: Event) => void)>;
export type Child = Node | string | number | null;

function fill<E extends Element>(element: E, attributes: Attributes, children: Child[]): E {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false) element.setAttribute(name, String(value));
  }
  for (const child of children) if (child !== null) element.append(child instanceof Node ? child : String(child));
  return element;
}

export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  return fill(document.createElement(tag), attributes, children);
}

export function button(label: string, title: string, action: () => void): HTMLButtonElement {
  return h("button", { title, "aria-label": title, click: action }, label);
}

export function toggle(label: string, title: string, on: boolean, change: (on: boolean) => void): HTMLElement {
  const box = h("input", { type: "checkbox", checked: on, change: () => change(box.checked) });
  return h("label", { title }, box, label);
}

export function svg(tag: string, attributes: Attributes = {}, ...children: Child[]): SVGElement {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

/** A table that scrolls where it is too wide, with the arrow keys, too. */
export function scroller(name: string, table: HTMLTableElement): HTMLElement {
  return h("div", { class: "scroll", tabindex: 0, role: "group", "aria-label": name }, table);
}

/** A number with three or four digits that count, for reading beside a plot. */
export function digits(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const exponent = size < 1e-3 || size >= 1e5;
  const text = exponent ? value.toExponential(1) : value.toFixed(size >= 100 ? 1 : size >= 1 ? 2 : 4);
  return text.replaceAll("-", "\u2212");
}

/** Text of a terminal with the signs that a page has: minus, plus or minus. */
export function typeset(text: string): string {
  return text.replaceAll("+-", "\u00b1").replace(/(^|[\s(,;:]|\de)-(?=[\d.])/g, "$1\u2212");
}

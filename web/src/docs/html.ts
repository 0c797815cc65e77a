// Elements in a line each. Texts of the description become text nodes, never markup.

export function make(tag: string, attributes: Record<string, string>, ...children: (Node | string)[]): HTMLElement {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

export function code(text: string): HTMLElement {
  return make('code', {}, text);
}

export function link(href: string, text: string): HTMLElement {
  return make('a', { href }, text);
}

/** A text; what stands between backticks is code. */
export function prose(text: string): (Node | string)[] {
  return text.split('`').map((part, i) => (i % 2 === 1 ? code(part) : part));
}

export function words(text: string): HTMLElement {
  return make('p', {}, ...prose(text));
}

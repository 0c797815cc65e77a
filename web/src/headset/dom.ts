// Elements without a framework: this page must be small.
type Props<K extends keyof HTMLElementTagNameMap> = Partial<Omit<HTMLElementTagNameMap[K], 'dataset' | 'style'>>;

export function make<K extends keyof HTMLElementTagNameMap>(tag: K, props: Props<K>, ...children: (Node | string)[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  Object.assign(element, props);
  element.append(...children);
  return element;
}

/** A control with its label, and words of help. */
export function field(label: string, control: HTMLElement, help = ''): HTMLElement {
  const words = make('label', { htmlFor: control.id, textContent: label });
  if (help === '') return make('div', { className: 'field' }, words, control);
  const more = make('span', { id: `${control.id}-help`, className: 'dim small', textContent: help });
  control.setAttribute('aria-describedby', more.id);
  return make('div', { className: 'field' }, words, control, more);
}

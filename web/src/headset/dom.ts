// Elements without a framework: this page must be small.
import { make } from '../parts';

export { make };

/** A control with its label, and words of help. */
export function field(label: string, control: HTMLElement, help = ''): HTMLElement {
  const words = make('label', { htmlFor: control.id, textContent: label });
  if (help === '') return make('div', { className: 'field' }, words, control);
  const more = make('span', { id: `${control.id}-help`, className: 'dim small', textContent: help });
  control.setAttribute('aria-describedby', more.id);
  return make('div', { className: 'field' }, words, control, more);
}

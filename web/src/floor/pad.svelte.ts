// Drawing on the floor: what somebody is asked to draw, and the outline that is being talked about.
import type { Point } from '../wire';
import type { Drawing } from './scene/sketch';

export class Pad {
  /** Somebody is to show something: a rectangle, a polygon or a point. */
  drawing = $state.raw<Drawing | null>(null);
  /** What was drawn and is still needed. */
  sketch = $state.raw<readonly Point[] | null>(null);
}

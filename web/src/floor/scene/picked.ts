// What on the floor is pointed at or chosen. Things of two kinds may bear the same id.
export const PICKED_KINDS = ['robot', 'worker', 'station', 'rack', 'place', 'closure'] as const;
export interface Picked {
  readonly kind: (typeof PICKED_KINDS)[number];
  readonly id: string;
}

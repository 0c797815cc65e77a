// Who on the floor is pointed at or chosen. A robot and a worker may bear the same id.
export interface Picked {
  readonly kind: 'robot' | 'worker';
  readonly id: string;
}

export const idOf = (kind: Picked['kind'], picked: Picked | null): string | null =>
  (picked?.kind === kind ? picked.id : null);

// What is to be picked where the wearer stands, as the server says it, and the joints of hands that it asks for. Pure.
import { toDevice, rotate, type Alignment, type Vec3 } from './frame';
import type { Sample } from './pump';
import { Shapes, type Ink } from './shapes';
import { t } from './words';

/** A slot or tote: map x, map y, height, metres. */
export interface CellPlace {
  id: string;
  at: Vec3;
}
export interface CellLights {
  /** The station in whose workplace the wearer stands. */
  station: string | null;
  /** Whether joints of hands are wanted. */
  hands: boolean;
  slot: CellPlace | null;
  pieces: number;
  tote: CellPlace | null;
  warning: { kind: 'wrong_slot' | 'wrong_tote'; slot: string | null; tote: string | null } | null;
}
/** Joints of one hand as WebXR numbers them: x, y, z, radius. */
export type Joints = readonly (readonly [x: number, y: number, z: number, radius: number])[];
/** What a pose says beside the head, where hands are wanted. */
export interface Reaching {
  gaze: { kind: 'head'; origin: Vec3; dir: Vec3 };
  hands: { l: Joints | null; r: Joints | null };
}

/** Half of the frame round a lit slot, and the radius of the ring over a tote, metres. */
const [FRAME_M, RING_M, THICK_M] = [0.12, 0.2, 0.02];

/** The head's ray and the hands of a sample. */
export const reaching = ({ pos, quat, hands }: Sample): Reaching => ({
  gaze: { kind: 'head', origin: pos, dir: rotate(quat, [0, 0, -1]) },
  hands: { l: hands?.l ?? null, r: hands?.r ?? null },
});

/** Frames that can be seen from everywhere round what is lit, in the colour of alarm where a hand is wrong. */
export function lights(shapes: Shapes, cell: CellLights, alignment: Alignment, floor: number, ink: Ink): void {
  const colour = cell.warning ? ink.close : ink.next;
  const place = ({ at: [x, y, height] }: CellPlace): Vec3 => toDevice(alignment, [x, y], floor + height);
  if (cell.slot) frame(shapes, place(cell.slot), colour);
  if (cell.tote) shapes.ring(place(cell.tote), RING_M - THICK_M, RING_M, colour);
}

function frame(shapes: Shapes, [x, y, z]: Vec3, ink: Ink['next']): void {
  for (const [dx, dz] of [
    [1, 0],
    [0, 1],
  ] as const) {
    const at = (wide: number, high: number): Vec3 => [x + wide * dx, y + high, z + wide * dz];
    const [out, inner] = [FRAME_M, FRAME_M - THICK_M];
    for (const side of [-1, 1]) {
      shapes.quad(at(side * inner, -out), at(side * out, -out), at(side * out, out), at(side * inner, out), ink);
      shapes.quad(at(-out, side * inner), at(out, side * inner), at(out, side * out), at(-out, side * out), ink);
    }
  }
}

/** What the board says of it: title and detail; null where nothing is to be picked. */
export function cellWords(cell: CellLights | null): readonly [title: string, detail: string] | null {
  if (!cell?.station) return null;
  const seen = cell.hands ? t('cell.hands') : '';
  if (cell.warning) {
    const { kind, slot, tote } = cell.warning;
    const take =
      cell.slot && cell.tote ? t('cell.take', { pieces: cell.pieces, slot: cell.slot.id, tote: cell.tote.id }) : '';
    return [
      kind === 'wrong_slot' ? t('cell.wrong.slot', { slot: slot ?? '' }) : t('cell.wrong.tote', { tote: tote ?? '' }),
      take,
    ];
  }
  if (!cell.slot || !cell.tote) return [t('cell.wait', { station: cell.station }), seen];
  return [t('cell.take', { pieces: cell.pieces, slot: cell.slot.id, tote: cell.tote.id }), seen];
}

// The lines of a DXF drawing, to be drawn over: LINE and LWPOLYLINE, as points in the drawing's own units.
export type Polyline = readonly (readonly [number, number])[];

/** All lines of a drawing in text form; arcs, blocks and texts are left out. */
export function readDxf(text: string): Polyline[] {
  const rows = text.split(/\r\n|\r|\n/);
  const found: Polyline[] = [];
  let kind = '';
  let points: [number, number][] = [];
  let closed = false;
  let inEntities = !/^\s*ENTITIES\s*$/m.test(text);
  const end = (): void => {
    if ((kind === 'LINE' || kind === 'LWPOLYLINE') && points.length > 1 && points.flat().every(Number.isFinite)) {
      found.push(closed ? [...points, points[0]!] : points);
    }
    [kind, points, closed] = ['', [], false];
  };
  for (let i = 0; i + 1 < rows.length; i += 2) {
    const [code, value] = [Number(rows[i]), rows[i + 1]!.trim()];
    if (code === 0) {
      end();
      if (value === 'ENDSEC') inEntities = false;
      kind = inEntities ? value : '';
    } else if (code === 2 && value === 'ENTITIES') inEntities = true;
    else if (kind === 'LINE') {
      if (code === 10) points[0] = [Number(value), NaN];
      if (code === 20 && points[0]) points[0][1] = Number(value);
      if (code === 11) points[1] = [Number(value), NaN];
      if (code === 21 && points[1]) points[1][1] = Number(value);
    } else if (kind === 'LWPOLYLINE') {
      if (code === 70) closed = (Number(value) & 1) === 1;
      if (code === 10) points.push([Number(value), NaN]);
      const last = points[points.length - 1];
      if (code === 20 && last) last[1] = Number(value);
    }
  }
  end();
  return found;
}

// The WebGL painter: one drawing call per sheet, and a sheet goes to the graphics card only when it has
// changed. It makes no object per frame.
import { GLYPH, GROUND_FRAGMENT, GROUND_VERTEX, MARK_FRAGMENT, MARK_VERTEX } from './shaders';
import { Glyphs } from './glyphs';
import type { Frame, Ground, Painter } from './painter';
import type { Palette } from './palette';
import { inkOf, Sheet, STRIDE, type Kind, type Words } from './sheet';
import { onPicture, toScreen, toWorld, type View } from '../scene/view';

type GL = WebGL2RenderingContext;

/** A sheet as the graphics card has it. */
interface Sent {
  array: WebGLVertexArrayObject;
  buffer: WebGLBuffer;
  bytes: number;
  turn: number;
}

export function openWebgl(palette: Palette): Painter {
  const element = document.createElement('canvas');
  const gl = element.getContext('webgl2', { alpha: false, antialias: false, depth: false, stencil: false });
  if (!gl) throw new Error('no WebGL 2');
  return new WebglPainter(element, gl, palette);
}

class WebglPainter implements Painter {
  readonly kind = 'webgl';
  readonly element: HTMLCanvasElement;
  #gl: GL;
  #density = 1;
  #marks: Program<'view' | 'pixel' | 'letters' | 'halo' | 'turned'>;
  #floor: Program<'place' | 'picture'>;
  #sent = new Map<Sheet, Sent>();
  #letters = new Sheet();
  #glyphs = new Glyphs();
  #glyphTurn = -1;
  #glyphTexture: WebGLTexture;
  #groundTexture: WebGLTexture;
  #picture: HTMLCanvasElement | null = null;
  #halo: readonly number[] = [];
  #void: readonly number[] = [];
  #label = 0;
  #pale = 0;

  constructor(element: HTMLCanvasElement, gl: GL, palette: Palette) {
    this.element = element;
    this.#gl = gl;
    this.#marks = program(gl, MARK_VERTEX, MARK_FRAGMENT, ['view', 'pixel', 'letters', 'halo', 'turned']);
    this.#floor = program(gl, GROUND_VERTEX, GROUND_FRAGMENT, ['place', 'picture']);
    this.#glyphTexture = texture(gl);
    this.#groundTexture = texture(gl);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.recolour(palette);
  }

  recolour(palette: Palette): void {
    this.#halo = parts(palette.of.halo);
    this.#void = parts(palette.of.void);
    this.#label = inkOf(palette.of.label);
    this.#pale = inkOf(palette.of.gauge);
  }

  resize(width: number, height: number, density: number): void {
    this.#density = density;
    this.element.width = Math.round(width * density);
    this.element.height = Math.round(height * density);
  }

  draw({ view, ground, sheets, words }: Frame): void {
    const gl = this.#gl;
    gl.viewport(0, 0, this.element.width, this.element.height);
    gl.clearColor(this.#void[0]!, this.#void[1]!, this.#void[2]!, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.disable(gl.BLEND);
    this.#drawGround(view, ground);
    gl.enable(gl.BLEND);
    this.#layOut(words, view);
    gl.useProgram(this.#marks.is);
    const at = this.#marks.at;
    gl.uniform4f(at.view, view.x, view.y, view.width / 2 / view.scale, view.height / 2 / view.scale);
    gl.uniform1f(at.turned, view.turned ? 1 : 0);
    gl.uniform1f(at.pixel, 1 / view.scale / this.#density);
    gl.uniform4f(at.halo, this.#halo[0]!, this.#halo[1]!, this.#halo[2]!, this.#halo[3]!);
    gl.uniform1i(at.letters, 0);
    gl.bindTexture(gl.TEXTURE_2D, this.#glyphTexture);
    if (this.#glyphTurn !== this.#glyphs.turn) {
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, this.#glyphs.picture);
      this.#glyphTurn = this.#glyphs.turn;
    }
    for (let i = 0; i < sheets.length; i++) this.#drawSheet(sheets[i]!);
    this.#drawSheet(this.#letters);
  }

  destroy(): void {
    // Contexts are few in a browser: give this one back now rather than at the next collection.
    this.#gl.getExtension('WEBGL_lose_context')?.loseContext();
    this.element.remove();
  }

  #drawGround(view: View, ground: Ground): void {
    const gl = this.#gl;
    gl.bindTexture(gl.TEXTURE_2D, this.#groundTexture);
    if (this.#picture !== ground.picture) {
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, ground.picture);
      this.#picture = ground.picture;
    }
    const kept = ground.view;
    const [halfX, halfY] = [view.width / 2 / view.scale, view.height / 2 / view.scale];
    gl.useProgram(this.#floor.is);
    const [right, up] = onPicture(view, kept.x - view.x, kept.y - view.y);
    gl.uniform4f(
      this.#floor.at.place,
      right / halfX,
      up / halfY,
      kept.width / 2 / kept.scale / halfX,
      kept.height / 2 / kept.scale / halfY,
    );
    gl.uniform1i(this.#floor.at.picture, 0);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  #drawSheet(sheet: Sheet): void {
    if (sheet.count === 0) return;
    const gl = this.#gl;
    const sent = this.#sent.get(sheet) ?? this.#open(sheet);
    gl.bindVertexArray(sent.array);
    if (sent.turn !== sheet.turn) {
      gl.bindBuffer(gl.ARRAY_BUFFER, sent.buffer);
      if (sent.bytes < sheet.marks.byteLength) {
        gl.bufferData(gl.ARRAY_BUFFER, sheet.marks.byteLength, gl.DYNAMIC_DRAW);
        sent.bytes = sheet.marks.byteLength;
      }
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, sheet.marks, 0, sheet.count * STRIDE);
      sent.turn = sheet.turn;
    }
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, sheet.count);
  }

  #open(sheet: Sheet): Sent {
    const gl = this.#gl;
    const [array, buffer] = [gl.createVertexArray(), gl.createBuffer()];
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    const attribute = (slot: number, size: number, type: number, at: number): void => {
      gl.enableVertexAttribArray(slot);
      gl.vertexAttribPointer(slot, size, type, type === gl.UNSIGNED_BYTE, 4 * STRIDE, 4 * at);
      gl.vertexAttribDivisor(slot, 1);
    };
    attribute(0, 4, gl.FLOAT, 0);
    attribute(1, 3, gl.FLOAT, 4);
    attribute(2, 4, gl.UNSIGNED_BYTE, 7);
    const sent = { array, buffer, bytes: 0, turn: -1 };
    this.#sent.set(sheet, sent);
    return sent;
  }

  /** Puts words as letters, each at a whole pixel, so that they are sharp. */
  #layOut({ list, count }: Words, view: View): void {
    const letters = this.#letters;
    letters.begin();
    const whole = (v: number): number => Math.round(v * this.#density) / this.#density;
    for (let i = 0; i < count; i++) {
      const { text, x, y, below, px, pale } = list[i]!;
      let wide = 0;
      for (const letter of text) wide += this.#glyphs.of(letter).advance;
      const cell = Glyphs.REACH * px;
      const [middle, level] = toScreen(view, x, y);
      let left = whole(middle - (wide * px) / 2);
      const top = whole(level + below - cell / 2);
      for (const letter of text) {
        const glyph = this.#glyphs.of(letter);
        const [gx, gy] = toWorld(view, left - Glyphs.INSET * px + cell / 2, top + cell / 2);
        letters.put(
          GLYPH as Kind,
          gx,
          gy,
          cell / view.scale,
          cell / view.scale,
          pale ? this.#pale : this.#label,
          0,
          glyph.cell,
        );
        left += glyph.advance * px;
      }
    }
  }
}

interface Program<Name extends string> {
  is: WebGLProgram;
  at: Record<Name, WebGLUniformLocation | null>;
}

function program<Name extends string>(gl: GL, vertex: string, fragment: string, names: readonly Name[]): Program<Name> {
  const is = gl.createProgram();
  for (const [type, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ] as const) {
    const shader = gl.createShader(type);
    if (!shader) throw new Error('the WebGL context is lost');
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
      throw new Error(gl.getShaderInfoLog(shader) ?? 'a shader was refused');
    gl.attachShader(is, shader);
  }
  gl.linkProgram(is);
  if (!gl.getProgramParameter(is, gl.LINK_STATUS))
    throw new Error(gl.getProgramInfoLog(is) ?? 'a shader program was refused');
  const at = Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(is, name)]));
  return { is, at: at as Program<Name>['at'] };
}

function texture(gl: GL): WebGLTexture {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return made;
}

function parts(css: string): number[] {
  const ink = inkOf(css);
  return [0, 8, 16, 24].map((shift) => ((ink >>> shift) & 255) / 255);
}

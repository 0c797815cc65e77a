// WebGL for the room and the twin: coloured triangles, those of solid things in the haze of the distance, and pieces of
// one sheet with writing on it.
import { STRIDE, type Colour } from './shapes';
import type { Mat4 } from './arrow';

/** A piece of the sheet (pixels) on a rectangle: corner and sides in the frame of `matrix`. */
export interface Sprite {
  matrix: Mat4;
  centre: readonly [number, number, number];
  right: readonly [number, number, number];
  up: readonly [number, number, number];
  piece: readonly [x: number, y: number, width: number, height: number];
}

const FLAT_PARTS = [
  ['at', 3],
  ['ink', 4],
] as const;
const FLAT_VERTEX = `attribute vec3 at; attribute vec4 ink; uniform mat4 matrix; varying vec4 colour;
void main() { gl_Position = matrix * vec4(at, 1.0); colour = vec4(ink.rgb * ink.a, ink.a); }`;
const FLAT_FRAGMENT = `precision mediump float; varying vec4 colour; void main() { gl_FragColor = colour; }`;
const SOLID_VERTEX = `attribute vec3 at; attribute vec4 ink; uniform mat4 matrix;
varying vec4 colour; varying float far;
void main() { gl_Position = matrix * vec4(at, 1.0); colour = ink; far = gl_Position.w; }`;
const SOLID_FRAGMENT = `precision mediump float; varying vec4 colour; varying float far; uniform vec4 haze;
void main() {
  float thick = clamp(far / haze.a, 0.0, 1.0);
  gl_FragColor = vec4(mix(colour.rgb, haze.rgb, thick * thick) * colour.a, colour.a);
}`;
const SHEET_VERTEX = `attribute vec3 at; attribute vec2 uv; uniform mat4 matrix; varying vec2 place;
void main() { gl_Position = matrix * vec4(at, 1.0); place = uv; }`;
const SHEET_FRAGMENT = `precision mediump float; varying vec2 place; uniform sampler2D sheet;
void main() { gl_FragColor = texture2D(sheet, place); }`;

/** Triangles that are kept from frame to frame. */
export interface Mesh {
  buffer: WebGLBuffer | null;
  count: number;
}
/** What is far away fades into this colour: completely at so many metres. */
export interface Haze {
  colour: Colour;
  metres: number;
}

export class Painter {
  readonly gl: WebGLRenderingContext;
  #flat: WebGLProgram;
  #solid: WebGLProgram;
  #sheet: WebGLProgram;
  #buffer: WebGLBuffer | null;
  #texture: WebGLTexture | null;
  #size: readonly [number, number] = [1, 1];

  constructor(canvas: HTMLCanvasElement) {
    const gl = canvas.getContext('webgl', { xrCompatible: true, alpha: true, antialias: true });
    if (!gl) throw new Error('this browser has no WebGL');
    this.gl = gl;
    this.#flat = program(gl, FLAT_VERTEX, FLAT_FRAGMENT);
    this.#solid = program(gl, SOLID_VERTEX, SOLID_FRAGMENT);
    this.#sheet = program(gl, SHEET_VERTEX, SHEET_FRAGMENT);
    this.#buffer = gl.createBuffer();
    this.#texture = gl.createTexture();
  }

  /** Takes a new sheet. */
  write(sheet: HTMLCanvasElement): void {
    const { gl } = this;
    this.#size = [sheet.width, sheet.height];
    gl.bindTexture(gl.TEXTURE_2D, this.#texture);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, sheet);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  }

  /** Begins a frame in a framebuffer: nothing there, so that the room shows; or a sky. */
  begin(target: WebGLFramebuffer | null, [r, g, b, a]: Colour = [0, 0, 0, 0]): void {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.clearColor(r, g, b, a);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Triangles of shapes.ts. `behind`: those behind solid things are hidden. */
  flat(corners: Float32Array, matrix: Mat4, depth: 'over all' | 'behind' = 'over all'): void {
    if (corners.length === 0) return;
    const { gl } = this;
    this.#fill(this.#buffer, corners, gl.STREAM_DRAW);
    this.#use(this.#flat, matrix, FLAT_PARTS, STRIDE);
    if (depth === 'behind') gl.enable(gl.DEPTH_TEST);
    gl.drawArrays(gl.TRIANGLES, 0, corners.length / STRIDE);
    gl.disable(gl.DEPTH_TEST);
  }

  /** Keeps triangles; those from before, if there are any, are replaced. */
  keep(corners: Float32Array, before: Mesh | null): Mesh {
    const buffer = before?.buffer ?? this.gl.createBuffer();
    this.#fill(buffer, corners, this.gl.DYNAMIC_DRAW);
    return { buffer, count: corners.length / STRIDE };
  }

  /** Kept triangles: of solid things, which hide one another, or painted one over the other, as on the ground. */
  mesh({ buffer, count }: Mesh, matrix: Mat4, { colour: [r, g, b], metres }: Haze, how: 'solid' | 'painted'): void {
    if (count === 0) return;
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    this.#use(this.#solid, matrix, FLAT_PARTS, STRIDE);
    gl.uniform4f(gl.getUniformLocation(this.#solid, 'haze'), r, g, b, metres);
    if (how === 'solid') gl.enable(gl.DEPTH_TEST);
    gl.drawArrays(gl.TRIANGLES, 0, count);
    gl.disable(gl.DEPTH_TEST);
  }

  sprite({ matrix, centre: c, right: r, up: u, piece: [x, y, w, h] }: Sprite): void {
    const { gl } = this;
    const [width, height] = this.#size;
    const corner = (i: number, j: number): number[] => [
      ...[0, 1, 2].map((k) => c[k]! + r[k]! * i + u[k]! * j),
      (x + (w * (i + 1)) / 2) / width,
      (y + (h * (1 - j)) / 2) / height,
    ];
    const corners = new Float32Array([...corner(-1, -1), ...corner(1, -1), ...corner(-1, 1), ...corner(1, 1)]);
    this.#fill(this.#buffer, corners, gl.STREAM_DRAW);
    this.#use(
      this.#sheet,
      matrix,
      [
        ['at', 3],
        ['uv', 2],
      ],
      5,
    );
    gl.bindTexture(gl.TEXTURE_2D, this.#texture);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  #fill(buffer: WebGLBuffer | null, corners: Float32Array, use: number): void {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, corners, use);
  }

  /** Sets a program up for the buffer that is bound. */
  #use(which: WebGLProgram, matrix: Mat4, parts: readonly (readonly [string, number])[], stride: number): void {
    const { gl } = this;
    gl.useProgram(which);
    let offset = 0;
    for (const [name, size] of parts) {
      const place = gl.getAttribLocation(which, name);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, stride * 4, offset * 4);
      offset += size;
    }
    gl.uniformMatrix4fv(gl.getUniformLocation(which, 'matrix'), false, Float32Array.from(matrix));
  }
}

function program(gl: WebGLRenderingContext, vertex: string, fragment: string): WebGLProgram {
  const made = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ] as const) {
    const shader = gl.createShader(kind);
    if (!shader || !made) throw new Error('WebGL could not create a shader');
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS))
    throw new Error(gl.getProgramInfoLog(made) ?? 'WebGL could not link the shader program');
  return made;
}

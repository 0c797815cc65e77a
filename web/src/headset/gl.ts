// WebGL for the room: coloured triangles, and pieces of one sheet with writing on it. Two programs, two buffers.
import { STRIDE } from './shapes';
import type { Mat4 } from './arrow';

/** A piece of the sheet (pixels) on a rectangle: corner and sides in the frame of `matrix`. */
export interface Sprite {
  matrix: Mat4;
  centre: readonly [number, number, number];
  right: readonly [number, number, number];
  up: readonly [number, number, number];
  piece: readonly [x: number, y: number, width: number, height: number];
}

const FLAT_VERTEX = `attribute vec3 at; attribute vec4 ink; uniform mat4 matrix; varying vec4 colour;
void main() { gl_Position = matrix * vec4(at, 1.0); colour = vec4(ink.rgb * ink.a, ink.a); }`;
const FLAT_FRAGMENT = `precision mediump float; varying vec4 colour; void main() { gl_FragColor = colour; }`;
const SHEET_VERTEX = `attribute vec3 at; attribute vec2 uv; uniform mat4 matrix; varying vec2 place;
void main() { gl_Position = matrix * vec4(at, 1.0); place = uv; }`;
const SHEET_FRAGMENT = `precision mediump float; varying vec2 place; uniform sampler2D sheet;
void main() { gl_FragColor = texture2D(sheet, place); }`;

export class Painter {
  readonly gl: WebGLRenderingContext;
  #flat: WebGLProgram;
  #sheet: WebGLProgram;
  #buffer: WebGLBuffer | null;
  #texture: WebGLTexture | null;
  #size: readonly [number, number] = [1, 1];

  constructor(canvas: HTMLCanvasElement) {
    const gl = canvas.getContext('webgl', { xrCompatible: true, alpha: true, antialias: true });
    if (!gl) throw new Error('this browser has no WebGL');
    this.gl = gl;
    this.#flat = program(gl, FLAT_VERTEX, FLAT_FRAGMENT);
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

  /** Begins a frame in a framebuffer: nothing there, so that the room shows. */
  begin(target: WebGLFramebuffer | null): void {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Triangles of shapes.ts. */
  flat(corners: Float32Array, matrix: Mat4): void {
    if (corners.length === 0) return;
    const { gl } = this;
    this.#use(this.#flat, corners, matrix, [['at', 3], ['ink', 4]], STRIDE);
    gl.drawArrays(gl.TRIANGLES, 0, corners.length / STRIDE);
  }

  sprite({ matrix, centre: c, right: r, up: u, piece: [x, y, w, h] }: Sprite): void {
    const { gl } = this;
    const [width, height] = this.#size;
    const corner = (i: number, j: number): number[] => [
      ...[0, 1, 2].map((k) => c[k]! + r[k]! * i + u[k]! * j), (x + (w * (i + 1)) / 2) / width, (y + (h * (1 - j)) / 2) / height,
    ];
    const corners = new Float32Array([...corner(-1, -1), ...corner(1, -1), ...corner(-1, 1), ...corner(1, 1)]);
    this.#use(this.#sheet, corners, matrix, [['at', 3], ['uv', 2]], 5);
    gl.bindTexture(gl.TEXTURE_2D, this.#texture);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  #use(which: WebGLProgram, corners: Float32Array, matrix: Mat4, parts: readonly (readonly [string, number])[], stride: number): void {
    const { gl } = this;
    gl.useProgram(which);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffer);
    gl.bufferData(gl.ARRAY_BUFFER, corners, gl.STREAM_DRAW);
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
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
    const shader = gl.createShader(kind);
    if (!shader || !made) throw new Error('WebGL could not create a shader');
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made) ?? 'WebGL could not link the shader program');
  return made;
}

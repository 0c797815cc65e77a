// The two programs of the WebGL painter. One draws every mark: a rectangle per mark, and in it the shape
// as a distance to its edge, so that it is sharp at any scale. The other draws the ground.
import { ARC_WIDTH, DASH, KIND, RING_DASHES } from './sheet';

/** Slot of the kind that only the painter itself uses: a letter, `more` is its cell. */
export const GLYPH = 12;

export const MARK_VERTEX = `#version 300 es
layout(location = 0) in vec4 box;   // x, y, width, height
layout(location = 1) in vec3 what;  // turn, kind, more
layout(location = 2) in vec4 ink;
uniform vec4 view;                  // x, y, and metres to half a screen in x and y
uniform float pixel;                // metres
uniform float turned;               // 1 where up on the map is to the right
out vec2 at;                        // metres from the middle, along the mark's own axes
out vec2 world;
flat out vec2 side;                 // half of each side, metres
flat out vec3 is;                   // turn, kind, more
flat out vec4 colour;
void main() {
  vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
  side = box.zw * 0.5;
  at = corner * (side + pixel);
  // Letters and signs stand upright on the picture.
  bool stands = what.y > ${GLYPH - 0.5} || abs(what.y - ${KIND.arc}.0) < 0.5 || abs(what.y - ${KIND.bolt}.0) < 0.5;
  float turn = what.x + (stands ? turned * 1.57079633 : 0.0);
  float c = cos(turn), s = sin(turn);
  world = box.xy + vec2(c * at.x - s * at.y, s * at.x + c * at.y);
  is = what;
  colour = ink;
  vec2 off = world - view.xy;
  gl_Position = vec4((turned > 0.5 ? vec2(off.y, -off.x) : off) / view.zw, 0.0, 1.0);
}`;

export const MARK_FRAGMENT = `#version 300 es
precision highp float;
in vec2 at;
in vec2 world;
flat in vec2 side;
flat in vec3 is;
flat in vec4 colour;
uniform float pixel;
uniform sampler2D letters;
uniform vec4 halo;
out vec4 result;

const float TAU = 6.28318530718;

float boxed(vec2 p, vec2 half_side) {
  vec2 d = abs(p) - half_side;
  return max(d.x, d.y);
}
float person(vec2 p, float r) {
  p.y = abs(p.y);
  float beak = max(dot(p - vec2(1.35 * r, 0.0), vec2(0.622, 0.783)), 0.62 * r - p.x);
  return min(length(p) - 0.85 * r, beak);
}
// The side of p that a line from a to b leaves on its left, as a distance.
float left_of(vec2 p, vec2 a, vec2 b) {
  vec2 d = normalize(b - a);
  return dot(p - a, vec2(d.y, -d.x));
}
float triangle(vec2 p, vec2 a, vec2 b, vec2 c) {
  return max(left_of(p, a, b), max(left_of(p, b, c), left_of(p, c, a)));
}
float bolt(vec2 p, float r) {
  p /= r;
  float top = triangle(p, vec2(0.3, 1.0), vec2(-0.6, -0.12), vec2(0.2, -0.12));
  float foot = triangle(p, vec2(-0.3, -1.0), vec2(0.6, 0.12), vec2(-0.2, 0.12));
  return min(top, foot) * r;
}

void main() {
  int kind = int(is.y + 0.5);
  float more = is.z;
  float r = side.x;
  float d = -1.0;
  float shade = 1.0;
  if (kind == ${GLYPH}) {
    vec2 cell = vec2(mod(more, 16.0), floor(more / 16.0));
    vec2 uv = (cell + clamp(at / side * vec2(0.5, -0.5) + 0.5, 0.02, 0.98)) / 16.0;
    vec2 cover = texture(letters, uv).rg;
    vec4 drawn = vec4(mix(halo.rgb, colour.rgb, cover.r), max(cover.r, cover.g * halo.a));
    result = vec4(drawn.rgb * drawn.a, drawn.a);
    return;
  }
  if (kind == ${KIND.box}) d = boxed(at, side);
  else if (kind == ${KIND.frame}) d = max(boxed(at, side), -boxed(at, side - more));
  else if (kind == ${KIND.disc}) d = length(at) - r;
  else if (kind == ${KIND.ring}) d = abs(length(at) - r + more * 0.5) - more * 0.5;
  else if (kind == ${KIND.cross}) {
    vec2 p = abs(at);
    d = max(abs(p.x - p.y) * 0.7071 - more * 0.5, boxed(at, side));
  } else if (kind == ${KIND.person}) {
    d = person(at, r / 1.35);
    if (more > 0.0) d = abs(d + more * 0.5) - more * 0.5;
  } else if (kind == ${KIND.dashes}) {
    vec2 along = vec2(cos(is.x), sin(is.x));
    float part = abs(fract(dot(world, along) / more) - 0.5) - ${(DASH / 2).toFixed(3)};
    d = max(boxed(at, side), part * more);
  } else if (kind == ${KIND.dashring}) {
    float part = abs(fract(atan(at.y, at.x) / TAU * ${RING_DASHES}.0) - 0.5) - ${(DASH / 2).toFixed(3)};
    d = max(abs(length(at) - r + more * 0.5) - more * 0.5, part * TAU * r / ${RING_DASHES}.0);
  } else if (kind == ${KIND.hatch}) {
    float stripe = abs(fract((world.x + world.y) * 0.7071 / more) - 0.5) * more - 0.6 * pixel;
    d = max(length(at) - r, stripe);
  } else if (kind == ${KIND.arc}) {
    float width = r * ${ARC_WIDTH};
    float turned = fract(atan(at.x, at.y) / TAU + 1.0);
    d = max(abs(length(at) - r + width * 0.5) - width * 0.5, (turned - more) * TAU * r);
  } else if (kind == ${KIND.bolt}) d = bolt(at, r);
  else if (kind == ${KIND.heat}) {
    vec2 p = at / side;
    shade = max(0.0, exp(-4.5 * dot(p, p)) - 0.0111);
    d = length(p) - 1.0;
  }
  float a = colour.a * shade * clamp(0.5 - d / pixel, 0.0, 1.0);
  result = vec4(colour.rgb * a, a);
}`;

export const GROUND_VERTEX = `#version 300 es
uniform vec4 place;  // middle and half sides of the picture on the screen
out vec2 uv;
void main() {
  vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
  uv = corner * vec2(0.5, -0.5) + 0.5;
  gl_Position = vec4(place.xy + corner * place.zw, 0.0, 1.0);
}`;

export const GROUND_FRAGMENT = `#version 300 es
precision mediump float;
in vec2 uv;
uniform sampler2D picture;
out vec4 result;
void main() { result = vec4(texture(picture, uv).rgb, 1.0); }`;

// Picks a painter: WebGL where there is a graphics card to run it, canvas 2D where not. `?painter=webgl`
// or `?painter=canvas2d` in the address decides otherwise, for tests and for doubt.
import type { Painter } from './painter';
import type { Palette } from './palette';

export async function choosePainter(palette: Palette): Promise<Painter> {
  const wanted = new URLSearchParams(location.search).get('painter');
  if (wanted === 'webgl' || (wanted !== 'canvas2d' && hasFastWebgl())) {
    try {
      const { openWebgl } = await import('./webgl');
      return openWebgl(palette);
    } catch (error) {
      console.warn('WebGL could not be started; drawing on a 2D canvas instead.', error);
    }
  }
  const { Canvas2dPainter } = await import('./canvas2d');
  return new Canvas2dPainter(palette);
}

/** WebGL computed by the processor is many times slower here than canvas 2D, so it does not count. */
function hasFastWebgl(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2', { failIfMajorPerformanceCaveat: true });
  if (!gl) return false;
  // Not every browser reports its software renderer as a caveat; its name gives it away.
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return !/swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

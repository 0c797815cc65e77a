// Types of the mock server for vite.config.ts.
export interface MockOptions {
  port: number;
  width?: number;
  height?: number;
  robots?: number;
  people?: number;
  dist?: string | null;
  token?: string | null;
}
export function startMock(options: MockOptions): Promise<{ port: number; stop(): void }>;

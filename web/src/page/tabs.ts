// What can be shown below the floor, of the present. What the server alone keeps is in no recording.
import { BELOW } from '../replay';

export const TABS = { ...BELOW, report: 'Report', system: 'System', audit: 'Audit' } as const;
export type Tab = keyof typeof TABS;
